// SimdTarget selects the vector instructions of a fast path at run time.
// Invariant: every target computes the same bits.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace throng {

/// kScalar is the scalar reference, kBest the best target of this machine.
enum class SimdTarget { kBest, kScalar, kSse4, kAvx2, kAvx512 };

/// "best", "scalar", "sse4", "avx2", "avx512".
std::string_view name_of(SimdTarget target);
std::optional<SimdTarget> simd_target_of(std::string_view name);
std::vector<std::string> simd_target_names();

/// Targets that this machine can run, from kScalar upwards, without kBest.
std::vector<SimdTarget> simd_targets_of_this_machine();

/// Returns the best target of this machine for kBest, otherwise `target`. Throws EnvironmentError
/// if this machine cannot run it.
SimdTarget resolved(SimdTarget target);

}  // namespace throng
