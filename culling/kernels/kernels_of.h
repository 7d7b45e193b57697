// Which kernels test a volume.
// One rule: a volume that is not named here is placed and tested pair by pair.
#pragma once

#include "culling/kernels/kernels.h"
#include "culling/volumes/ordop.h"

namespace throng {

/// The kernels of a volume that has some: pairs of the same two parts as lanes, and one pair.
template <typename V>
struct KernelsOf {
  static constexpr bool kExist = false;
};
template <>
struct KernelsOf<Ordop<14>> {
  static constexpr bool kExist = true;
  static constexpr auto kPairs = &Kernels::ordop_pairs_14;
  static constexpr auto kPair = &Kernels::ordop_pair_14;
  static constexpr int kDirectionCount = 14;
};
template <>
struct KernelsOf<Ordop<18>> {
  static constexpr bool kExist = true;
  static constexpr auto kPairs = &Kernels::ordop_pairs_18;
  static constexpr auto kPair = &Kernels::ordop_pair_18;
  static constexpr int kDirectionCount = 18;
};
template <>
struct KernelsOf<Ordop<26>> {
  static constexpr bool kExist = true;
  static constexpr auto kPairs = &Kernels::ordop_pairs_26;
  static constexpr auto kPair = &Kernels::ordop_pair_26;
  static constexpr int kDirectionCount = 26;
};

}  // namespace throng
