// 64-bit sums: a checksum of bytes that finds damage, quickly, and a hash over values that names
// scenes and runs. They are no protection against malice. Every step is a bijection of the running
// state for a given word, and of the word for a given state. So a change within eight bytes that
// lie in one word (a flipped bit, a wrong byte) is certain to change the result; any other change
// does but for one chance in 2^64.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace throng {

/// A bijection after which every bit depends on every bit (the finaliser of SplitMix64, Steele et
/// al. 2014).
constexpr uint64_t mixed(uint64_t value) {
  value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9ull;
  value = (value ^ (value >> 27)) * 0x94d049bb133111ebull;
  return value ^ (value >> 31);
}

/// A running state after one word more; the order of the words counts.
constexpr uint64_t chained(uint64_t state, uint64_t word) {
  return mixed(state * 0xd1342543de82ef95ull + word + 0x9e3779b97f4a7c15ull);
}

/// Four lanes of words side by side, so that a core need not wait for one multiplication before it
/// begins the next: the idea of xxHash (Collet 2012), the steps our own. The same on every machine.
uint64_t checksum(std::span<const uint8_t> bytes);
uint64_t checksum(std::string_view text);

/// A hash that sees values, never memory layout, so every compiler and machine agrees.
class Hasher {
 public:
  Hasher& add(uint64_t value) {
    state_ = mixed(state_ + value + 0x9e3779b97f4a7c15ull);
    return *this;
  }
  /// Adding 0.0 makes one zero of the two.
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
