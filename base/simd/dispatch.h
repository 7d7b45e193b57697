// Dispatch chooses at run time among the SIMD targets that fast paths are compiled for.
// Invariant: a source that Highway compiles once per target includes this first, so all know the
// same targets. SimdTarget chooses, not Highway.
#pragma once

// SSSE3 alone is not worth its code size: every x86-64 since 2008 has SSE4.1.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#include <hwy/detect_targets.h>

#include "base/simd.h"

/// In #if, inside such a source: whether there are registers. The scalar reference is plain C++.
#define THRONG_HAS_LANES (HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128)

namespace throng {

template <typename T>
T* chosen_for(SimdTarget target, T* reference, T* sse4, T* avx2, T* avx512) {
  switch (target) {
    case SimdTarget::kSse4:
      return sse4;
    case SimdTarget::kAvx2:
      return avx2;
    case SimdTarget::kAvx512:
      return avx512;
    case SimdTarget::kBest:  // callers pass a resolved() target
    case SimdTarget::kScalar:
      break;
  }
  return reference;
}

}  // namespace throng

#if HWY_TARGETS & HWY_SSE4
#define THRONG_ON_SSE4(name, reference) N_SSE4::name
#else
#define THRONG_ON_SSE4(name, reference) reference
#endif
#if HWY_TARGETS & HWY_AVX2
#define THRONG_ON_AVX2(name, reference) N_AVX2::name
#else
#define THRONG_ON_AVX2(name, reference) reference
#endif
#if HWY_TARGETS & HWY_AVX3
#define THRONG_ON_AVX512(name, reference) N_AVX3::name
#else
#define THRONG_ON_AVX512(name, reference) reference
#endif

/// Points to the function or constant `name` of throng::HWY_NAMESPACE, compiled for `target`, which
/// this machine has and which is not kBest; to `reference` for kScalar.
#define THRONG_CHOOSE(target, name, reference)                                     \
  ::throng::chosen_for((target), &(reference), &(THRONG_ON_SSE4(name, reference)), \
                       &(THRONG_ON_AVX2(name, reference)), &(THRONG_ON_AVX512(name, reference)))
