#include "analysis/measures/motion_measures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "analysis/trajectories/walkable_area.h"
#include "base/portable_math.h"

namespace throng {
namespace {

constexpr double kMinStep_s = 0.075, kMaxStep_s = 0.13;
constexpr double kBin_mps2 = 0.02;
constexpr size_t kBins = 2500;

}  // namespace

Accelerations::Accelerations(double sample_s)
    : sample_s_(sample_s),
      is_measured_(sample_s >= kMinStep_s && sample_s <= kMaxStep_s),
      heads_mps2_(0, kBin_mps2, kBins),
      roots_mps2_(0, kBin_mps2, kBins) {}

void Accelerations::take(const RecentCrowd& crowd) {
  if (!is_measured_) return;
  const Moment& before = crowd.ago(2);
  const Moment& at = crowd.ago(1);
  const Moment& after = crowd.ago(0);
  const double square_s2 = sample_s_ * sample_s_;
  for (size_t i = 0; i < at.present.size(); ++i) {
    if (!crowd.stayed(i, 1, 1, 1)) continue;
    heads_mps2_.add((after.heads_m[i] - 2 * at.heads_m[i] + before.heads_m[i]).norm() / square_s2);
    roots_mps2_.add((after.roots_m[i] - 2 * at.roots_m[i] + before.roots_m[i]).norm() / square_s2);
  }
}

MeasureTable Accelerations::table() const {
  MeasureTable table{"accelerations",
                     "Accelerations",
                     "point",
                     "",
                     "Over 0.1 s, in any direction, of the head (which sways) and of the root of "
                     "the "
                     "body.",
                     {},
                     {}};
  for (const auto& [name, histogram] :
       {std::pair("head", &heads_mps2_), std::pair("body", &roots_mps2_)}) {
    if (histogram->count() == 0) continue;
    for (const auto& [what, share] :
         {std::pair("50 %", 0.5), std::pair("95 %", 0.95), std::pair("99.9 %", 0.999)})
      table.rows.push_back({name, {}, {}, "", what, "m/s2", histogram->quantile(share)});
  }
  return table;
}

namespace {

/// Narrower gaps are not passages.
constexpr double kMinWidth_m = 0.3;
constexpr size_t kMaxLines = 24;
/// Minimum distance between the centres of two watched gaps.
constexpr double kApart_m = 1.5;
constexpr double kStep_m = 0.2;
constexpr double kMaxPoints = 40'000;
/// Lines are extended by this at both ends, because heads sway beyond them.
constexpr double kBeyond_m = 0.1;
/// A person must be this far away before another passage counts: swaying on the line is not flow.
constexpr double kLeft_m = 0.5;

/// A line with fewer than 1 / kUsedShare of the busiest line's passages is not in use.
constexpr uint64_t kUsedShare = 5;

double length_m(const Passage& line) { return (line.to_m - line.from_m).norm(); }

double walkable_length_m(const Walkable& walkable, const Passage& line) {
  const int steps = std::max(1, static_cast<int>(std::ceil(length_m(line) / 0.01)));
  int inside = 0;
  for (int i = 0; i < steps; ++i)
    inside +=
        walkable.clearance_m(line.from_m + (i + 0.5) / steps * (line.to_m - line.from_m)) >= 0;
  return length_m(line) * inside / steps;
}

std::vector<double> middles_m(double from_m, double to_m, double cell_m) {
  std::vector<double> middles;
  double at_m = from_m + 0.5 * cell_m;
  while (at_m < to_m) {
    middles.push_back(at_m);
    at_m += cell_m;
  }
  return middles;
}

std::vector<FlowLines::Line> narrow_places(const Walkable& walkable) {
  const Rectangle& ground = walkable.ground();
  const double step_m = std::max(kStep_m, std::sqrt(ground.area_m2() / kMaxPoints));
  std::vector<Gap> gaps;
  const std::vector<double> xs = middles_m(ground.min_m.x(), ground.max_m.x(), step_m);
  for (const double y : middles_m(ground.min_m.y(), ground.max_m.y(), step_m))
    for (const double x : xs) {
      const Eigen::Vector2d point(x, y);
      if (walkable.clearance_m(point) <= 0) continue;
      const Gap gap = walkable.gap_at(point, Walkable::kReach_m);
      if (gap.width_m >= kMinWidth_m && std::isfinite(gap.width_m)) gaps.push_back(gap);
    }
  std::stable_sort(gaps.begin(), gaps.end(),
                   [](const Gap& a, const Gap& b) { return a.width_m < b.width_m; });
  std::vector<FlowLines::Line> lines;
  std::vector<Eigen::Vector2d> middles;
  for (const Gap& gap : gaps) {
    if (lines.size() == kMaxLines) break;
    const Eigen::Vector2d middle = 0.5 * (gap.across.from_m + gap.across.to_m);
    if (std::any_of(middles.begin(), middles.end(), [&](const Eigen::Vector2d& other) {
          return (other - middle).norm() < kApart_m;
        }))
      continue;
    middles.push_back(middle);
    lines.push_back({.across = gap.across, .width_m = length_m(gap.across)});
  }
  return lines;
}

}  // namespace

double FlowLines::Line::flow_per_s() const {
  return passed() < 2 || last_s <= first_s ? 0
                                           : static_cast<double>(passed() - 1) / (last_s - first_s);
}

uint64_t FlowLines::Line::passed_outside() const {
  return static_cast<uint64_t>(std::count(has_passed_outside.begin(), has_passed_outside.end(), 1));
}

FlowLines::FlowLines(const Scene& scene, size_t people, std::optional<Passage> chosen)
    : is_chosen_(chosen.has_value()) {
  const Walkable walkable(scene);
  if (chosen) {
    lines_.push_back({.across = *chosen, .width_m = walkable_length_m(walkable, *chosen)});
  } else {
    lines_ = narrow_places(walkable);
    const Eigen::Vector2d middle = scene.ground.middle_m();
    for (const Passage& line :
         {Passage{{middle.x(), scene.ground.min_m.y()}, {middle.x(), scene.ground.max_m.y()}},
          Passage{{scene.ground.min_m.x(), middle.y()}, {scene.ground.max_m.x(), middle.y()}}})
      lines_.push_back({.across = line, .width_m = walkable_length_m(walkable, line)});
  }
  for (Line& line : lines_) {
    line.has_just_passed.assign(people, 0);
    line.has_passed_outside.assign(people, 0);
  }
}

void FlowLines::take(const RecentCrowd& crowd) {
  const Moment& before = crowd.ago(1);
  const Moment& now = crowd.ago(0);
  for (Line& line : lines_) {
    const Eigen::Vector2d along = (line.across.to_m - line.across.from_m).normalized();
    const double length = length_m(line.across);
    for (size_t i = 0; i < now.present.size(); ++i) {
      if (now.stay[i] < 2) {
        line.has_just_passed[i] = 0;
        continue;
      }
      const Eigen::Vector2d to = now.heads_m[i] - line.across.from_m;
      const Eigen::Vector2d from = before.heads_m[i] - line.across.from_m;
      const double side_to = cross(along, to);
      const double side_from = cross(along, from);
      if (std::abs(side_to) > kLeft_m) line.has_just_passed[i] = 0;
      if ((side_from < 0) == (side_to < 0)) continue;
      const double share = side_from / (side_from - side_to);
      const double place = along.dot(from + share * (to - from));
      const bool is_outside = place < -kBeyond_m || place > length + kBeyond_m;
      if (is_outside) line.has_passed_outside[i] = 1;
      if (is_outside || line.has_just_passed[i] != 0) continue;
      line.has_just_passed[i] = std::abs(side_to) <= kLeft_m;
      const double time_s = before.time_s + share * (now.time_s - before.time_s);
      line.first_s = line.passed() == 0 ? time_s : std::min(line.first_s, time_s);
      line.last_s = std::max(line.last_s, time_s);
      ++(side_to > 0 ? line.forward : line.back);
    }
  }
}

const FlowLines::Line& FlowLines::used() const {
  uint64_t busiest = 0;
  for (const Line& line : lines_) busiest = std::max(busiest, line.passed());
  const auto is_used = [&](const Line& line) { return kUsedShare * line.passed() >= busiest; };
  auto best = std::find_if(lines_.begin(), lines_.end(), is_used);  // exists: the busiest is used
  for (auto line = best; line != lines_.end(); ++line) {
    if (!is_used(*line)) continue;
    const double narrower_m = best->width_m - line->width_m;
    // Of equally wide lines the busier one.
    if (narrower_m > 0.05 || (narrower_m > -0.05 && line->passed() > best->passed())) best = line;
  }
  return *best;
}

MeasureTable FlowLines::table() const {
  const Line& line = used();
  const Passage& at = line.across;
  MeasureTable table{
      "flow",
      "Flow over a line",
      "width",
      "m",
      fmt::format(
          "From ({:.2f}, {:.2f}) to ({:.2f}, {:.2f}) m, walkable width {:.2f} m. "
          "People: passages in both directions. Flow: (N - 1) over the time from the "
          "first to the last passage.{}",
          at.from_m.x(), at.from_m.y(), at.to_m.x(), at.to_m.y(), line.width_m,
          is_chosen_ ? " People past its ends: they cross its straight line beyond an end." : ""),
      {},
      {}};
  const auto row = [&](const std::string& what, const std::string& unit, double value) {
    table.rows.push_back({"the line", line.width_m, {}, "", what, unit, value});
  };
  row("width", "m", line.width_m);
  row("people", "", static_cast<double>(line.passed()));
  row("people in the minor direction", "", static_cast<double>(std::min(line.forward, line.back)));
  if (is_chosen_) row("people past its ends", "", static_cast<double>(line.passed_outside()));
  row("flow", "1/s", line.flow_per_s());
  row("flow per metre", "1/(m s)", line.width_m > 0 ? line.flow_per_s() / line.width_m : 0);
  return table;
}

namespace {

/// Half the window that smooths the path. The weights fall linearly to both sides and remove
/// oscillations of about 1 Hz, to keep all of them in the sway.
constexpr double kHalfSmoothing_s = 1;
/// With rarer samples the extremes are missed.
constexpr double kMaxSwaySample_s = 0.15;
/// Slower people do not sway with their steps.
constexpr double kMinWalking_mps = 0.3;
/// Smaller amplitudes are noise.
constexpr double kMinAmplitude_m = 0.005;
/// Other half waves are not those of steps: 0.4 to 2 strides per second.
constexpr double kMinWave_s = 0.25, kMaxWave_s = 1.25;
/// Averaging time of the deviation caused by cut corners.
constexpr double kLevel_s = 2;
/// Half waves count after this time, when that deviation is known.
constexpr double kSettling_s = 1;
/// Minimum number of half waves for a person's amplitude.
constexpr uint32_t kMinHalfWaves = 4;

}  // namespace

HeadSway::HeadSway(size_t people, double sample_s)
    : half_(half_window(sample_s)), sample_s_(sample_s), waves_(people), people_(people) {}

size_t HeadSway::half_window(double sample_s) {
  return sample_s > kMaxSwaySample_s ? 0
                                     : static_cast<size_t>(std::round(kHalfSmoothing_s / sample_s));
}

void HeadSway::take(const RecentCrowd& crowd) {
  if (half_ == 0) return;
  const Moment& moment = crowd.ago(half_);
  for (size_t i = 0; i < waves_.size(); ++i) {
    if (!crowd.stayed(i, half_, half_, half_)) {
      waves_[i] = {};
      continue;
    }
    Eigen::Vector2d path = Eigen::Vector2d::Zero(), before = path, after = path;
    double weights = 0;
    for (size_t k = 0; k <= 2 * half_; ++k) {
      const Eigen::Vector2d& head = crowd.ago(k).heads_m[i];
      const double weight = static_cast<double>(std::min(k, 2 * half_ - k) + 1);
      path += weight * head;
      weights += weight;
      if (k < half_) after += head;
      if (k > half_) before += head;
    }
    const Eigen::Vector2d step_m = (after - before) / static_cast<double>(half_);
    const double speed_mps = step_m.norm() / (static_cast<double>(half_ + 1) * sample_s_);
    if (speed_mps < kMinWalking_mps) {
      waves_[i] = {};
      continue;
    }
    const Eigen::Vector2d off = moment.heads_m[i] - path / weights;
    follow(i, (step_m.x() * off.y() - step_m.y() * off.x()) / step_m.norm(), speed_mps,
           moment.time_s);
  }
}

void HeadSway::follow(size_t person, double across_m, double speed_mps, double time_s) {
  Wave& wave = waves_[person];
  ++wave.followed;
  wave.level_m += std::max(1.0 / wave.followed, sample_s_ / kLevel_s) * (across_m - wave.level_m);
  const double off_m = across_m - wave.level_m;
  if (wave.moments > 0 && (wave.last_m < 0) != (off_m < 0)) {
    const double share = wave.last_m / (wave.last_m - off_m);
    const double crossing_s = time_s - (1 - share) * sample_s_;
    if (wave.has_crossed) finish_half_wave(person, wave, crossing_s);
    wave.has_crossed = wave.followed * sample_s_ >= kSettling_s;
    wave.since_s = crossing_s;
    wave.extreme_m = 0;
    wave.speed_mps = 0;
    wave.moments = 0;
  }
  wave.last_m = off_m;
  wave.extreme_m = std::max(wave.extreme_m, std::abs(off_m));
  wave.speed_mps += speed_mps;
  ++wave.moments;
}

void HeadSway::finish_half_wave(size_t person, const Wave& wave, double crossing_s) {
  const double length_s = crossing_s - wave.since_s;
  if (wave.extreme_m < kMinAmplitude_m || length_s < kMinWave_s || length_s > kMaxWave_s) return;
  people_[person].amplitude_m += wave.extreme_m;
  ++people_[person].half_waves;
  const double speed_mps = wave.speed_mps / wave.moments;
  for (size_t i = 0; i < paces_.size(); ++i) {
    if (speed_mps < kSpeeds_mps[i] || speed_mps >= kSpeeds_mps[i + 1]) continue;
    paces_[i].half_waves += 1;
    paces_[i].time_s += length_s;
  }
}

MeasureTable HeadSway::table() const {
  MeasureTable table{
      "sway",
      "Head sway",
      "speed",
      "m/s",
      "Deviation of the head from its path smoothed over 2 s, of people who walk (0.3 m/s "
      "or more). Amplitude: mean over a person's half waves. Frequency: strides per "
      "second.",
      {},
      {}};
  Histogram amplitudes(0, 0.0005, 400);
  for (const PersonSway& person : people_)
    if (person.half_waves >= kMinHalfWaves) amplitudes.add(person.amplitude_m / person.half_waves);
  if (amplitudes.count() == 0) return table;
  const auto amplitude = [&](const std::string& what, double value) {
    table.rows.push_back({"amplitude", {}, {}, "", what, "m", value});
  };
  amplitude("mean", amplitudes.mean());
  amplitude("10 %", amplitudes.quantile(0.1));
  amplitude("90 %", amplitudes.quantile(0.9));
  for (size_t i = 0; i < paces_.size(); ++i)
    if (paces_[i].half_waves >= 2 * kMinHalfWaves)
      table.rows.push_back(ranged_row(kSpeeds_mps[i], kSpeeds_mps[i + 1], "", "frequency", "Hz",
                                      paces_[i].half_waves / (2 * paces_[i].time_s)));
  return table;
}

namespace {

constexpr double kCell_m = 0.05;
constexpr double kMaxCells = 4e6;

}  // namespace

WidthUse::WidthUse(const Scene& scene)
    : ground_(scene.ground),
      cell_m_(std::max(kCell_m, std::sqrt(ground_.area_m2() / kMaxCells))),
      columns_(static_cast<int>(ground_.size_m().x() / cell_m_) + 1),
      rows_(static_cast<int>(ground_.size_m().y() / cell_m_) + 1),
      visits_(static_cast<size_t>(columns_) * static_cast<size_t>(rows_), 0) {
  for (const Polygon& polygon : walkable_area(scene))
    outline_.insert(outline_.end(), polygon.outline.begin(), polygon.outline.end());
}

void WidthUse::take(const Moment& moment, const Velocities& velocities) {
  for (size_t i = 0; i < moment.present.size(); ++i) {
    if (moment.present[i] == 0 || velocities.known[i] == 0) continue;
    const Eigen::Vector2d& v = velocities.of_mps[i];
    spread_ += v * v.transpose();
    sum_ += v;
    const Eigen::Vector2d offset = (moment.heads_m[i] - ground_.min_m) / cell_m_;
    const double column = std::clamp(std::floor(offset.x()), 0.0, columns_ - 1.0);
    const double row = std::clamp(std::floor(offset.y()), 0.0, rows_ - 1.0);
    ++visits_[static_cast<size_t>(row) * static_cast<size_t>(columns_) +
              static_cast<size_t>(column)];
  }
}

Eigen::Vector2d WidthUse::main_direction() const {
  const SinCos along = sin_cos(0.5 * arc_tan2(2 * spread_(0, 1), spread_(0, 0) - spread_(1, 1)));
  const Eigen::Vector2d axis(along.cos, along.sin);
  return axis.dot(sum_) < 0 ? Eigen::Vector2d(-axis) : axis;
}

MeasureTable WidthUse::table() const {
  const Eigen::Vector2d ahead = main_direction();
  const Eigen::Vector2d left(-ahead.y(), ahead.x());
  MeasureTable table{"width_use",
                     "Use of the width",
                     "width",
                     "m from the right edge",
                     "Share of the time of all people in lanes of 0.5 m across the main walking "
                     "direction, from the right edge of the walkable area.",
                     {},
                     {}};
  if (outline_.empty()) return table;
  double right = left.dot(outline_.front());
  for (const Eigen::Vector2d& corner : outline_) right = std::min(right, left.dot(corner));
  std::map<int, uint64_t> lanes;
  uint64_t all = 0;
  for (int row = 0; row < rows_; ++row)
    for (int column = 0; column < columns_; ++column) {
      const uint32_t visits = visits_[static_cast<size_t>(row) * static_cast<size_t>(columns_) +
                                      static_cast<size_t>(column)];
      if (visits == 0) continue;
      const Eigen::Vector2d place =
          ground_.min_m + cell_m_ * Eigen::Vector2d(column + 0.5, row + 0.5);
      lanes[static_cast<int>(std::floor((left.dot(place) - right) / kLane_m))] += visits;
      all += visits;
    }
  if (all == 0) return table;
  for (int lane = lanes.begin()->first; lane <= lanes.rbegin()->first; ++lane) {
    const auto found = lanes.find(lane);
    const double share =
        found == lanes.end() ? 0 : static_cast<double>(found->second) / static_cast<double>(all);
    table.rows.push_back(
        ranged_row(lane * kLane_m, (lane + 1) * kLane_m, "", "share", "%", 100 * share));
  }
  return table;
}

}  // namespace throng
