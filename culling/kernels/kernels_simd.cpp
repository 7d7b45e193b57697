#include "base/simd/dispatch.h"
#include "culling/kernels/kernels.h"

// One compilation per target; Highway includes this file once for each.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "culling/kernels/kernels_simd.cpp"
#include <hwy/foreach_target.h>

#include "culling/kernels/kernels_boxes-inl.h"
#include "culling/kernels/kernels_ordop-inl.h"

#if THRONG_HAS_LANES
HWY_BEFORE_NAMESPACE();
namespace throng::HWY_NAMESPACE {
extern const Kernels kKernels;
const Kernels kKernels = {sphere_run,      body_runs,       part_boxes,      box_pairs,
                          ordop_pairs<14>, ordop_pairs<18>, ordop_pairs<26>, ordop_gaps,
                          ordop_pair<14>,  ordop_pair<18>,  ordop_pair<26>};
}  // namespace throng::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE
#include <cassert>

namespace throng {

const Kernels& kernels_for(SimdTarget target) {
  return *THRONG_CHOOSE(resolved(target), kKernels, scalar_kernels());
}

}  // namespace throng
#endif  // HWY_ONCE
