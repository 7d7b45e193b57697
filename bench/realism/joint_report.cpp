#include "bench/realism/joint_report.h"

#include <fmt/format.h>

#include <cmath>

#include "analysis/measures/measure_table.h"

namespace throng::realism {
namespace {

std::string quantiles(const Histogram& histogram, int digits) {
  std::string text;
  for (const double share : {0.5, 0.95, 0.999, 1.0})
    text += histogram.count() == 0 ? fmt::format("{:>9}", "-")
                                   : fmt::format("{:>9.{}f}", histogram.quantile(share), digits);
  return text;
}

std::string over(uint64_t count, uint64_t all) {
  return all == 0
             ? fmt::format("{:>9}", "-")
             : fmt::format("{:>9.4f}", 100 * static_cast<double>(count) / static_cast<double>(all));
}

std::string joint_lines(const JointSpeeds& speeds, bool accelerations) {
  std::string text = fmt::format("  {:<21}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}\n",
                                 accelerations ? "accelerations, /s2" : "speeds, /s", "50 %",
                                 "95 %", "99.9 %", "most", "limit", "% over");
  for (const auto& [name, motion] : speeds.joints()) {
    const Histogram& all = accelerations ? motion.accelerations : motion.speeds;
    const JointLimit* const limit = limit_of(name);
    text += fmt::format(
        "  {:<21}{}{}{}\n", name + (motion.is_prismatic ? ", m" : ""),
        quantiles(all, motion.is_prismatic ? (accelerations ? 2 : 3) : 0),
        limit == nullptr ? fmt::format("{:>9}", "-")
                         : fmt::format("{:>9g}", accelerations ? limit->acceleration_per_s2
                                                               : limit->speed_per_s),
        over(accelerations ? motion.over_acceleration : motion.over_speed, all.count()));
  }
  return text;
}

std::string swing_lines(const ArmSwing& swing) {
  std::string text = fmt::format("  {:<21}{:>9}{:>9}{:>9}\n", "arm swing, per m2", "person s",
                                 "mean deg", "% of own");
  const auto& bounds = ArmSwing::kBounds_per_m2;
  for (size_t i = 0; i < ArmSwing::kLevels; ++i) {
    const SwingAt& at = swing.levels()[i];
    if (!(at.time_s > 0)) continue;
    text += fmt::format("  {:<21}{:>9.0f}{:>9.1f}{:>9.2f}\n",
                        range_text(i == 0 ? 0 : bounds[i - 1],
                                   i < bounds.size() ? std::optional(bounds[i]) : std::nullopt),
                        at.time_s, at.mean_deg(), 100 * at.share());
  }
  return text;
}

}  // namespace

std::string joint_report(const std::string& name, const JointSpeeds& speeds,
                         const ArmSwing& swing) {
  std::string text = fmt::format(
      "{}: {} frames of people; in degrees, or metres where it says so\n", name, speeds.frames());
  text += joint_lines(speeds, false) + joint_lines(speeds, true);
  text += fmt::format("  {:<21}{:>9}{:>15}\n", "frames above, %", "speed", "acceleration");
  for (const auto& [what, half] :
       {std::pair("legs and pelvis", BodyHalf::kLegs), std::pair("upper body", BodyHalf::kUpper)})
    text += fmt::format("  {:<21}{}{:>15}\n", what,
                        over(speeds.frames_over_speed(half), speeds.frames()),
                        over(speeds.frames_over_acceleration(half), speeds.frames()));
  text += swing_lines(swing);
  text += fmt::format("  {:<21}{:>9}{:>9}{:>9}{:>9}{:>9}\n", "turns of roots, deg/s", "frames",
                      "50 %", "95 %", "99 %", "most");
  for (const auto& [what, turns] :
       {std::pair("standing", &speeds.standing_turns()), std::pair("all", &speeds.turns())}) {
    text += fmt::format("  {:<21}{:>9}", what, turns->count());
    for (const double share : {0.5, 0.95, 0.99, 1.0})
      text += turns->count() == 0 ? fmt::format("{:>9}", "-")
                                  : fmt::format("{:>9.1f}", turns->quantile(share));
    text += "\n";
  }
  return text;
}

}  // namespace throng::realism
