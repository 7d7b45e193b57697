// Decodes messages that may be damaged, hostile, or somebody else's.
// One rule: nothing of a message is believed before its lengths add up to its size exactly; then
// the generated decoder, which would throw, allocate gigabytes or read wild, is safe to call.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "lcm_io/codec/channels.h"
#include "throng/messages.hpp"

namespace throng {

/// What every message begins with.
struct MessageHeader {
  int64_t fingerprint = 0;
  int64_t utime_us = 0;
  int64_t run_id = 0;
  int64_t instance = 0;
  int64_t frame = 0;
  int64_t seq = 0;
  int32_t chunk = 0;
  int32_t chunk_count = 0;
  int32_t schema = 0;
};

/// The fingerprint of the type that belongs on a channel.
int64_t fingerprint_of(Channel channel);

/// Reads and checks the header of a message: size, fingerprint, schema, chunk numbers. Returns what
/// is wrong, or "".
std::string read_header(Channel channel, std::span<const uint8_t> bytes, MessageHeader& header);

/// Decodes a whole message of any type of THRONG_MESSAGES that is no part of another, or returns
/// what is wrong and leaves `out` unusable: its lengths, the rules of its .lcm file, the own
/// checksum of checksums_t, and defect_of() a run_description_t.
template <class Message>
std::string decode(std::span<const uint8_t> bytes, Message& out);

/// What decode() of the type that belongs on `channel` returns.
std::string check_message(Channel channel, std::span<const uint8_t> bytes);

}  // namespace throng
