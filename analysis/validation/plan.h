// Plan builds scenes of the standard tests: rooms with straight walls, groups that walk to exits.
// Invariant: walls are axis-aligned rectangles, which Trial checks independently of steering.
#pragma once

#include <string>
#include <vector>

#include "scenes/file/scene.h"

namespace throng::validation {

struct Plan {
  Plan(const std::string& name, const Rectangle& ground, const SteeringRule& steering,
       uint64_t seed);

  void wall(double min_x, double min_y, double max_x, double max_y);
  /// Adds a wall of 0.2 m along x or y with doors. `middles`: coordinates of their centres along
  /// the wall; `door_m`: their width.
  void wall_along_x(double from_x, double to_x, double y, std::vector<double> middles,
                    double door_m);
  void wall_along_y(double from_y, double to_y, double x, std::vector<double> middles,
                    double door_m);

  /// Adds a wall of another shape, which Trial does not check.
  void solid(Obstacle obstacle);

  /// Adds people who walk from an area to the nearest of others and leave there.
  Group& people(int count, const Rectangle& from, const std::vector<Rectangle>& to);

  /// As people(), packed as closely as needed to place all of them with any seed, without overlap.
  Group& people_packed(int count, const Rectangle& from, const std::vector<Rectangle>& to);

  /// As people(), at fixed positions in rows along x that are shifted by half a spacing, denser
  /// than random placement allows. Adds `rows` times `columns` groups of one person.
  void people_in_rows(int rows, int columns, const Rectangle& from,
                      const std::vector<Rectangle>& to);

  static constexpr double kWall_m = 0.2;

  Scene scene;
  std::vector<Rectangle> walls;
};

/// Distribution with a single value.
Distribution fixed(double value);

}  // namespace throng::validation
