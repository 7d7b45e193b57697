// RunningChecksums counts and checksums the messages of each channel, as checksums_t reports them.
// Invariant: sender and checker share this definition, and any change within eight bytes of a
// message changes the checksum of its channel.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "lcm_io/codec/channels.h"
#include "throng/checksums_t.hpp"

namespace throng {

/// Value of checksums_t::checksum_kind for this algorithm.
inline constexpr int32_t kChecksumKind = 1;

class RunningChecksums {
 public:
  struct Sum {
    int64_t messages = 0;
    int64_t bytes = 0;
    uint64_t check = 0;
    bool operator==(const Sum&) const = default;
  };

  /// Adds a message: its index among all messages of the sender, its stamp (simulation time), its
  /// size and its checksum().
  void add(Channel channel, int64_t number, int64_t stamp_us, size_t size, uint64_t data_checksum);
  void add(Channel channel, int64_t number, int64_t stamp_us, std::span<const uint8_t> data);

  const Sum& operator[](Channel channel) const { return sums_[static_cast<size_t>(channel)]; }
  Sum& operator[](Channel channel) { return sums_[static_cast<size_t>(channel)]; }
  int64_t messages() const { return messages_; }

  /// Sets the channels of `out` and their totals.
  void fill(checksums_t& out) const;

 private:
  std::array<Sum, kChannelCount> sums_{};
  int64_t messages_ = 0;
};

/// Returns the totals of a channel in a message; all 0 if it does not name the channel.
RunningChecksums::Sum sum_of(Channel channel, const checksums_t& stated);

/// Returns the checksum for the last eight bytes of an encoded checksums_t.
uint64_t self_checksum_of(std::span<const uint8_t> encoded);
void seal(std::span<uint8_t> encoded);

}  // namespace throng
