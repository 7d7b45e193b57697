#include "analysis/validation/setups.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "avatars/mesh/primitives.h"
#include "crowd/spawn.h"

namespace throng::validation {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kRim_m = 0.5;
constexpr double kHeight_m = 1.70;
constexpr double kWallHeight_m = 3;
/// Spawning keeps 2 cm between two discs of 0.22 m, and less than this from walls.
constexpr double kApart_m = 0.465;
constexpr double kClear_m = 0.03;
/// Corners of a cylinder's mesh are this factor farther out than its radius.
constexpr double kCorner = 1.009;

std::vector<double> edges(const std::vector<Rectangle>& open, const Rectangle& ground, int axis) {
  std::vector<double> out = {ground.min_m[axis], ground.max_m[axis]};
  for (const Rectangle& each : open) {
    out.push_back(each.min_m[axis]);
    out.push_back(each.max_m[axis]);
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

void wall_off(Plan& plan, const std::vector<Rectangle>& open) {
  const std::vector<double> x = edges(open, plan.scene.ground, 0);
  const std::vector<double> y = edges(open, plan.scene.ground, 1);
  const auto is_open = [&](size_t column, size_t row) {
    const Eigen::Vector2d middle(0.5 * (x[column] + x[column + 1]), 0.5 * (y[row] + y[row + 1]));
    return std::any_of(open.begin(), open.end(),
                       [&](const Rectangle& each) { return each.contains(middle); });
  };
  // Merges rows of cells with the same walls.
  using Runs = std::vector<std::pair<double, double>>;
  Runs before;
  double since_y = y.front();
  const auto close = [&](double until_y) {
    for (const auto& [from, to] : before) plan.wall(from, since_y, to, until_y);
    since_y = until_y;
  };
  for (size_t row = 0; row + 1 < y.size(); ++row) {
    Runs runs;
    for (size_t column = 0; column + 1 < x.size(); ++column) {
      if (is_open(column, row)) continue;
      if (!runs.empty() && runs.back().second == x[column])
        runs.back().second = x[column + 1];
      else
        runs.emplace_back(x[column], x[column + 1]);
    }
    if (runs != before) close(y[row]);
    before = std::move(runs);
  }
  close(y.back());
}

Obstacle pillar(const Eigen::Vector2d& at, double corner_m) {
  const double radius_m = corner_m / kCorner;
  Obstacle obstacle;
  obstacle.kind = Obstacle::Kind::kCylinder;
  obstacle.size_m = {2 * radius_m, 2 * radius_m, kWallHeight_m};
  obstacle.centre_m = {at.x(), at.y(), 0.5 * kWallHeight_m};
  obstacle.mesh = cylinder_mesh(radius_m, kWallHeight_m);
  return obstacle;
}

/// Box of a wall around a half circle, with its inner face touching the circle.
Obstacle segment(const Eigen::Vector2d& middle, double radius_m, double angle_rad,
                 double step_rad) {
  Obstacle obstacle;
  obstacle.size_m = {kRim_m, 2 * (radius_m + kRim_m) * std::tan(0.5 * step_rad), kWallHeight_m};
  const Eigen::Vector2d at = middle + (radius_m + 0.5 * kRim_m) *
                                          Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad));
  obstacle.centre_m = {at.x(), at.y(), 0.5 * kWallHeight_m};
  obstacle.heading_rad = angle_rad;
  obstacle.mesh = box_mesh(obstacle.size_m);
  return obstacle;
}

}  // namespace

Plan carved(const std::string& name, const std::vector<Rectangle>& open,
            const SteeringRule& steering, uint64_t seed) {
  Rectangle ground = open.front();
  for (const Rectangle& each : open) {
    ground.min_m = ground.min_m.cwiseMin(each.min_m);
    ground.max_m = ground.max_m.cwiseMax(each.max_m);
  }
  ground.min_m.array() -= kRim_m;
  ground.max_m.array() += kRim_m;
  Plan plan(name, ground, steering, seed);
  wall_off(plan, open);
  return plan;
}

double Oval::length_m() const { return 2 * straight_m + 2 * kPi * middle_m(); }

Eigen::Vector2d Oval::at(double along_m, double aside_m) const {
  const double radius = middle_m() + aside_m;
  const double quarter_m = 0.5 * kPi * middle_m();
  const double half_m = 2 * quarter_m + straight_m;
  const double along = std::fmod(along_m, length_m());
  const double sign = along < half_m ? 1 : -1;
  const double u = along < half_m ? along : along - half_m;
  const auto bend = [&](double middle_x, double angle_rad) -> Eigen::Vector2d {
    return sign *
           Eigen::Vector2d(middle_x + radius * std::cos(angle_rad), radius * std::sin(angle_rad));
  };
  if (u < quarter_m) return bend(0.5 * straight_m, u / middle_m());
  if (u < quarter_m + straight_m)
    return sign * Eigen::Vector2d(0.5 * straight_m - (u - quarter_m), radius);
  return bend(-0.5 * straight_m, (u - straight_m) / middle_m());
}

double Oval::along_m(const Eigen::Vector2d& point) const {
  const double quarter_m = 0.5 * kPi * middle_m();
  const double half_m = 2 * quarter_m + straight_m;
  const bool upper = point.y() >= 0;
  const Eigen::Vector2d p = upper ? point : Eigen::Vector2d(-point);
  const double half_x = 0.5 * straight_m;
  double u = 0;
  if (p.x() > half_x)
    u = middle_m() * std::atan2(p.y(), p.x() - half_x);
  else if (p.x() >= -half_x)
    u = quarter_m + half_x - p.x();
  else
    u = straight_m + middle_m() * std::atan2(p.y(), p.x() + half_x);
  return upper ? u : half_m + u;
}

double Oval::aside_m(const Eigen::Vector2d& point) const {
  const double beyond = std::max(0.0, std::abs(point.x()) - 0.5 * straight_m);
  return std::hypot(beyond, point.y()) - middle_m();
}

Plan Oval::plan(const std::string& name, const SteeringRule& steering, uint64_t seed) const {
  const Eigen::Vector2d corner(0.5 * straight_m + outer_m() + 2 * kRim_m, outer_m() + 2 * kRim_m);
  Plan plan(name, {-corner, corner}, steering, seed);
  const double half_x = 0.5 * straight_m;
  if (straight_m > 0) {
    plan.wall(-half_x, -inner_m, half_x, inner_m);
    plan.wall(-half_x, outer_m(), half_x, outer_m() + kRim_m);
    plan.wall(-half_x, -outer_m() - kRim_m, half_x, -outer_m());
  }
  constexpr int kSegments = 12;
  constexpr double kStep_rad = kPi / kSegments;
  for (const double side : {1.0, -1.0}) {
    const Eigen::Vector2d middle(side * half_x, 0);
    if (side > 0 || straight_m > 0) plan.solid(pillar(middle, inner_m));
    for (int i = 0; i < kSegments; ++i) {
      const double angle_rad = (i + 0.5) * kStep_rad - 0.5 * kPi + (side > 0 ? 0 : kPi);
      plan.solid(segment(middle, outer_m(), angle_rad, kStep_rad));
    }
  }
  return plan;
}

std::vector<Goal> Oval::goals(bool clockwise) const {
  // One strip across a bend, and one across the straight that is reached last.
  constexpr double kHalf_m = 0.25;
  const double half_x = 0.5 * straight_m;
  const double end_x = clockwise ? half_x : -half_x;
  const Rectangle right = {{half_x + inner_m, -kHalf_m}, {half_x + outer_m(), kHalf_m}};
  const Rectangle left = {{-half_x - outer_m(), -kHalf_m}, {-half_x - inner_m, kHalf_m}};
  const Rectangle top = {{end_x - kHalf_m, inner_m}, {end_x + kHalf_m, outer_m()}};
  const Rectangle bottom = {{-end_x - kHalf_m, -outer_m()}, {-end_x + kHalf_m, -inner_m}};
  std::vector<Goal> out = {Goal(right), Goal(top), Goal(left), Goal(bottom)};
  if (clockwise) std::reverse(out.begin() + 1, out.end());
  for (Goal& goal : out) goal.waypoint = true;
  return out;
}

/// Positions in as many rows as maximise the spacing. Rows too close for people abreast alternate;
/// other rows hold as many as fit their length.
std::vector<Eigen::Vector2d> Oval::places(int people) const {
  const double usable_m = width_m - 2 * disc_radius_m(kHeight_m) - kClear_m;
  const double inner_share = (middle_m() - 0.5 * usable_m) / middle_m();
  int rows = 1;
  double widest_m = length_m() / people;
  for (int tried = 2; tried == 2 || usable_m / (tried - 1) > kApart_m; ++tried) {
    const double aside_m = usable_m / (tried - 1);
    const double step_m = length_m() * tried / people;
    const double inner_step_m = inner_share * step_m;
    const double nearest_m = aside_m > kApart_m
                                 ? std::min(aside_m, step_m)
                                 : std::min(inner_step_m, std::hypot(aside_m, 0.5 * inner_step_m));
    if (nearest_m <= widest_m) continue;
    widest_m = nearest_m;
    rows = tried;
  }
  std::vector<Eigen::Vector2d> out;
  if (rows > 1 && usable_m / (rows - 1) <= kApart_m) {
    for (int i = 0; i < people; ++i)
      out.push_back(at(i * length_m() / people, (i % 2 - 0.5) * usable_m));
    return out;
  }
  for (int row = 0; row < rows; ++row) {
    const double aside = rows > 1 ? usable_m * (static_cast<double>(row) / (rows - 1) - 0.5) : 0;
    const Oval line = {straight_m, middle_m() + aside, 0};
    // Rows are symmetric about the centre line, so their mean length equals its length.
    const double share = line.length_m() / (rows * length_m());
    const int left = people - static_cast<int>(out.size());
    const int count = row + 1 == rows ? left : static_cast<int>(std::lround(share * people));
    for (int i = 0; i < count; ++i)
      out.push_back(line.at((i + 0.5 * (row % 2)) * line.length_m() / count, 0));
  }
  return out;
}

void Oval::populate(Plan& plan, int people, const std::optional<Distribution>& speed_mps,
                    bool two_way) const {
  const Eigen::Vector2d slack = Eigen::Vector2d::Constant(1e-4);
  const double length = length_m();
  const auto whole = static_cast<size_t>(people);
  const std::vector<Eigen::Vector2d> all = places(people);
  for (size_t i = 0; i < whole; ++i) {
    const bool clockwise = two_way && i % 2 == 1;
    std::vector<Goal> route = goals(clockwise);
    // The goal that is next along the path, by at least 1 m.
    const auto ahead_m = [&](const Goal& goal) {
      const double along = along_m(goal.areas.front().middle_m()) - along_m(all[i]);
      return std::fmod((clockwise ? -along : along) - 1 + 2 * length, length);
    };
    const auto first =
        std::min_element(route.begin(), route.end(),
                         [&](const Goal& a, const Goal& b) { return ahead_m(a) < ahead_m(b); });
    std::rotate(route.begin(), first, route.end());
    Group& one = plan.people(1, {all[i] - slack, all[i] + slack}, {});
    one.goals = route;
    one.on_arrival = OnArrival::kLoop;
    one.height_m = fixed(kHeight_m);
    one.speed_mps = speed_mps;
  }
}

int Oval::strays(const Trial& trial) const {
  int count = 0;
  for (size_t id = 0; id < trial.size(); ++id) {
    const double radius = aside_m(trial.position_m(id)) + middle_m();
    count += trial.is_present(id) && (radius < inner_m / kCorner || radius > kCorner * outer_m());
  }
  return count;
}

Distribution normal(double mean, double deviation) {
  return {mean, deviation, mean - 2.5 * deviation, mean + 2.5 * deviation};
}

}  // namespace throng::validation
