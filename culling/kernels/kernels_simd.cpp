#include "culling/kernels/kernels.h"

// SSSE3 without SSE4 has no machine of interest: it runs the scalar loops.
#define HWY_DISABLED_TARGETS HWY_SSSE3
// One compilation a target; Highway includes this file once for each.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "culling/kernels/kernels_simd.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "culling/kernels/kernels_boxes-inl.h"
#include "culling/kernels/kernels_ordop-inl.h"
#include "culling/kernels/kernels_pair-inl.h"
#include "culling/kernels/kernels_search-inl.h"

#if HWY_TARGET != HWY_SCALAR
HWY_BEFORE_NAMESPACE();
namespace throng::HWY_NAMESPACE {
extern const Kernels kKernels;
const Kernels kKernels = {sphere_run,      body_runs,       part_boxes,      box_pairs,
                          ordop_pairs<14>, ordop_pairs<18>, ordop_pairs<26>, ordop_pair<14>,
                          ordop_pair<18>,  ordop_pair<26>};
}  // namespace throng::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE
#include <cassert>

#include "culling/kernels/kernels_scalar.h"

namespace throng {

const Kernels& kernels_for(SimdTarget target) {
  switch (resolved(target)) {
#if HWY_TARGETS & HWY_AVX3
    case SimdTarget::kAvx512:
      return N_AVX3::kKernels;
#endif
#if HWY_TARGETS & HWY_AVX2
    case SimdTarget::kAvx2:
      return N_AVX2::kKernels;
#endif
#if HWY_TARGETS & HWY_SSE4
    case SimdTarget::kSse4:
      return N_SSE4::kKernels;
#endif
    default:
      return scalar_kernels();
  }
}

}  // namespace throng
#endif  // HWY_ONCE
