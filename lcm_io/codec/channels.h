// Channels and message limits of a run.
// Invariant: a message fits into one UDP datagram, so losing a datagram loses one message only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "throng/messages.hpp"

namespace throng {

/// Returns whether THRONG_END and THRONG_CHECKSUMS name the channel: always for the channels of
/// every run, for optional ones only after a message. Optional channels thus change no byte of
/// other runs.
constexpr bool is_named(Channel channel, int64_t messages) {
  return !is_on_request(channel) || messages > 0;
}

/// Returns the channel name: "THRONG_RUN", "THRONG_STATES", ...
constexpr std::string_view name_of(Channel channel) {
  return kChannelNames[static_cast<size_t>(channel)];
}
inline std::optional<Channel> channel_of(std::string_view name) {
  for (const Channel channel : kAllChannels)
    if (name_of(channel) == name) return channel;
  return std::nullopt;
}

/// Version of the meaning of message fields. It grows when a meaning changes but the field does
/// not; a changed field changes the fingerprint.
inline constexpr int32_t kSchema = 1;

/// Maximum size of an encoded message, with fingerprint. A UDP datagram holds 65507 bytes with
/// LCM's header and the channel name. liblcm sends larger messages in fragments; version 1.3.1
/// drops them if fragments arrive out of order.
inline constexpr size_t kMaxMessageBytes = 60'000;

/// Size of the fingerprint and the header fields of every message: five int64 and three int32.
inline constexpr size_t kHeaderBytes = 8 + 5 * 8 + 3 * 4;

/// Number of rows that fit into a message whose lists have one common length.
template <class Message>
inline constexpr size_t kRowsPerMessage =
    (kMaxMessageBytes - kFixedBytes<Message>) / kRowBytes<Message>;

/// Number of messages for that many items, `per_chunk` in each.
constexpr int chunks_of(size_t items, size_t per_chunk) {
  return static_cast<int>(items / per_chunk + (items % per_chunk != 0));
}

/// Maximum size of an encoded run description, enough for a hundred models of a million triangles
/// in all. A reader reserves at most this much before it has checked a description.
inline constexpr size_t kMaxDescriptionBytes = size_t{64} << 20;

/// Stays on this machine (ttl=0) and avoids LCM's default port 7667. The receive buffer holds a
/// burst of states; the default of 208 kB is full after three messages of 60 kB.
inline constexpr std::string_view kDefaultLcmUrl =
    "udpm://239.255.76.67:7684?ttl=0&recv_buf_size=2097152";

}  // namespace throng
