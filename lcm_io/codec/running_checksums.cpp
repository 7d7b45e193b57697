#include "lcm_io/codec/running_checksums.h"

#include <algorithm>
#include <cassert>

#include "base/checksum.h"
#include "lcm_io/codec/log_format.h"

namespace throng {
namespace {

constexpr size_t kSelfChecksumBytes = sizeof(checksums_t::self_checksum);

}  // namespace

void RunningChecksums::add(Channel channel, int64_t number, int64_t stamp_us, size_t size,
                           uint64_t data_checksum) {
  Sum& sum = (*this)[channel];
  ++messages_;
  ++sum.messages;
  sum.bytes += static_cast<int64_t>(size);
  for (const uint64_t word : {checksum(name_of(channel)), static_cast<uint64_t>(number),
                              static_cast<uint64_t>(stamp_us), data_checksum})
    sum.check = chained(sum.check, word);
}

void RunningChecksums::add(Channel channel, int64_t number, int64_t stamp_us,
                           std::span<const uint8_t> data) {
  add(channel, number, stamp_us, data.size(), checksum(data));
}

void RunningChecksums::fill(checksums_t& out) const {
  out.checksum_kind = kChecksumKind;
  size_t named = 0;
  for (const Channel channel : kAllChannels) named += is_named(channel, (*this)[channel].messages);
  out.channel_count = static_cast<int32_t>(named);
  out.channels.resize(named);
  out.messages.resize(named);
  out.bytes.resize(named);
  out.checksums.resize(named);
  size_t i = 0;
  for (const Channel channel : kAllChannels) {
    const Sum& sum = (*this)[channel];
    if (!is_named(channel, sum.messages)) continue;
    out.channels[i] = name_of(channel);
    out.messages[i] = sum.messages;
    out.bytes[i] = sum.bytes;
    out.checksums[i] = static_cast<int64_t>(sum.check);
    ++i;
  }
}

RunningChecksums::Sum sum_of(Channel channel, const checksums_t& stated) {
  const auto at = std::find(stated.channels.begin(), stated.channels.end(), name_of(channel));
  if (at == stated.channels.end()) return {};
  const auto i = static_cast<size_t>(at - stated.channels.begin());
  return {stated.messages[i], stated.bytes[i], static_cast<uint64_t>(stated.checksums[i])};
}

uint64_t self_checksum_of(std::span<const uint8_t> encoded) {
  assert(encoded.size() >= kSelfChecksumBytes);
  return checksum(encoded.first(encoded.size() - kSelfChecksumBytes));
}

void seal(std::span<uint8_t> encoded) {
  put_big_endian(encoded.data() + encoded.size() - kSelfChecksumBytes, self_checksum_of(encoded));
}

}  // namespace throng
