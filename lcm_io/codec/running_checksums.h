// What was said so far, channel by channel, as counts and running checksums: what checksums_t says.
// One rule: sender and judge use this one definition, and any change within eight bytes of a
// message is certain to change its channel's sum.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "lcm_io/codec/channels.h"
#include "throng/checksums_t.hpp"

namespace throng {

/// checksums_t::checksum_kind of what is below.
inline constexpr int32_t kChecksumKind = 1;

class RunningChecksums {
 public:
  struct Sum {
    int64_t messages = 0;
    int64_t bytes = 0;
    uint64_t check = 0;
    bool operator==(const Sum&) const = default;
  };

  /// A message: its place in the sender's count of messages on all channels, its stamp (simulation
  /// time), its size and checksum().
  void add(Channel channel, int64_t number, int64_t stamp_us, size_t size, uint64_t data_checksum);
  void add(Channel channel, int64_t number, int64_t stamp_us, std::span<const uint8_t> data);

  const Sum& operator[](Channel channel) const { return sums_[static_cast<size_t>(channel)]; }
  Sum& operator[](Channel channel) { return sums_[static_cast<size_t>(channel)]; }
  /// On all channels.
  int64_t messages() const { return messages_; }

  /// Fills in the channels and what was said on them.
  void fill(checksums_t& out) const;

 private:
  std::array<Sum, kChannelCount> sums_{};
  int64_t messages_ = 0;
};

/// What a message says of a channel; all 0 if it does not name it.
RunningChecksums::Sum sum_of(Channel channel, const checksums_t& stated);

/// The checksum that belongs into the last eight bytes of an encoded checksums_t.
uint64_t self_checksum_of(std::span<const uint8_t> encoded);
/// Puts it there.
void seal(std::span<uint8_t> encoded);

}  // namespace throng
