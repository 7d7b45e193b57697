#include "lcm_io/codec/running_checks.h"

#include <algorithm>
#include <cassert>

#include "base/checksum.h"
#include "lcm_io/codec/log_format.h"

namespace throng {
namespace {

constexpr size_t kOwnBytes = sizeof(checks_t::own_check);

}  // namespace

void RunningChecks::add(Channel channel, int64_t number, int64_t stamp_us, size_t size,
                        uint64_t data_checksum) {
  Sum& sum = (*this)[channel];
  ++messages_;
  ++sum.messages;
  sum.bytes += static_cast<int64_t>(size);
  for (const uint64_t word : {checksum(name_of(channel)), static_cast<uint64_t>(number),
                              static_cast<uint64_t>(stamp_us), data_checksum})
    sum.check = chained(sum.check, word);
}

void RunningChecks::add(Channel channel, int64_t number, int64_t stamp_us,
                        std::span<const uint8_t> data) {
  add(channel, number, stamp_us, data.size(), checksum(data));
}

void RunningChecks::fill(checks_t& out) const {
  out.check_kind = kCheckKind;
  size_t named = 0;
  for (const Channel channel : kAllChannels) named += is_named(channel, (*this)[channel].messages);
  out.channel_count = static_cast<int32_t>(named);
  out.channels.resize(named);
  out.messages.resize(named);
  out.bytes.resize(named);
  out.checks.resize(named);
  size_t i = 0;
  for (const Channel channel : kAllChannels) {
    const Sum& sum = (*this)[channel];
    if (!is_named(channel, sum.messages)) continue;
    out.channels[i] = name_of(channel);
    out.messages[i] = sum.messages;
    out.bytes[i] = sum.bytes;
    out.checks[i] = static_cast<int64_t>(sum.check);
    ++i;
  }
}

RunningChecks::Sum sum_of(Channel channel, const checks_t& said) {
  const auto at = std::find(said.channels.begin(), said.channels.end(), name_of(channel));
  if (at == said.channels.end()) return {};
  const auto i = static_cast<size_t>(at - said.channels.begin());
  return {said.messages[i], said.bytes[i], static_cast<uint64_t>(said.checks[i])};
}

uint64_t own_check_of(std::span<const uint8_t> encoded) {
  assert(encoded.size() >= kOwnBytes);
  return checksum(encoded.first(encoded.size() - kOwnBytes));
}

void seal(std::span<uint8_t> encoded) {
  put_big_endian(encoded.data() + encoded.size() - kOwnBytes, own_check_of(encoded));
}

}  // namespace throng
