// Whether values are the same bit by bit: -0 is not 0, and NaN is itself.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

namespace throng {

template <class T>
bool same_bits(std::span<const T> a, std::span<const T> b) {
  const std::span<const std::byte> left = std::as_bytes(a), right = std::as_bytes(b);
  return std::equal(left.begin(), left.end(), right.begin(), right.end());
}

/// Of single values, or of arrays.
template <class T>
bool same_bits(const T& a, const T& b) {
  return same_bits(std::span(&a, 1), std::span(&b, 1));
}

}  // namespace throng
