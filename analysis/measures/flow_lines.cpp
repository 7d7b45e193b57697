#include "analysis/measures/flow_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace throng {
namespace {

/// Nobody walks through less.
constexpr double kNarrowest_m = 0.3;
constexpr size_t kMostGaps = 24;
/// Between the middles of two gaps that are watched.
constexpr double kApart_m = 1.5;
constexpr double kStep_m = 0.2;
constexpr double kMostPoints = 40'000;
/// Heads sway beyond the ends of a line.
constexpr double kBeyond_m = 0.1;
/// Somebody who passed it can pass it again only after having been this far from it: standing and
/// swaying on a line is no flow.
constexpr double kLeft_m = 0.5;

/// A line that fewer than one in so many of the busiest's people pass is not the crowd's way.
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

/// Middles of cells side by side from one end to the other.
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
  const double step_m = std::max(kStep_m, std::sqrt(ground.area_m2() / kMostPoints));
  std::vector<Gap> gaps;
  const std::vector<double> xs = middles_m(ground.min_m.x(), ground.max_m.x(), step_m);
  for (const double y : middles_m(ground.min_m.y(), ground.max_m.y(), step_m))
    for (const double x : xs) {
      const Eigen::Vector2d point(x, y);
      if (walkable.clearance_m(point) <= 0) continue;
      const Gap gap = walkable.gap_at(point, Walkable::kReach_m);
      if (gap.width_m >= kNarrowest_m && std::isfinite(gap.width_m)) gaps.push_back(gap);
    }
  std::stable_sort(gaps.begin(), gaps.end(),
                   [](const Gap& a, const Gap& b) { return a.width_m < b.width_m; });
  std::vector<FlowLines::Line> lines;
  std::vector<Eigen::Vector2d> middles;
  for (const Gap& gap : gaps) {
    if (lines.size() == kMostGaps) break;
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

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

}  // namespace

double FlowLines::Line::flow_per_s() const {
  return passed() < 2 || last_s <= first_s ? 0
                                           : static_cast<double>(passed() - 1) / (last_s - first_s);
}

uint64_t FlowLines::Line::beside() const {
  return static_cast<uint64_t>(std::count(went_by.begin(), went_by.end(), 1));
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
    line.is_near.assign(people, 0);
    line.went_by.assign(people, 0);
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
        line.is_near[i] = 0;
        continue;
      }
      const Eigen::Vector2d to = now.heads_m[i] - line.across.from_m;
      const Eigen::Vector2d from = before.heads_m[i] - line.across.from_m;
      const double side_to = cross(along, to);
      const double side_from = cross(along, from);
      if (std::abs(side_to) > kLeft_m) line.is_near[i] = 0;
      if ((side_from < 0) == (side_to < 0)) continue;
      const double share = side_from / (side_from - side_to);
      const double place = along.dot(from + share * (to - from));
      const bool is_beside = place < -kBeyond_m || place > length + kBeyond_m;
      if (is_beside) line.went_by[i] = 1;
      if (is_beside || line.is_near[i] != 0) continue;
      line.is_near[i] = std::abs(side_to) <= kLeft_m;
      const double time_s = before.time_s + share * (now.time_s - before.time_s);
      line.first_s = line.passed() == 0 ? time_s : std::min(line.first_s, time_s);
      line.last_s = std::max(line.last_s, time_s);
      ++(side_to > 0 ? line.forth : line.back);
    }
  }
}

const FlowLines::Line& FlowLines::used() const {
  uint64_t busiest = 0;
  for (const Line& line : lines_) busiest = std::max(busiest, line.passed());
  const auto is_used = [&](const Line& line) { return kUsedShare * line.passed() >= busiest; };
  auto best = std::find_if(lines_.begin(), lines_.end(), is_used);  // the busiest is
  for (auto line = best; line != lines_.end(); ++line) {
    if (!is_used(*line)) continue;
    const double narrower_m = best->width_m - line->width_m;
    // Of places as wide the busier one.
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
          "From ({:.2f}, {:.2f}) to ({:.2f}, {:.2f}) m, {:.2f} m of it wide. "
          "People: passes, both ways. Flow: one less over the time from the "
          "first to the last.{}",
          at.from_m.x(), at.from_m.y(), at.to_m.x(), at.to_m.y(), line.width_m,
          is_chosen_ ? " People beside it: those who cross its straight beyond its ends." : ""),
      {},
      {}};
  const auto row = [&](const std::string& what, const std::string& unit, double value) {
    table.rows.push_back({"the line", line.width_m, {}, "", what, unit, value});
  };
  row("width", "m", line.width_m);
  row("people", "", static_cast<double>(line.passed()));
  row("of them back", "", static_cast<double>(std::min(line.forth, line.back)));
  if (is_chosen_) row("people beside it", "", static_cast<double>(line.beside()));
  row("flow", "1/s", line.flow_per_s());
  row("flow a metre", "1/(m s)", line.width_m > 0 ? line.flow_per_s() / line.width_m : 0);
  return table;
}

}  // namespace throng
