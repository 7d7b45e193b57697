// The channels of a run, their names and the limits of a message.
// One rule: a message is one UDP datagram, so its loss is the loss of one message and no more.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "throng/messages.hpp"

namespace throng {

/// What a run says of its channels names those of a run without options always, the others where
/// they said something: what nobody asked for changes no byte.
constexpr bool is_named(Channel channel, int64_t messages) {
  return !is_on_request(channel) || messages > 0;
}

/// "THRONG_RUN", "THRONG_STATES", ...
constexpr std::string_view name_of(Channel channel) {
  return kChannelNames[static_cast<size_t>(channel)];
}
inline std::optional<Channel> channel_of(std::string_view name) {
  for (const Channel channel : kAllChannels)
    if (name_of(channel) == name) return channel;
  return std::nullopt;
}

/// What the numbers in the messages mean. Grows when a meaning changes and the field does not;
/// a changed field changes the fingerprint by itself.
inline constexpr int32_t kSchema = 3;

/// An encoded message, fingerprint included. A UDP datagram holds 65507 bytes with LCM's header and
/// the channel's name; larger messages become fragments, and liblcm 1.3.1 drops a message whose
/// fragments arrive out of order.
inline constexpr size_t kMaxMessageBytes = 60'000;

/// Fingerprint, five int64 and three int32 that every message begins with.
inline constexpr size_t kHeaderBytes = 8 + 5 * 8 + 3 * 4;

/// Rows that fit into a message of a type that has lists of one count.
template <class Message>
inline constexpr size_t kRowsPerMessage =
    (kMaxMessageBytes - kFixedBytes<Message>) / kRowBytes<Message>;

/// Messages that so many items take.
constexpr int chunks_of(size_t items, size_t per_chunk) {
  return static_cast<int>(items / per_chunk + (items % per_chunk != 0));
}

/// A run description in one piece: a hundred models of a million triangles in all fit. A reader
/// reserves this much at most before it trusts a description.
inline constexpr size_t kMaxDescriptionBytes = size_t{64} << 20;

/// The machine itself only (ttl=0), a port of our own (LCM's default is 7667), and a receive buffer
/// that holds a burst of states: the default of 208 kB is full after three messages of 60 kB.
inline constexpr std::string_view kDefaultLcmUrl =
    "udpm://239.255.76.67:7684?ttl=0&recv_buf_size=2097152";

}  // namespace throng
