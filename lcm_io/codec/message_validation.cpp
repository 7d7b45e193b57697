#include "lcm_io/codec/message_validation.h"

#include <fmt/format.h>

#include <exception>
#include <type_traits>

#include "base/limits.h"
#include "lcm_io/codec/description.h"
#include "lcm_io/codec/log_format.h"
#include "lcm_io/codec/running_checksums.h"
#include "scenes/separation/body_region.h"
#include "throng/layouts.hpp"

namespace throng {
namespace {

// 285 years in microseconds; prevents overflow in sums of such numbers.
constexpr int64_t kMaxNumber = int64_t{1} << 53;

/// Walks over the encoded fields without storing them. After a length that does not fit it stays
/// failed. The walk() of each type is generated from its .lcm file.
class Cursor {
 public:
  explicit Cursor(std::span<const uint8_t> bytes) : bytes_(bytes) {}

  void skip(size_t bytes) {
    if (bytes > left()) ok_ = false;
    if (ok_) at_ += bytes;
  }
  /// Reads an int32 that counts items of at least `min_bytes` bytes each.
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
    // The length includes a terminating zero, and generated code subtracts one without a check.
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

template <class Message>
std::string lengths_of(std::span<const uint8_t> bytes) {
  Cursor cursor(bytes.subspan(8));
  walk(cursor, static_cast<const Message*>(nullptr));
  if (!cursor.ok()) return fmt::format("a length in {} that does not fit", Message::getTypeName());
  if (!cursor.is_at_end()) return fmt::format("extra bytes after {}", Message::getTypeName());
  return "";
}

/// Decodes after the walk has checked the lengths; the try block covers exceptions of other
/// generators.
template <class Message>
std::string decode_walked(std::span<const uint8_t> bytes, Message& out) {
  try {
    out = Message();  // the generated decoder keeps old values in arrays that are now empty
    const auto size = static_cast<int>(bytes.size());
    if (out.decode(bytes.data(), 0, size) == size) return "";
  } catch (const std::exception&) {
  }
  return fmt::format("no {}", Message::getTypeName());
}

/// Checks rules that a .lcm file cannot express.
template <class Message>
std::string further_defect(const Message&, std::span<const uint8_t>) {
  return "";
}
std::string further_defect(const checksums_t& m, std::span<const uint8_t> bytes) {
  return static_cast<uint64_t>(m.self_checksum) == self_checksum_of(bytes)
             ? ""
             : "checksums that are damaged themselves";
}
std::string further_defect(const run_description_t& m, std::span<const uint8_t>) {
  return defect_of(m);
}

// The rules of the .lcm files contain these numbers.
static_assert(PairKey::kMaxId == 16777215 && kWholeBody == 255 && kBodyRegions == 9);
static_assert(static_cast<int>(PairLevel::kTriangles) == 3 && kMaxDescriptionBytes == 67108864);
static_assert(kMaxNumber == 9007199254740992);

std::string fingerprint_defect(int64_t found, int64_t expected, std::string_view name) {
  if (found == expected) return "";
  return fmt::format(
      "fingerprint {:016x}, this program's {} has {:016x}: another version of Throng?",
      static_cast<uint64_t>(found), name, static_cast<uint64_t>(expected));
}

template <class Message>
std::string head_defect(std::span<const uint8_t> bytes) {
  constexpr bool is_description = std::is_same_v<Message, run_description_t>;
  constexpr size_t max_size = is_description ? kMaxDescriptionBytes : kMaxMessageBytes;
  if (bytes.size() < 8 || bytes.size() > max_size)
    return fmt::format("{} bytes, expected 8 to {}", bytes.size(), max_size);
  return fingerprint_defect(get_big_endian<int64_t>(bytes.data()), Message::getHash(),
                            Message::getTypeName());
}

}  // namespace

int64_t fingerprint_of(Channel channel) {
  return with_type_of(channel, []<class Message>() { return Message::getHash(); });
}

std::string read_header(Channel channel, std::span<const uint8_t> bytes, MessageHeader& header) {
  if (bytes.size() < kHeaderBytes || bytes.size() > kMaxMessageBytes)
    return fmt::format("{} bytes, expected {} to {}", bytes.size(), kHeaderBytes, kMaxMessageBytes);
  const uint8_t* at = bytes.data();
  const auto next64 = [&at] { return get_big_endian<int64_t>((at += 8) - 8); };
  const auto next32 = [&at] { return get_big_endian<int32_t>((at += 4) - 4); };
  header.fingerprint = next64();
  std::string defect =
      fingerprint_defect(header.fingerprint, fingerprint_of(channel), name_of(channel));
  if (!defect.empty()) return defect;
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

template <class Message>
std::string decode(std::span<const uint8_t> bytes, Message& out) {
  std::string defect;
  if constexpr (kChannelOf<Message> >= 0) {
    MessageHeader header;
    defect = read_header(static_cast<Channel>(kChannelOf<Message>), bytes, header);
  } else {
    defect = head_defect<Message>(bytes);
  }
  if (defect.empty()) defect = lengths_of<Message>(bytes);
  if (defect.empty()) defect = decode_walked(bytes, out);
  if (defect.empty() && out.schema != kSchema)
    defect = fmt::format("schema {}, this program reads {}", out.schema, kSchema);
  if (defect.empty()) defect = further_defect(out, bytes);
  if (defect.empty()) defect = broken_rule(out);
  return defect;
}

#define THRONG_DECODE(Message) template std::string decode(std::span<const uint8_t>, Message&);
THRONG_MESSAGES(THRONG_DECODE)
#undef THRONG_DECODE

std::string check_message(Channel channel, std::span<const uint8_t> bytes) {
  return with_type_of(channel, [bytes]<class Message>() {
    Message message;
    return decode(bytes, message);
  });
}

}  // namespace throng
