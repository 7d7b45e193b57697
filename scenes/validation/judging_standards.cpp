#include "scenes/validation/judging_standards.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "scenes/validation/across_seeds.h"

namespace throng::validation {

Judgement judge_one_way(std::span<const OneWaySpeed> points) {
  Judgement out;
  int judged = 0, inside = 0;
  std::string list;
  for (const OneWaySpeed& point : points) {
    // The densities asked for are edges of recorded bins, and a hundredth of a person decides on
    // which side of an edge the measured one lies: so the band is what lies between the middles of
    // two bins.
    const auto band = recorded_one_way_at(point.density_per_m2);
    const std::string at = fmt::format("{:g} per m2", point.asked_per_m2);
    Reading reading{at,
                    "mean speed",
                    "m/s",
                    point.speed_mps,
                    Reading::kNone,
                    band ? band->low_mps : Reading::kNone,
                    band ? band->high_mps : Reading::kNone,
                    {}};
    if (point.asked_per_m2 <= kMostJudged_per_m2) {
      ++judged;
      reading.met = band && excess(reading, point.speed_mps) <= 0;
      inside += *reading.met;
      list += fmt::format("{}{:.2f} per m2: {:.2f} m/s ({:+.0f} %)", list.empty() ? "" : ", ",
                          point.density_per_m2, point.speed_mps,
                          100 * (point.speed_mps / weidmann_mps(point.density_per_m2) - 1));
    }
    out.readings.push_back(std::move(reading));
    out.readings.push_back({at, "density", "1/m2", point.density_per_m2});
  }
  const std::string near = near_bounds(out.readings);
  out.passed = judged > 0 && inside == judged;
  const char* const which = out.passed ? "within" : "outside or within";
  out.summary =
      fmt::format("{}, percentages from Weidmann; {} of {} as recorded; {}", list, inside, judged,
                  near.empty() ? "none within 10 % of a bound"
                               : fmt::format("{} 10 % of a bound: {}", which, near));
  return out;
}

std::string near_bounds(std::span<const Reading> readings) {
  constexpr double kNear = 0.1;
  std::string list;
  for (const Reading& reading : readings) {
    if (!reading.met || std::isnan(reading.ours)) continue;
    const auto name = [&](const char* side, double bound, double beyond) {
      if (std::isnan(bound) || beyond < -kNear * std::abs(bound)) return;
      list += fmt::format("{}{:.2f} {}at {} ({} {:.2f}{})", list.empty() ? "" : ", ", reading.ours,
                          reading.unit.empty() ? "" : reading.unit + " ", reading.at, side, bound,
                          beyond > 0 ? ", outside" : "");
    };
    name("at least", reading.low, reading.low - reading.ours);
    name("at most", reading.high, reading.ours - reading.high);
  }
  return list;
}

}  // namespace throng::validation
