// Decodes messages that may be damaged, hostile, or somebody else's.
// One rule: nothing of a message is believed before its lengths add up to its size exactly; then
// the generated decoder, which would throw, allocate gigabytes or read wild, is safe to call.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "lcm_io/codec/channels.h"
#include "throng/answer_t.hpp"
#include "throng/checks_t.hpp"
#include "throng/contact_points_t.hpp"
#include "throng/drive_t.hpp"
#include "throng/end_t.hpp"
#include "throng/events_t.hpp"
#include "throng/frame_stats_t.hpp"
#include "throng/near_t.hpp"
#include "throng/parts_t.hpp"
#include "throng/run_description_t.hpp"
#include "throng/run_t.hpp"
#include "throng/separation_t.hpp"
#include "throng/states_t.hpp"
#include "throng/touching_t.hpp"

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
inline constexpr size_t kMessageHeaderBytes = 60;

/// The fingerprint of the type that belongs on a channel.
int64_t fingerprint_of(Channel channel);

/// Reads and checks the header of a message: size, fingerprint, schema, chunk numbers. Returns what
/// is wrong, or "".
std::string read_header(Channel channel, std::span<const uint8_t> bytes, MessageHeader& header);

/// Decodes a whole message, or says what is wrong and leaves `out` unusable.
std::string decode(std::span<const uint8_t> bytes, run_t& out);
std::string decode(std::span<const uint8_t> bytes, states_t& out);
std::string decode(std::span<const uint8_t> bytes, events_t& out);
std::string decode(std::span<const uint8_t> bytes, touching_t& out);
std::string decode(std::span<const uint8_t> bytes, near_t& out);
std::string decode(std::span<const uint8_t> bytes, separation_t& out);
std::string decode(std::span<const uint8_t> bytes, contact_points_t& out);
std::string decode(std::span<const uint8_t> bytes, frame_stats_t& out);
std::string decode(std::span<const uint8_t> bytes, end_t& out);
std::string decode(std::span<const uint8_t> bytes, parts_t& out);
/// Its own checksum is right, too.
std::string decode(std::span<const uint8_t> bytes, checks_t& out);

/// The description that the pieces of THRONG_RUN add up to; checked by defect_of() as well.
std::string decode(std::span<const uint8_t> bytes, run_description_t& out);

/// What moves a driven group; every list has as many items as it says.
std::string decode(std::span<const uint8_t> bytes, drive_t& out);
std::string decode(std::span<const uint8_t> bytes, answer_t& out);

/// Header and lengths of the message that belongs on `channel`; what is wrong, or "".
std::string check_message(Channel channel, std::span<const uint8_t> bytes);

}  // namespace throng
