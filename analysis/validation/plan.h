// Scenes of the standard tests: rooms of straight walls, groups with a way to an exit.
// One rule: every wall is an axis-aligned rectangle, so that a few lines can tell, without the code
// that steers, whether somebody went through one.
#pragma once

#include <string>
#include <vector>

#include "scenes/file/scene.h"

namespace throng::validation {

struct Plan {
  Plan(const std::string& name, const Rectangle& ground, const SteeringRule& steering,
       uint64_t seed);

  void wall(double min_x, double min_y, double max_x, double max_y);
  /// A wall of 0.2 m along x or y from one point to the other with a gap in it: a door. The gap is
  /// `door_m` wide around `middle`, a coordinate along the wall.
  void wall_along_x(double from_x, double to_x, double y, std::vector<double> middles,
                    double door_m);
  void wall_along_y(double from_y, double to_y, double x, std::vector<double> middles,
                    double door_m);

  /// A wall of another shape, which Trial does not check moves against.
  void solid(Obstacle obstacle);

  /// People who walk from an area to the nearest of others and leave there.
  Group& people(int count, const Rectangle& from, const std::vector<Rectangle>& to);

  /// The same with room for all of them with every seed: as close as it takes, no body in another.
  Group& people_packed(int count, const Rectangle& from, const std::vector<Rectangle>& to);

  /// The same with everybody in a place of one's own, rows along x shifted by half a place: more
  /// people than chance finds room for. `rows` times `columns` of them, each a group.
  void people_in_rows(int rows, int columns, const Rectangle& from,
                      const std::vector<Rectangle>& to);

  static constexpr double kWall_m = 0.2;

  Scene scene;
  std::vector<Rectangle> walls;
};

/// The same for everybody.
Distribution fixed(double value);

}  // namespace throng::validation
