#include "base/checksum.h"

#include <array>
#include <cstring>

namespace throng {
namespace {

constexpr size_t kLanes = 4;
constexpr size_t kBlockBytes = kLanes * sizeof(uint64_t);
using Lanes = std::array<uint64_t, kLanes>;

/// The 8 bytes as a little-endian word, on every machine.
uint64_t word_at(const uint8_t* bytes) {
  uint64_t word = 0;
  if constexpr (std::endian::native == std::endian::little)
    std::memcpy(&word, bytes, sizeof word);
  else
    for (size_t i = 0; i < sizeof word; ++i) word |= uint64_t{bytes[i]} << (8 * i);
  return word;
}

/// A bijection: odd factors have an inverse modulo 2^64, as have rotations and exclusive or.
inline void take_block(Lanes& lanes, const uint8_t* block) {
  for (size_t i = 0; i < kLanes; ++i)
    lanes[i] = std::rotl((lanes[i] ^ word_at(block + 8 * i)) * 0x9fb21c651e98df25ull, 29);
}

}  // namespace

uint64_t checksum(std::span<const uint8_t> bytes) {
  // Four different seeds: words that change lanes change the sum.
  Lanes lanes = {0x243f6a8885a308d3, 0x13198a2e03707344, 0xa4093822299f31d0, 0x082efa98ec4e6c89};
  const uint8_t* at = bytes.data();
  for (size_t left = bytes.size() / kBlockBytes; left > 0; --left, at += kBlockBytes)
    take_block(lanes, at);
  if (const size_t rest = bytes.size() % kBlockBytes; rest > 0) {
    uint8_t block[kBlockBytes] = {};  // padded with zeros; the size distinguishes them from data
    std::memcpy(block, at, rest);
    take_block(lanes, block);
  }
  uint64_t sum = bytes.size();
  for (const uint64_t lane : lanes) sum = chained(sum, lane);
  return sum;
}

uint64_t checksum(std::string_view text) {
  return checksum({reinterpret_cast<const uint8_t*>(text.data()), text.size()});
}

}  // namespace throng
