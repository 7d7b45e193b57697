// Sixteen people at a time: stepping_feet-inl.h and stepping_legs-inl.h over vector registers.
#include <array>
#include <cstddef>
#include <cstdint>

#include "avatars/stepping/stepping_kernels.h"
#include "avatars/stepping/stepping_tables.h"
#include "kinematics/sin_cos.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "avatars/stepping/stepping_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "avatars/stepping/lanes_many-inl.h"

#undef THRONG_LANES
#define THRONG_LANES HWY_INLINE

HWY_BEFORE_NAMESPACE();
namespace throng::HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
namespace {

#include "avatars/stepping/stepping_legs-inl.h"
// Feet after legs: they share what lanes can do.
#include "avatars/stepping/stepping_feet-inl.h"

}  // namespace

void walk_all(const SteppingTables& tables, WalkChunk& chunk) {
  for (size_t first = 0; first < chunk.count; first += kLanes) walk_feet(tables, chunk, first);
  for (size_t first = 0; first < chunk.count; first += kLanes) walk_legs(tables, chunk, first);
}

#endif
}  // namespace throng::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace throng {

void walk_simd(const SteppingTables& tables, WalkChunk& chunk, SimdTarget target) {
  switch (target) {
#if HWY_TARGETS & HWY_SSE4
    case SimdTarget::kSse4:
      return N_SSE4::walk_all(tables, chunk);
#endif
#if HWY_TARGETS & HWY_AVX2
    case SimdTarget::kAvx2:
      return N_AVX2::walk_all(tables, chunk);
#endif
#if HWY_TARGETS & HWY_AVX3
    case SimdTarget::kAvx512:
      return N_AVX3::walk_all(tables, chunk);
#endif
    default:
      return walk_one_by_one(tables, chunk);
  }
}

}  // namespace throng
#endif
