// Grounds of experiments: rooms and corridors cut out of a block, and ways that close in an oval.
// One rule: every edge of the walkable ground is an obstacle, so that cells of people are cut there
// as in a recording; nobody ever meets the edge of the scene's ground.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/validation/plan.h"
#include "analysis/validation/trial.h"

namespace throng::validation {

/// Open are the rectangles (which may overlap or share edges); all around them is wall.
Plan carved(const std::string& name, const std::vector<Rectangle>& open,
            const SteeringRule& steering, uint64_t seed);

/// A way of one width round two straights along x and two half circles about (+-straight_m / 2, 0).
struct Oval {
  double straight_m = 0;
  double inner_m = 1;  ///< radius of the inner wall
  double width_m = 1;

  double middle_m() const { return inner_m + 0.5 * width_m; }
  double outer_m() const { return inner_m + width_m; }
  /// Of the middle line.
  double length_m() const;
  /// Counter-clockwise along the middle line from the farthest point along x, and outwards from it.
  Eigen::Vector2d at(double along_m, double aside_m) const;
  /// The reverse: in [0, length_m()), and how far outside the middle line.
  double along_m(const Eigen::Vector2d& point) const;
  double aside_m(const Eigen::Vector2d& point) const;

  Plan plan(const std::string& name, const SteeringRule& steering, uint64_t seed) const;

  /// Places people all over the way, evenly, and sends them round and round by goals in turn: every
  /// quarter one, across the way. Each is a group of one. Everybody is 1.70 m tall, so that a place
  /// fits. Of two-way people every second walks clockwise.
  void populate(Plan& plan, int people, const std::optional<Distribution>& speed_mps,
                bool two_way) const;

  /// How many are off the way: in a wall.
  int strays(const Trial& trial) const;

 private:
  std::vector<Goal> goals(bool clockwise) const;
  std::vector<Eigen::Vector2d> places(int people) const;
};

/// Normal, cut off at 2.5 standard deviations.
Distribution normal(double mean, double deviation);

}  // namespace throng::validation
