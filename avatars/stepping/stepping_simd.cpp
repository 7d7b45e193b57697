// SIMD version of stepping, over two registers of people.
#include <array>
#include <cstddef>
#include <cstdint>

#include "avatars/stepping/stepping_kernels.h"
#include "base/simd/dispatch.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "avatars/stepping/stepping_simd.cpp"
#include <hwy/foreach_target.h>

#include "base/simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace throng::HWY_NAMESPACE {
#if THRONG_HAS_LANES
namespace register_pairs {
namespace {

// Order matters: each header uses those before it.
#include "base/simd/angles-inl.h"
//
#include "avatars/stepping/stepping_legs-inl.h"
//
#include "avatars/stepping/stepping_feet-inl.h"

}  // namespace
}  // namespace register_pairs

void walk_all(const SteppingTables& tables, WalkBatch& batch) {
  using register_pairs::kLaneCount;
  for (size_t first = 0; first < batch.count; first += kLaneCount)
    register_pairs::walk_feet(tables, batch, first);
  for (size_t first = 0; first < batch.count; first += kLaneCount)
    register_pairs::walk_legs(tables, batch, first);
}

#endif
}  // namespace throng::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace throng {

void walk_simd(const SteppingTables& tables, WalkBatch& batch, SimdTarget target) {
  THRONG_CHOOSE(target, walk_all, walk_scalar)(tables, batch);
}

}  // namespace throng
#endif
