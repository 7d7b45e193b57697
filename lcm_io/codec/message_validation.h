// Message validation decodes messages that may be damaged, malicious or foreign.
// Invariant: the lengths of a message are checked against its size before the generated decoder
// runs. That decoder would throw, allocate gigabytes or read out of bounds otherwise.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "lcm_io/codec/channels.h"
#include "throng/messages.hpp"

namespace throng {

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

int64_t fingerprint_of(Channel channel);

/// Reads and checks the header of a message: size, fingerprint, schema, chunk numbers. Returns the
/// defect, or "".
std::string read_header(Channel channel, std::span<const uint8_t> bytes, MessageHeader& header);

/// Decodes a message of any type of THRONG_MESSAGES. Returns the defect, and leaves `out` unusable,
/// if lengths or a rule of the .lcm file are broken. Also checks the checksum of checksums_t and
/// the defect_of() a run_description_t.
template <class Message>
std::string decode(std::span<const uint8_t> bytes, Message& out);

std::string check_message(Channel channel, std::span<const uint8_t> bytes);

}  // namespace throng
