// How much of a long test runs: with every change a part of it, with THRONG_NIGHTLY=1 all of it
// (`scripts/nightly.sh long`).
#pragma once

#include <cstdlib>
#include <string_view>

namespace throng::test {

inline bool is_nightly() {
  const char* const value = std::getenv("THRONG_NIGHTLY");
  return value != nullptr && std::string_view(value) == "1";
}

/// How many of `count` seeds or cases run: a third with every change.
constexpr int kPart = 3;
template <typename Count>
Count part_of(Count count) {
  return is_nightly() ? count : (count + kPart - 1) / kPart;
}

}  // namespace throng::test
