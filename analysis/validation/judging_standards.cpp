#include "analysis/validation/judging_standards.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/validation/across_seeds.h"

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

namespace {

bool is_jam(const Crowding& crowding) { return crowding.jammed > kJamLasts; }
bool is_queue(const Crowding& crowding) { return crowding.most_per_m2 > kQueue_per_m2; }

void list_crowding(const Crowding& crowding, const std::string& at, bool asks_for_jam,
                   Judgement& out) {
  const double none = Reading::kNone;
  out.readings.push_back({at, "most people over 10 s", "1/m2", crowding.most_per_m2, none,
                          asks_for_jam ? kQueue_per_m2 : none, asks_for_jam ? none : kQueue_per_m2,
                          is_queue(crowding) == asks_for_jam, true});
  out.readings.push_back(
      {at, fmt::format("share of the time above {:g} per m2", kQueue_per_m2), "", crowding.queued});
  out.readings.push_back({at, fmt::format("share of the time above {:g} per m2", kJam_per_m2), "",
                          crowding.jammed, none, asks_for_jam ? kJamLasts : none,
                          asks_for_jam ? none : kJamLasts, is_jam(crowding) == asks_for_jam});
}

}  // namespace

Judgement judge_necks(std::span<const PassedNeck> necks, double exit_m) {
  Judgement out;
  bool grows = true, all_through = true;
  double narrower_per_s = 0;
  std::string list;
  const PassedNeck* as_wide = nullptr;
  for (const PassedNeck& neck : necks) {
    const bool is_more = neck.flow_per_s > narrower_per_s;
    grows = grows && is_more;
    all_through = all_through && neck.all_through;
    out.readings.push_back({fmt::format("neck of {:g} m", neck.width_m), "flow", "1/s",
                            neck.flow_per_s, Reading::kNone, narrower_per_s, Reading::kNone,
                            is_more});
    narrower_per_s = neck.flow_per_s;
    list += fmt::format("{}{:.2f}/s through {:g} m", list.empty() ? "" : ", ", neck.flow_per_s,
                        neck.width_m);
    if (std::abs(neck.width_m - exit_m) < 1e-9) as_wide = &neck;
  }
  if (as_wide == nullptr) return out;
  const Crowding &first = as_wide->before_neck, &second = as_wide->before_exit;
  list_crowding(first, "before the neck", true, out);
  list_crowding(second, "before the exit", false, out);
  out.passed = grows && all_through && is_jam(first) && !is_jam(second);
  out.differs = out.passed && is_queue(second);
  out.summary = fmt::format(
      "{}{}; with {:g} m at most {:.2f} people per m2 over 10 s before the neck and {:.2f} before "
      "the exit of the second room, where RiMEA expects no congestion: {} (more than {:g} per m2 "
      "for {:.0f} % of the time, more than {:g} for {:.0f} %; before the neck {:.0f} and {:.0f} %)",
      list, all_through ? "" : ", not everybody came through", exit_m, first.most_per_m2,
      second.most_per_m2,
      is_jam(second)     ? "people jam"
      : is_queue(second) ? "people queue"
                         : "there is none",
      kQueue_per_m2, 100 * second.queued, kJam_per_m2, 100 * second.jammed, 100 * first.queued,
      100 * first.jammed);
  return out;
}

}  // namespace throng::validation
