// C_o, C_u and C_v, each measured on its own.
// One rule: inputs come in random order and never repeat within a repetition, so that no branch is
// learned; a cost is a median over repetitions, with its spread.
#pragma once

#include <array>
#include <vector>

#include "bench/paper/methods.h"
#include "bench/workbench/repeat.h"

namespace throng::paper {

using bench::Cost;
using bench::cost_of;

/// The paper's 500, 1000 and 5000 frames, as multiples of the first.
inline constexpr std::array<int, 3> kRunLengths = {1, 2, 10};

struct MethodCosts {
  std::vector<Cost> construction;  ///< by object
  Cost construction_all;           ///< C_o: all objects once
  Cost update;                     ///< C_u
  Cost test;                       ///< C_v
  double primitive_ns = 0;         ///< C_p: exact only, a test of two boxes or triangles
  std::array<double, kRunLengths.size()>
      run_ms{};  ///< whole runs by the thread's clock, construction apart
};

/// `frames` frames of Part I feed C_u and C_v; each volume is built `constructions` times.
std::array<MethodCosts, kMethods.size()> measure_costs(const std::vector<Object>& objects,
                                                       int frames, uint64_t seed,
                                                       int constructions);

}  // namespace throng::paper
