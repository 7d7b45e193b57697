#include "lcm_io/codec/guard.h"

#include <fmt/format.h>

#include <algorithm>
#include <exception>

#include "base/limits.h"
#include "lcm_io/codec/description.h"
#include "lcm_io/codec/log_format.h"
#include "lcm_io/codec/running_checks.h"
#include "scenes/separation/body_region.h"

namespace throng {
namespace {

// 285 years of microseconds; keeps sums of such numbers from overflowing.
constexpr int64_t kMaxNumber = int64_t{1} << 53;

/// Walks over the encoded fields without storing anything. Once a length does not fit, it fails for
/// good. Each walk() below follows the .lcm file of its type field by field.
class Cursor {
 public:
  explicit Cursor(std::span<const uint8_t> bytes) : bytes_(bytes) {}

  void skip(size_t bytes) {
    if (bytes > left()) ok_ = false;
    if (ok_) at_ += bytes;
  }
  /// An int32 that counts things of at least `min_bytes` bytes each.
  size_t count(size_t min_bytes) {
    const size_t at = at_;
    skip(4);
    if (!ok_) return 0;
    const auto n = get_big_endian<int32_t>(bytes_.data() + at);
    if (n < 0 || static_cast<size_t>(n) > left() / min_bytes) ok_ = false;
    return ok_ ? static_cast<size_t>(n) : 0;
  }
  void array(size_t items, size_t item_bytes) { skip(items * item_bytes); }
  void string() {
    // The length includes a terminating zero, and generated code takes one off without looking.
    const size_t length = count(1);
    if (length == 0) ok_ = false;
    skip(length);
    if (ok_ && bytes_[at_ - 1] != 0) ok_ = false;
  }
  bool ok() const { return ok_; }
  bool is_at_end() const { return ok_ && at_ == bytes_.size(); }

 private:
  size_t left() const { return bytes_.size() - at_; }

  std::span<const uint8_t> bytes_;
  size_t at_ = 0;
  bool ok_ = true;
};

void walk(Cursor& c, const run_t*) {
  c.skip(kMessageHeaderBytes + 4 + 4);
  c.skip(c.count(1));
}

void walk(Cursor& c, const states_t*) {
  c.skip(kMessageHeaderBytes + 4);
  const size_t avatars = c.count(3 * 4 + 4 * 2 + 4);
  c.array(avatars, 3 * 4 + 4 * 2 + 4);
  c.skip(c.count(1));
  c.array(c.count(2), 2);
  c.skip(4);
}

void walk(Cursor& c, const events_t*) {
  c.skip(kMessageHeaderBytes);
  c.array(c.count(12), 12);
}

void walk(Cursor& c, const touching_t*) {
  c.skip(kMessageHeaderBytes);
  c.array(c.count(11), 11);
}

void walk(Cursor& c, const near_t*) {
  c.skip(kMessageHeaderBytes + 4 + 4 + 8);
  constexpr size_t kRow = 4 * 1 + 2 * 4 + 2 * 4 + 6 * 8 + 5 * 4;
  c.array(c.count(kRow), kRow);
}

void walk(Cursor& c, const contact_points_t*) {
  c.skip(kMessageHeaderBytes);
  constexpr size_t kRow = 2 * 4 + 2 * 1 + 3 * 8 + 4 * 4;
  c.array(c.count(kRow), kRow);
}

void walk(Cursor& c, const separation_t*) {
  c.skip(kMessageHeaderBytes);
  constexpr size_t kRow = 4 * 1 + 2 * 4 + 8 + 3 * 4;
  c.array(c.count(kRow), kRow);
}

void walk(Cursor& c, const frame_stats_t*) {
  c.skip(kMessageHeaderBytes + (5 * 5 + 5 + 9 + 1) * sizeof(int64_t));
}

void walk(Cursor& c, const end_t*) {
  c.skip(kMessageHeaderBytes + 4 * sizeof(int64_t));
  const size_t channels = c.count(5 + 8 + 8);
  for (size_t i = 0; i < channels && c.ok(); ++i) c.string();
  c.array(channels, 8 + 8);
}

void walk(Cursor& c, const checks_t*) {
  c.skip(kMessageHeaderBytes);
  for (int i = 0; i < 3; ++i) c.string();
  c.skip(8 + 8);
  c.string();
  c.skip(1 + 1 + 8 + 4 + 8 + 8 + 4);
  const size_t channels = c.count(5 + 8 + 8 + 8);
  for (size_t i = 0; i < channels && c.ok(); ++i) c.string();
  c.array(channels, 8 + 8 + 8);
  c.skip(8);
}

void walk(Cursor& c, const parts_t*) {
  c.skip(kMessageHeaderBytes + 4 + 4);
  c.array(c.count(3 * 4 + 4 * 2), 3 * 4 + 4 * 2);
  c.skip(4);
}

/// Avatars and joints, as what comes from controllers ends.
void walk_poses(Cursor& c) {
  constexpr size_t kPerAvatar = 4 + 3 * 8 + 4 * 4 + 2 * 4;
  c.array(c.count(kPerAvatar), kPerAvatar);
  c.array(c.count(8), 8);
}

void walk(Cursor& c, const drive_t*) {
  c.skip(8 + 8 + 8 + 4);
  walk_poses(c);
}

void walk(Cursor& c, const answer_t*) {
  c.skip(8 + 4 * 8 + 4);
  walk_poses(c);
}

void walk_mesh(Cursor& c) {
  c.array(c.count(4), 4);
  c.array(c.count(4), 4);
}

void walk_obstacle(Cursor& c) {
  c.string();
  c.skip(1 + 7 * 8);
  walk_mesh(c);
}

void walk_model(Cursor& c) {
  c.string();
  c.skip(8);
  c.string();
  constexpr size_t kJointFixed = 1 + 4 + (3 + 4 + 3 + 2) * 8 + 4 + 2 * 8 + 4;
  const size_t joints = c.count(kJointFixed);
  for (size_t i = 0; i < joints && c.ok(); ++i) {
    c.string();
    c.string();
    c.skip(kJointFixed);
  }
  const size_t parts = c.count(2 * 5 + 4 + 8);
  for (size_t i = 0; i < parts && c.ok(); ++i) {
    c.string();
    c.string();
    c.skip(4);
    walk_mesh(c);
  }
  c.array(c.count(16), 16);
}

void walk(Cursor& c, const run_description_t*) {
  c.skip(8 + 4);
  c.string();
  c.skip(8 + 8);
  c.string();
  c.skip(1 + 4 * 8);
  const size_t obstacles = c.count(5 + 1 + 7 * 8 + 8);
  for (size_t i = 0; i < obstacles && c.ok(); ++i) walk_obstacle(c);
  const size_t models = c.count(5 + 8 + 5 + 3 * 4);
  for (size_t i = 0; i < models && c.ok(); ++i) walk_model(c);
  c.array(c.count(8), 8);
  const size_t groups = c.count(5 + 5);
  for (size_t i = 0; i < 2 * groups && c.ok(); ++i) c.string();
}

template <class Message>
std::string lengths_of(std::span<const uint8_t> bytes) {
  Cursor cursor(bytes);
  walk(cursor, static_cast<const Message*>(nullptr));
  if (!cursor.ok()) return fmt::format("a length in {} that does not fit", Message::getTypeName());
  if (!cursor.is_at_end()) return fmt::format("bytes after the end of {}", Message::getTypeName());
  return "";
}

/// The walk has proved the lengths; the try is for whatever else a newer generator might throw.
template <class Message>
std::string decode_walked(std::span<const uint8_t> bytes, Message& out) {
  try {
    out = Message();  // the generated decoder leaves old values in arrays that are now empty
    const auto size = static_cast<int>(bytes.size());
    if (out.decode(bytes.data(), 0, size) == size) return "";
  } catch (const std::exception&) {
  }
  return fmt::format("no {}", Message::getTypeName());
}

template <class Message>
std::string decode_message(Channel channel, std::span<const uint8_t> bytes, Message& out) {
  MessageHeader header;
  std::string defect = read_header(channel, bytes, header);
  if (defect.empty()) defect = lengths_of<Message>(bytes);
  if (defect.empty()) defect = decode_walked(bytes, out);
  return defect;
}

/// What a controller sent: without the header of a run's messages.
template <class Message>
std::string decode_from_outside(std::span<const uint8_t> bytes, Message& out) {
  if (bytes.size() < 8 || bytes.size() > kMaxMessageBytes)
    return fmt::format("{} bytes, expected 8 to {}", bytes.size(), kMaxMessageBytes);
  if (get_big_endian<int64_t>(bytes.data()) != Message::getHash())
    return fmt::format("fingerprint {:016x}, this program's {} has {:016x}: another version?",
                       get_big_endian<uint64_t>(bytes.data()), Message::getTypeName(),
                       static_cast<uint64_t>(Message::getHash()));
  std::string defect = lengths_of<Message>(bytes);
  if (defect.empty()) defect = decode_walked(bytes, out);
  if (defect.empty() && out.schema != kSchema)
    defect = fmt::format("schema {}, this program reads {}", out.schema, kSchema);
  return defect;
}

template <class Message>
std::string defect_of_pairs(const Message& m) {
  for (size_t i = 0; i < m.a.size(); ++i) {
    if (m.a[i] < 0 || m.a[i] >= m.b[i] || m.b[i] > static_cast<int32_t>(PairKey::kMaxId))
      return fmt::format("a pair of bodies {} and {}", m.a[i], m.b[i]);
    if ((m.part_a[i] == kWholeBody) != (m.part_b[i] == kWholeBody))
      return fmt::format("a pair of parts {} and {}", m.part_a[i], m.part_b[i]);
    if constexpr (requires { m.level; })
      if (m.level[i] > static_cast<uint8_t>(PairLevel::kExact))
        return fmt::format("level {}", m.level[i]);
  }
  return "";
}

}  // namespace

int64_t fingerprint_of(Channel channel) {
  switch (channel) {
    case Channel::kRun:
      return run_t::getHash();
    case Channel::kStates:
      return states_t::getHash();
    case Channel::kEvents:
      return events_t::getHash();
    case Channel::kTouching:
      return touching_t::getHash();
    case Channel::kFrameStats:
      return frame_stats_t::getHash();
    case Channel::kEnd:
      return end_t::getHash();
    case Channel::kParts:
      return parts_t::getHash();
    case Channel::kChecks:
      return checks_t::getHash();
    case Channel::kNear:
      return near_t::getHash();
    case Channel::kSeparation:
      return separation_t::getHash();
    case Channel::kContacts:
      return contact_points_t::getHash();
  }
  return 0;
}

std::string read_header(Channel channel, std::span<const uint8_t> bytes, MessageHeader& header) {
  if (bytes.size() < kMessageHeaderBytes || bytes.size() > kMaxMessageBytes)
    return fmt::format("{} bytes, expected {} to {}", bytes.size(), kMessageHeaderBytes,
                       kMaxMessageBytes);
  const uint8_t* at = bytes.data();
  const auto next64 = [&at] { return get_big_endian<int64_t>((at += 8) - 8); };
  const auto next32 = [&at] { return get_big_endian<int32_t>((at += 4) - 4); };
  header.fingerprint = next64();
  if (header.fingerprint != fingerprint_of(channel))
    return fmt::format(
        "fingerprint {:016x}, this program's {} has {:016x}: another version of Throng?",
        static_cast<uint64_t>(header.fingerprint), name_of(channel),
        static_cast<uint64_t>(fingerprint_of(channel)));
  header.utime_us = next64();
  header.run_id = next64();
  header.instance = next64();
  header.frame = next64();
  header.seq = next64();
  header.chunk = next32();
  header.chunk_count = next32();
  header.schema = next32();
  if (header.schema != kSchema)
    return fmt::format("schema {}, this program reads {}", header.schema, kSchema);
  for (const int64_t number : {header.utime_us, header.frame, header.seq})
    if (number < 0 || number > kMaxNumber) return fmt::format("utime, frame or seq {}", number);
  if (header.chunk_count < 1 || header.chunk_count > kMaxChunks || header.chunk < 0 ||
      header.chunk >= header.chunk_count)
    return fmt::format("chunk {} of {}", header.chunk, header.chunk_count);
  return "";
}

std::string decode(std::span<const uint8_t> bytes, run_t& out) {
  std::string defect = decode_message(Channel::kRun, bytes, out);
  if (!defect.empty()) return defect;
  if (out.total_bytes <= 0 || static_cast<size_t>(out.total_bytes) > kMaxDescriptionBytes ||
      out.offset < 0 || out.size <= 0 || out.size > out.total_bytes - out.offset)
    return fmt::format("bytes {} + {} of {}", out.offset, out.size, out.total_bytes);
  return "";
}

std::string decode(std::span<const uint8_t> bytes, states_t& out) {
  std::string defect = decode_message(Channel::kStates, bytes, out);
  if (defect.empty() && out.present_count != 0 && out.present_count != out.avatar_count)
    return fmt::format("presence of {} of {} avatars", out.present_count, out.avatar_count);
  return defect;
}

std::string decode(std::span<const uint8_t> bytes, events_t& out) {
  std::string defect = decode_message(Channel::kEvents, bytes, out);
  if (!defect.empty()) return defect;
  for (const uint8_t kind : out.kind)
    if (kind > 1) return fmt::format("event kind {}", kind);
  return defect_of_pairs(out);
}

std::string decode(std::span<const uint8_t> bytes, touching_t& out) {
  std::string defect = decode_message(Channel::kTouching, bytes, out);
  if (!defect.empty()) return defect;
  return defect_of_pairs(out);
}

std::string decode(std::span<const uint8_t> bytes, near_t& out) {
  std::string defect = decode_message(Channel::kNear, bytes, out);
  if (defect.empty()) defect = defect_of_pairs(out);
  for (size_t i = 0; defect.empty() && i < out.a.size(); ++i) {
    // Written so that NaN is refused, too.
    if (!(out.lo_m[i] >= 0 && out.lo_m[i] <= out.hi_m[i]))
      defect = fmt::format("a distance from {} to {} m", out.lo_m[i], out.hi_m[i]);
    if (out.of[i] > 1) defect = fmt::format("near rows of kind {}", out.of[i]);
  }
  return defect;
}

std::string decode(std::span<const uint8_t> bytes, contact_points_t& out) {
  std::string defect = decode_message(Channel::kContacts, bytes, out);
  if (defect.empty()) defect = defect_of_pairs(out);
  for (size_t i = 0; defect.empty() && i < out.a.size(); ++i)
    if (!(out.depth_m[i] >= 0)) defect = fmt::format("a depth of {} m", out.depth_m[i]);
  return defect;
}

std::string decode(std::span<const uint8_t> bytes, separation_t& out) {
  std::string defect = decode_message(Channel::kSeparation, bytes, out);
  for (size_t i = 0; defect.empty() && i < out.robot.size(); ++i) {
    if (out.kind[i] > 1) defect = fmt::format("event kind {}", out.kind[i]);
    if (out.region[i] >= kBodyRegions) defect = fmt::format("region {}", out.region[i]);
    if (out.robot[i] < 0 || out.person[i] < 0 || out.robot[i] == out.person[i])
      defect = fmt::format("a robot {} and a person {}", out.robot[i], out.person[i]);
    if (out.begin_frame[i] < 0 || out.begin_frame[i] > out.frame)
      defect = fmt::format("a begin at frame {}", out.begin_frame[i]);
    // Written so that NaN is refused, too.
    if (!(out.least_lo_m[i] >= 0 && out.least_lo_m[i] <= out.least_hi_m[i]))
      defect = fmt::format("a distance from {} to {} m", out.least_lo_m[i], out.least_hi_m[i]);
    if (!(out.most_short_m[i] >= 0))
      defect = fmt::format("a shortfall of {} m", out.most_short_m[i]);
  }
  return defect;
}

std::string decode(std::span<const uint8_t> bytes, frame_stats_t& out) {
  return decode_message(Channel::kFrameStats, bytes, out);
}

std::string decode(std::span<const uint8_t> bytes, end_t& out) {
  std::string defect = decode_message(Channel::kEnd, bytes, out);
  if (!defect.empty()) return defect;
  for (const auto* totals : {&out.messages, &out.bytes})
    for (const int64_t total : *totals)
      if (total < 0 || total > kMaxNumber) return fmt::format("a total of {}", total);
  return "";
}

std::string decode(std::span<const uint8_t> bytes, checks_t& out) {
  std::string defect = decode_message(Channel::kChecks, bytes, out);
  if (!defect.empty()) return defect;
  if (static_cast<uint64_t>(out.own_check) != own_check_of(bytes))
    return "checks that are damaged themselves";
  if (out.number < 0 || out.number > kMaxNumber) return fmt::format("number {}", out.number);
  for (const auto* totals : {&out.messages, &out.bytes})
    for (const int64_t total : *totals)
      if (total < 0 || total > kMaxNumber) return fmt::format("a total of {}", total);
  return "";
}

std::string decode(std::span<const uint8_t> bytes, parts_t& out) {
  return decode_message(Channel::kParts, bytes, out);
}

std::string decode(std::span<const uint8_t> bytes, drive_t& out) {
  std::string defect = decode_from_outside(bytes, out);
  if (defect.empty() && (out.seq < 0 || out.seq > kMaxNumber))
    defect = fmt::format("seq {}", out.seq);
  return defect;
}

std::string decode(std::span<const uint8_t> bytes, answer_t& out) {
  std::string defect = decode_from_outside(bytes, out);
  // The frame before the first has the number -1.
  if (defect.empty() && (out.frame < -1 || out.frame > kMaxNumber))
    defect = fmt::format("frame {}", out.frame);
  return defect;
}

std::string decode(std::span<const uint8_t> bytes, run_description_t& out) {
  if (bytes.size() < 8 || bytes.size() > kMaxDescriptionBytes)
    return fmt::format("{} bytes", bytes.size());
  if (get_big_endian<int64_t>(bytes.data()) != run_description_t::getHash())
    return fmt::format(
        "fingerprint {:016x}, this program's run description has {:016x}: another version of "
        "Throng?",
        get_big_endian<uint64_t>(bytes.data()),
        static_cast<uint64_t>(run_description_t::getHash()));
  std::string defect = lengths_of<run_description_t>(bytes);
  if (defect.empty()) defect = decode_walked(bytes, out);
  if (defect.empty()) defect = defect_of(out);
  return defect;
}

namespace {

template <class Message>
std::string check(std::span<const uint8_t> bytes) {
  Message message;
  return decode(bytes, message);
}

}  // namespace

std::string check_message(Channel channel, std::span<const uint8_t> bytes) {
  switch (channel) {
    case Channel::kRun:
      return check<run_t>(bytes);
    case Channel::kStates:
      return check<states_t>(bytes);
    case Channel::kEvents:
      return check<events_t>(bytes);
    case Channel::kTouching:
      return check<touching_t>(bytes);
    case Channel::kFrameStats:
      return check<frame_stats_t>(bytes);
    case Channel::kEnd:
      return check<end_t>(bytes);
    case Channel::kParts:
      return check<parts_t>(bytes);
    case Channel::kChecks:
      return check<checks_t>(bytes);
    case Channel::kNear:
      return check<near_t>(bytes);
    case Channel::kSeparation:
      return check<separation_t>(bytes);
    case Channel::kContacts:
      return check<contact_points_t>(bytes);
  }
  return "an unknown channel";
}

}  // namespace throng
