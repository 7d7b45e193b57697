#include "analysis/validation/verdicts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "analysis/measures/speed_and_spacing.h"
#include "analysis/validation/validation.h"

namespace throng::validation {
namespace {

constexpr double kMaxRelativeError = 0.15;
constexpr double kMinInBand = 0.7;
constexpr double kMinBins = 0.5;

std::vector<double> shares_of(std::span<const double> lanes) {
  const double sum = std::accumulate(lanes.begin(), lanes.end(), 0.0);
  std::vector<double> out(lanes.begin(), lanes.end());
  for (double& share : out) share = sum > 0 ? share / sum : 0;
  return out;
}

std::string lane_name(size_t lane) {
  return fmt::format("{:.1f} to {:.1f} m", 0.5 * static_cast<double>(lane),
                     0.5 * static_cast<double>(lane + 1));
}

template <class Holds>
double share_of(const std::vector<double>& values, const Holds& holds) {
  if (values.empty()) return Reading::kNone;
  return static_cast<double>(std::count_if(values.begin(), values.end(), holds)) /
         static_cast<double>(values.size());
}

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double median_of(std::vector<double> values) {
  if (values.empty()) return Reading::kNone;
  const auto middle = values.begin() + static_cast<ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Mean speed of the samples in a bin of density; none with fewer than kMinSamples.
double mean_speed(std::span<const DensitySpeed> samples, double from) {
  double sum_mps = 0;
  size_t count = 0;
  for (const DensitySpeed& sample : samples) {
    if (sample.density < from || sample.density >= from + kRecordedBin) continue;
    sum_mps += sample.speed_mps;
    ++count;
  }
  return count < kMinSamples ? Reading::kNone : sum_mps / static_cast<double>(count);
}

}  // namespace

Judgement judge_doors(std::span<const DoorFlow> flows) {
  Judgement out;
  int near = 0, falls = 0, blocked = 0;
  double before_per_s = 0;
  for (const DoorFlow& flow : flows) {
    const double recorded = recorded_door(flow.width_m).mean_per_s();
    const double low = (1 - kMaxRelativeError) * recorded,
                 high = (1 + kMaxRelativeError) * recorded;
    const bool is_near = flow.flow_per_s >= low && flow.flow_per_s <= high;
    const bool rises = flow.flow_per_s >= before_per_s;
    const bool all_through = flow.through == flow.people;
    near += is_near;
    falls += !rises;
    blocked += !all_through;
    before_per_s = flow.flow_per_s;
    const std::string at = fmt::format("{:.1f} m", flow.width_m);
    out.readings.push_back(
        {at, "flow", "1/s", flow.flow_per_s, recorded, low, high, is_near && rises});
    const double people = flow.people;
    out.readings.push_back({at, "people through", "", static_cast<double>(flow.through),
                            Reading::kNone, people, people, all_through});
  }
  const auto count = static_cast<int>(flows.size());
  out.readings.push_back({"all widths", "widths within 15 %", "", static_cast<double>(near),
                          Reading::kNone, static_cast<double>(count), static_cast<double>(count),
                          near == count, true});
  out.passed = count > 0 && near == count && falls == 0 && blocked == 0;
  out.summary = fmt::format(
      "{} of {} widths within 15 % of the experiments' mean; the flow falls {} times from a width "
      "to the next; people are left behind at {} widths",
      near, count, falls, blocked);
  return out;
}

Judgement judge_speeds(const RecordedCurve& curve, std::span<const DensitySpeed> samples) {
  Judgement out;
  int measured = 0, inside = 0;
  double off_mps = 0;
  for (const RecordedBin& bin : curve.bins) {
    Reading reading{fmt::format("{:g} to {:g} {}", bin.from, bin.from + kRecordedBin, curve.unit),
                    "mean speed",
                    "m/s",
                    Reading::kNone,
                    bin.mean_mps,
                    bin.low_mps,
                    bin.high_mps,
                    {}};
    if (const double mean = mean_speed(samples, bin.from); !std::isnan(mean)) {
      reading.simulated = mean;
      reading.met = mean >= bin.low_mps && mean <= bin.high_mps;
      ++measured;
      inside += *reading.met;
      off_mps += std::abs(mean - bin.mean_mps);
    }
    out.readings.push_back(std::move(reading));
  }
  const auto bins = static_cast<double>(curve.bins.size());
  const double off = measured > 0 ? off_mps / measured / curve.desired_speed_mps : Reading::kNone;
  const double share = measured > 0 ? static_cast<double>(inside) / measured : 0;
  const bool enough = measured >= kMinBins * bins;
  out.readings.push_back({"all bins", "mean error, of desired speed", "", off, Reading::kNone, 0,
                          kMaxRelativeError, off <= kMaxRelativeError, true});
  out.readings.push_back({"all bins", "share in the band", "", share, Reading::kNone, kMinInBand, 1,
                          share >= kMinInBand, true});
  out.readings.push_back({"all bins", "bins with 20 samples", "", static_cast<double>(measured),
                          Reading::kNone, kMinBins * bins, bins, enough, true});
  out.passed = enough && off <= kMaxRelativeError && share >= kMinInBand;
  out.summary = fmt::format(
      "means {:.0f} % of the desired speed off on average, {} of {} bins inside the band ({:.0f} "
      "%); "
      "{} of the recording's {} bins reached",
      100 * off, inside, measured, 100 * share, measured, curve.bins.size());
  return out;
}

Judgement judge_fullest_lane(std::span<const double> lanes, double max_share) {
  Judgement out;
  const std::vector<double> shares = shares_of(lanes);
  const auto fullest = std::max_element(shares.begin(), shares.end());
  for (size_t i = 0; i < shares.size(); ++i)
    out.readings.push_back({lane_name(i), "share of person-seconds", "", shares[i], Reading::kNone,
                            Reading::kNone, max_share, shares[i] <= max_share});
  out.passed = fullest != shares.end() && *fullest > 0 && *fullest <= max_share;
  out.readings.push_back({"fullest lane", "share of person-seconds", "",
                          fullest == shares.end() ? 0 : *fullest, Reading::kNone, Reading::kNone,
                          max_share, out.passed, true});
  out.summary =
      fmt::format("the fullest lane holds {:.0f} % of the person-seconds, {} m from the inner wall",
                  fullest == shares.end() ? 0 : 100 * *fullest,
                  0.5 * static_cast<double>(fullest - shares.begin()));
  return out;
}

Judgement judge_used_lanes(std::span<const double> lanes, int min_lanes, double min_share) {
  Judgement out;
  int used = 0;
  std::string list;
  const std::vector<double> shares = shares_of(lanes);
  for (size_t i = 0; i < shares.size(); ++i) {
    used += shares[i] >= min_share;
    list += fmt::format("{}{:.0f}", i == 0 ? "" : " ", 100 * shares[i]);
    out.readings.push_back(
        {lane_name(i), "share of person-seconds", "", shares[i], Reading::kNone, min_share, 1, {}});
  }
  out.passed = used >= min_lanes;
  out.readings.push_back({"all lanes", "lanes with enough", "", static_cast<double>(used),
                          Reading::kNone, static_cast<double>(min_lanes), Reading::kNone,
                          out.passed, true});
  out.summary = fmt::format("{} lanes with {:.0f} % or more; from the inside: {} %", used,
                            100 * min_share, list);
  return out;
}

Judgement judge_overtaking(std::span<const Overtaking> starts) {
  constexpr double kMinShare = 0.95, kMaxLostShare = 0.1;
  Judgement out;
  int past = 0, good = 0;
  double lost = 0;
  for (const Overtaking& start : starts) {
    past += start.passed;
    good += start.passed && start.lost_share <= kMaxLostShare;
    lost += start.lost_share;
  }
  const auto count = static_cast<double>(starts.size());
  const double share = starts.empty() ? 0 : good / count;
  out.passed = share >= kMinShare;
  out.readings = {{"all starts", "pass and lose at most 10 %", "", share, Reading::kNone, kMinShare,
                   1, out.passed, true},
                  {"all starts",
                   "pass",
                   "",
                   starts.empty() ? 0 : past / count,
                   Reading::kNone,
                   kMinShare,
                   1,
                   {}},
                  {"all starts",
                   "mean share of time lost",
                   "",
                   starts.empty() ? 0 : lost / count,
                   Reading::kNone,
                   Reading::kNone,
                   kMaxLostShare,
                   {}}};
  out.summary = fmt::format(
      "{} of {} pass, {} of them losing at most 10 % of their time; {:.0f} % is lost on average",
      past, starts.size(), good, starts.empty() ? 0 : 100 * lost / count);
  return out;
}

Judgement judge_counterflow(std::span<const std::vector<double>> crowds_per_m_s) {
  constexpr double kMinFlow_per_m_s = 1.0, kGridlock = 0.1;
  Judgement out;
  const size_t minutes = crowds_per_m_s.empty() ? 0 : crowds_per_m_s.front().size();
  double sum = 0, worst = minutes > 0 ? crowds_per_m_s.front().front() : 0;
  for (size_t minute = 0; minute < minutes; ++minute) {
    double lowest = crowds_per_m_s.front()[minute];
    for (const std::vector<double>& crowd : crowds_per_m_s) {
      lowest = std::min(lowest, crowd[minute]);
      sum += crowd[minute];
    }
    worst = std::min(worst, lowest);
    out.readings.push_back({fmt::format("minute {}", minute + 1),
                            "flow of both directions, "
                            "slowest crowd",
                            "1/(m s)", lowest, Reading::kNone, kGridlock, Reading::kNone,
                            lowest >= kGridlock});
  }
  const auto count = static_cast<double>(minutes * crowds_per_m_s.size());
  const double mean = count > 0 ? sum / count : 0;
  out.readings.push_back({"all minutes", "flow of both directions", "1/(m s)", mean, Reading::kNone,
                          kMinFlow_per_m_s, Reading::kNone, mean >= kMinFlow_per_m_s, true});
  out.passed = mean >= kMinFlow_per_m_s && worst >= kGridlock;
  out.summary = fmt::format(
      "{:.2f} people/(m s) in both directions over {} min, mean of {} crowds; {:.2f} in the worst "
      "minute",
      mean, minutes, crowds_per_m_s.size(), worst);
  return out;
}

void CounterflowUse::add(CounterflowUse more) {
  from_right_wall_m.insert(from_right_wall_m.end(), more.from_right_wall_m.begin(),
                           more.from_right_wall_m.end());
  lane_orders.insert(lane_orders.end(), more.lane_orders.begin(), more.lane_orders.end());
  speeds.insert(speeds.end(), more.speeds.begin(), more.speeds.end());
}

namespace {

struct UsedWidth {
  double at_wall, central;  ///< shares of the time
  double order;
  double wall_distance_m;  ///< the median
};

UsedWidth used_width(const CounterflowUse& use) {
  std::vector<double> wall_distances_m;
  for (const double y : use.from_right_wall_m)
    wall_distances_m.push_back(std::min(y, use.width_m - y));
  const auto is_at_wall = [](double away_m) { return away_m < CounterflowUse::kAtWall_m; };
  const auto is_central = [&](double y) {
    return std::abs(y - 0.5 * use.width_m) < 0.5 * CounterflowUse::kCentral_m;
  };
  return {share_of(wall_distances_m, is_at_wall), share_of(use.from_right_wall_m, is_central),
          mean_of(use.lane_orders), median_of(wall_distances_m)};
}

void list_lanes(const CounterflowUse& simulated, const CounterflowUse& recorded, Judgement& out) {
  const auto lanes = static_cast<size_t>(simulated.width_m / 0.5);
  for (size_t lane = 0; lane < lanes; ++lane) {
    const auto in_lane = [&](double y) {
      return y >= 0.5 * static_cast<double>(lane) && y < 0.5 * static_cast<double>(lane + 1);
    };
    out.readings.push_back({lane_name(lane), "share of person-seconds", "",
                            share_of(simulated.from_right_wall_m, in_lane),
                            share_of(recorded.from_right_wall_m, in_lane)});
  }
}

struct SpeedMatches {
  int measured = 0, near = 0;
};

SpeedMatches judge_speeds_by_density(const CounterflowUse& simulated,
                                     const CounterflowUse& recorded, Judgement& out) {
  constexpr double kMaxSpeedError = 0.1;
  SpeedMatches speeds;
  for (size_t bin = 0; bin < SpeedAndSpacing::kDensityBins; ++bin) {
    const double from = kRecordedBin * static_cast<double>(bin);
    const double mps = mean_speed(simulated.speeds, from);
    const double recorded_mps = mean_speed(recorded.speeds, from);
    if (std::isnan(mps) || std::isnan(recorded_mps)) continue;
    const bool is_near = std::abs(mps - recorded_mps) <= kMaxSpeedError * recorded_mps;
    ++speeds.measured;
    speeds.near += is_near;
    out.readings.push_back({fmt::format("{:g} to {:g} per m2", from, from + kRecordedBin),
                            "mean speed", "m/s", mps, recorded_mps,
                            (1 - kMaxSpeedError) * recorded_mps,
                            (1 + kMaxSpeedError) * recorded_mps, is_near});
  }
  return speeds;
}

}  // namespace

Judgement judge_counterflow_use(const CounterflowUse& simulated, const CounterflowUse& recorded) {
  constexpr double kMaxAtWall = 2, kMinCentral = 0.75, kMaxLaneOrder = 0.9;
  const UsedWidth used = used_width(simulated), reference = used_width(recorded);
  const double max_at_wall = kMaxAtWall * reference.at_wall;
  const double min_central = kMinCentral * reference.central;
  Judgement out;
  out.readings = {{"within 0.4 m of a wall", "share of the time", "", used.at_wall,
                   reference.at_wall, 0, max_at_wall, used.at_wall <= max_at_wall, true},
                  {"central metre", "share of the time", "", used.central, reference.central,
                   min_central, 1, used.central >= min_central, true},
                  {"middle of the corridor", "lane order", "", used.order, reference.order, 0,
                   kMaxLaneOrder, used.order <= kMaxLaneOrder, true},
                  {"middle of the corridor", "median distance to the nearer wall", "m",
                   used.wall_distance_m, reference.wall_distance_m}};
  list_lanes(simulated, recorded, out);
  const auto [measured, near] = judge_speeds_by_density(simulated, recorded, out);
  out.readings.push_back({"all densities", "speeds within 10 %", "", static_cast<double>(near),
                          Reading::kNone, static_cast<double>(measured),
                          static_cast<double>(measured), measured > 0 && near == measured, true});
  out.passed = std::all_of(out.readings.begin(), out.readings.end(),
                           [](const Reading& reading) { return reading.met.value_or(true); });
  out.summary = fmt::format(
      "{:.0f} % of the time within 0.4 m of a wall (recorded {:.0f} %), {:.0f} % in the central "
      "metre ({:.0f} %), lane order {:.2f} ({:.2f}); speeds within 10 % at {} of {} densities",
      100 * used.at_wall, 100 * reference.at_wall, 100 * used.central, 100 * reference.central,
      used.order, reference.order, near, measured);
  return out;
}

Judgement judge_far_exit(int near, int far, int people) {
  constexpr double kMinShare = 1.0 / 3;
  Judgement out;
  const double share = near + far > 0 ? static_cast<double>(far) / (near + far) : 0;
  const bool all_out = near + far == people;
  out.passed = share >= kMinShare && all_out;
  out.readings = {{"far exit", "share", "", share, Reading::kNone, kMinShare, Reading::kNone,
                   share >= kMinShare, true},
                  {"both exits", "people", "", static_cast<double>(near + far), Reading::kNone,
                   static_cast<double>(people), static_cast<double>(people), all_out}};
  out.summary = fmt::format("{} of {} by the far exit ({:.0f} %), {} by the near one", far, people,
                            100 * share, near);
  return out;
}

Outcome judged(Outcome outcome, Judgement judgement) {
  outcome.passed = judgement.passed;
  outcome.differs = judgement.differs;
  outcome.measured = judgement.summary;
  outcome.readings = std::move(judgement.readings);
  return outcome;
}

Judgement judge_unidirectional(std::span<const UnidirectionalSpeed> points) {
  Judgement out;
  int judged = 0, inside = 0;
  std::string list;
  for (const UnidirectionalSpeed& point : points) {
    // Requested densities are edges of recorded bins, and a deviation of 0.01 people decides on
    // which side of an edge the measured one lies. The band is therefore interpolated between bin
    // centres.
    const auto band = recorded_one_way_at(point.density_per_m2);
    const std::string at = fmt::format("{:g} per m2", point.target_per_m2);
    Reading reading{at,
                    "mean speed",
                    "m/s",
                    point.speed_mps,
                    Reading::kNone,
                    band ? band->low_mps : Reading::kNone,
                    band ? band->high_mps : Reading::kNone,
                    {}};
    if (point.target_per_m2 <= kMaxJudged_per_m2) {
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
  const std::string near = marginal_readings(out.readings);
  out.passed = judged > 0 && inside == judged;
  const char* const which = out.passed ? "within" : "outside or within";
  out.summary =
      fmt::format("{}, percentages from Weidmann; {} of {} as recorded; {}", list, inside, judged,
                  near.empty() ? "none within 10 % of a bound"
                               : fmt::format("{} 10 % of a bound: {}", which, near));
  return out;
}

std::string marginal_readings(std::span<const Reading> readings) {
  constexpr double kMarginalShare = 0.1;
  std::string list;
  for (const Reading& reading : readings) {
    if (!reading.met || std::isnan(reading.simulated)) continue;
    const auto name = [&](const char* side, double bound, double beyond) {
      if (std::isnan(bound) || beyond < -kMarginalShare * std::abs(bound)) return;
      list += fmt::format("{}{:.2f} {}at {} ({} {:.2f}{})", list.empty() ? "" : ", ",
                          reading.simulated, reading.unit.empty() ? "" : reading.unit + " ",
                          reading.at, side, bound, beyond > 0 ? ", outside" : "");
    };
    name("at least", reading.low, reading.low - reading.simulated);
    name("at most", reading.high, reading.simulated - reading.high);
  }
  return list;
}

namespace {

bool is_jam(const Crowding& crowding) { return crowding.jammed > kJamLasts; }
bool is_queue(const Crowding& crowding) { return crowding.max_per_m2 > kQueue_per_m2; }

void list_crowding(const Crowding& crowding, const std::string& at, bool expects_jam,
                   Judgement& out) {
  const double none = Reading::kNone;
  out.readings.push_back({at, "most people over 10 s", "1/m2", crowding.max_per_m2, none,
                          expects_jam ? kQueue_per_m2 : none, expects_jam ? none : kQueue_per_m2,
                          is_queue(crowding) == expects_jam, true});
  out.readings.push_back(
      {at, fmt::format("share of the time above {:g} per m2", kQueue_per_m2), "", crowding.queued});
  out.readings.push_back({at, fmt::format("share of the time above {:g} per m2", kJam_per_m2), "",
                          crowding.jammed, none, expects_jam ? kJamLasts : none,
                          expects_jam ? none : kJamLasts, is_jam(crowding) == expects_jam});
}

}  // namespace

Judgement judge_necks(std::span<const NeckPassage> necks, double exit_m) {
  Judgement out;
  bool grows = true, all_through = true;
  double narrower_per_s = 0;
  std::string list;
  const NeckPassage* as_wide = nullptr;
  for (const NeckPassage& neck : necks) {
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
      list, all_through ? "" : ", people are left behind", exit_m, first.max_per_m2,
      second.max_per_m2,
      is_jam(second)     ? "people jam"
      : is_queue(second) ? "people queue"
                         : "there is none",
      kQueue_per_m2, 100 * second.queued, kJam_per_m2, 100 * second.jammed, 100 * first.queued,
      100 * first.jammed);
  return out;
}

}  // namespace throng::validation
