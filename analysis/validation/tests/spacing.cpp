// How near people walk, in experiments walked again with the recording's own inflow.
#include <fmt/format.h>

#include <utility>
#include <vector>

#include "analysis/validation/judging_behaviour.h"
#include "analysis/validation/recorded_inflow.h"

namespace throng::validation {
namespace {

constexpr double kThroughWithin_s = 300;
/// One crowd's distances differ from another's by one or two hundredths of a metre.
constexpr uint64_t kSpacingCrowds = 3;

using Spacings = std::vector<SpeedAndSpacing::Spacing>;

/// What several crowds kept on average, those with more pairs counting more.
Spacings mean_of(const std::vector<Spacings>& crowds) {
  Spacings mean = crowds.front();
  for (size_t cell = 0; cell < mean.size(); ++cell) {
    uint64_t pairs = 0;
    decltype(mean[cell].quantiles_m) sums{};
    for (const Spacings& crowd : crowds) {
      pairs += crowd[cell].pairs;
      for (size_t k = 0; k < sums.size(); ++k)
        sums[k] += static_cast<double>(crowd[cell].pairs) * crowd[cell].quantiles_m[k];
    }
    mean[cell].pairs = pairs / crowds.size();
    for (size_t k = 0; k < sums.size() && pairs > 0; ++k)
      mean[cell].quantiles_m[k] = sums[k] / static_cast<double>(pairs);
  }
  return mean;
}

Outcome spacing(const std::string& id, const Conditions& conditions) {
  Outcome outcome;
  const InflowSite site = inflow_site(id, conditions);
  const auto recording = recording_of(site, conditions, outcome);
  if (recording == nullptr) return outcome;
  const auto theirs = recorded_spacing(site.plan.scene, *recording);
  std::vector<Spacings> ours;
  for (uint64_t crowd = 0; crowd < kSpacingCrowds; ++crowd) {
    const InflowSite again = inflow_site(id, conditions.of_run(crowd, kSpacingCrowds));
    ours.push_back(steered_spacing(with_inflow(again, *recording), kThroughWithin_s, outcome));
  }
  return judged(std::move(outcome), judge_spacing(mean_of(ours), theirs));
}

constexpr const char* kCriterion =
    "of the distances to others within 1.2 m, by density and side, 5 and 25 % within 0.08 m of the "
    "recording and 1 % within 0.12 m, in cells with 500 pairs, half of the recording's reached, "
    "as the mean of three crowds; source: {} of the Pedestrian Dynamics Data Archive";

}  // namespace

std::vector<Test> spacing_tests() {
  return {
      {{"spacing_corridor"},
       {"Spacing in a corridor with an exit of 1.2 m"},
       "A corridor of 8 m x 1.8 m with an exit of 1.2 m behind a room; 170 people enter when and "
       "where those of the recording did. Places of heads, ten times a "
       "second.",
       fmt::format(fmt::runtime(kCriterion), "uo-180-180-120 (Hermes project)"),
       [](const Conditions& conditions) { return spacing("spacing_corridor", conditions); }},
      {{"spacing_door"},
       {"Spacing before a door of 0.5 m"},
       "A door of 0.5 m in a barrier; 75 people who begin in the rectangle in which those of the "
       "recording did.",
       fmt::format(fmt::runtime(kCriterion), "040_c_56_h- (Wuppertal 2018)"),
       [](const Conditions& conditions) { return spacing("spacing_door", conditions); }}};
}

}  // namespace throng::validation
