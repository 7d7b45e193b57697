// Checksum and Hasher compute 64-bit sums: over bytes to detect damage, over values to name scenes
// and runs. They do not protect against malice.
// Invariant: every step is a bijection of the state for a given word, and of the word for a given
// state. A change within one aligned 8-byte word always changes the result. Any other change goes
// unnoticed with probability 2^-64.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace throng {

/// Bijection after which every bit depends on every bit (finaliser of SplitMix64, Steele et al.
/// 2014).
constexpr uint64_t mixed(uint64_t value) {
  value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9ull;
  value = (value ^ (value >> 27)) * 0x94d049bb133111ebull;
  return value ^ (value >> 31);
}

/// Returns the state after one more word; the order of the words counts.
constexpr uint64_t chained(uint64_t state, uint64_t word) {
  return mixed(state * 0xd1342543de82ef95ull + word + 0x9e3779b97f4a7c15ull);
}

/// Checksum of the bytes, the same on every machine. Four independent lanes of words hide the
/// latency of the multiplications, as in xxHash (Collet 2012); the steps differ from xxHash.
uint64_t checksum(std::span<const uint8_t> bytes);
uint64_t checksum(std::string_view text);

/// Hashes values, not memory layout; every compiler and machine computes the same hash.
class Hasher {
 public:
  Hasher& add(uint64_t value) {
    state_ = mixed(state_ + value + 0x9e3779b97f4a7c15ull);
    return *this;
  }
  /// -0.0 and 0.0 have one hash.
  Hasher& add(double value) { return add(std::bit_cast<uint64_t>(value + 0.0)); }
  Hasher& add(std::string_view text) {
    add(uint64_t{text.size()});
    for (const char c : text) add(uint64_t{static_cast<unsigned char>(c)});
    return *this;
  }
  uint64_t value() const { return state_; }

 private:
  uint64_t state_ = 0;
};

}  // namespace throng
