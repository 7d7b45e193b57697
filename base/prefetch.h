// Functions that ask for memory before it is needed.
// One rule: they are inlined early. To an optimizer a function that does nothing else has no
// effect, and GCC drops its calls.
#pragma once

#include <cstddef>

#define THRONG_PREFETCH [[gnu::always_inline]] inline

namespace throng {

/// In bytes, of most processors that there are.
inline constexpr size_t kCacheLine = 64;

}  // namespace throng
