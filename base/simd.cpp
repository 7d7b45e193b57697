#include "base/simd.h"

#include <fmt/format.h>
#include <hwy/targets.h>

#include <array>
#include <utility>

#include "base/errors.h"

namespace throng {
namespace {

constexpr std::array<std::pair<SimdTarget, std::string_view>, 5> kNames{{
    {SimdTarget::kBest, "best"},
    {SimdTarget::kScalar, "scalar"},
    {SimdTarget::kSse4, "sse4"},
    {SimdTarget::kAvx2, "avx2"},
    {SimdTarget::kAvx512, "avx512"},
}};

bool machine_runs(SimdTarget target) {
  // Cached: Highway executes CPUID each time, which traps in a virtual machine (16 us).
  static const int64_t supported = hwy::SupportedTargets();
  switch (target) {
    case SimdTarget::kBest:
    case SimdTarget::kScalar:
      return true;
    case SimdTarget::kSse4:
      return (supported & HWY_SSE4) != 0;
    case SimdTarget::kAvx2:
      return (supported & HWY_AVX2) != 0;
    case SimdTarget::kAvx512:
      return (supported & HWY_AVX3) != 0;
  }
  return false;
}

}  // namespace

std::string_view name_of(SimdTarget target) { return kNames[static_cast<size_t>(target)].second; }

std::optional<SimdTarget> simd_target_of(std::string_view name) {
  for (const auto& [target, its_name] : kNames)
    if (its_name == name) return target;
  return std::nullopt;
}

std::vector<std::string> simd_target_names() {
  std::vector<std::string> names;
  for (const auto& [target, name] : kNames) names.emplace_back(name);
  return names;
}

std::vector<SimdTarget> simd_targets_of_this_machine() {
  std::vector<SimdTarget> targets;
  for (const auto& [target, name] : kNames)
    if (target != SimdTarget::kBest && machine_runs(target)) targets.push_back(target);
  return targets;
}

SimdTarget resolved(SimdTarget target) {
  static const SimdTarget best = simd_targets_of_this_machine().back();
  if (target == SimdTarget::kBest) return best;
  if (!machine_runs(target))
    throw EnvironmentError(fmt::format("this machine cannot run SIMD target '{}'; its best is '{}'",
                                       name_of(target), name_of(best)));
  return target;
}

}  // namespace throng
