// setups builds the grounds of experiments: rooms and corridors cut out of a block, and ovals.
// Invariant: every edge of the walkable ground is an obstacle, which cuts Voronoi cells as in a
// recording.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/validation/plan.h"
#include "analysis/validation/trial.h"

namespace throng::validation {

/// Opens the rectangles, which may overlap or share edges; everything around them is wall.
Plan carved(const std::string& name, const std::vector<Rectangle>& open,
            const SteeringRule& steering, uint64_t seed);

/// A closed corridor: straights along x and half circles about (+-straight_m / 2, 0).
struct Oval {
  double straight_m = 0;
  double inner_m = 1;  ///< radius of the inner wall
  double width_m = 1;

  double middle_m() const { return inner_m + 0.5 * width_m; }
  double outer_m() const { return inner_m + width_m; }
  /// Length of the centre line.
  double length_m() const;
  /// Position at `along_m`, counter-clockwise on the centre line from its farthest point along +x,
  /// and `aside_m` outwards.
  Eigen::Vector2d at(double along_m, double aside_m) const;
  /// The inverse: in [0, length_m()), and outwards from the centre line.
  double along_m(const Eigen::Vector2d& point) const;
  double aside_m(const Eigen::Vector2d& point) const;

  Plan plan(const std::string& name, const SteeringRule& steering, uint64_t seed) const;

  /// Distributes people evenly over the oval and sends them round by four goals in turn. Each is a
  /// group of one with a height of 1.70 m, to fit the spacing. `two_way`: every second one walks
  /// clockwise.
  void populate(Plan& plan, int people, const std::optional<Distribution>& speed_mps,
                bool two_way) const;

  /// Number of people outside of the corridor, in a wall.
  int strays(const Trial& trial) const;

 private:
  std::vector<Goal> goals(bool clockwise) const;
  std::vector<Eigen::Vector2d> places(int people) const;
};

/// Normal distribution, truncated at 2.5 standard deviations.
Distribution normal(double mean, double deviation);

}  // namespace throng::validation
