// A 64-bit hash over values, for naming scenes and runs.
// One rule: it sees values, never memory layout, so every compiler and machine agrees.
#pragma once

#include <bit>
#include <cstdint>
#include <string_view>

#include "base/checksum.h"

namespace throng {

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
