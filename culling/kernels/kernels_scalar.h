// The reference kernels: plain loops, one pair at a time.
// One rule: slow and obvious; every SIMD kernel is tested against these to the bit.
#pragma once

#include "culling/kernels/kernels.h"

namespace throng {

const Kernels& scalar_kernels();

}  // namespace throng
