// Which vector instructions a fast path uses, chosen at run time.
// One rule: the choice changes speed and nothing else; every target gives the same bits.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace throng {

/// kScalar is the plain loop that the others are tested against. kBest stands for the best target
/// that this machine has.
enum class SimdTarget { kBest, kScalar, kSse4, kAvx2, kAvx512 };

/// "best", "scalar", "sse4", "avx2", "avx512".
std::string_view name_of(SimdTarget target);
std::optional<SimdTarget> simd_target_of(std::string_view name);
std::vector<std::string> simd_target_names();

/// What this machine can run, from kScalar upwards, kBest left out.
std::vector<SimdTarget> simd_targets_of_this_machine();

/// Never kBest: the best target of this machine for kBest, otherwise `target` itself. Throws
/// EnvironmentError if this machine cannot run it.
SimdTarget resolved(SimdTarget target);

}  // namespace throng
