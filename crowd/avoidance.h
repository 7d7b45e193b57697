// Avoidance chooses the velocities of the agents that decide in this step. It limits preferred
// speeds by gap or density, passes nearby walls to the steering model and stores its choice.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "crowd/navigation/walkable.h"
#include "crowd/steering/steering.h"
#include "crowd/steering_state.h"

namespace throng {
namespace tuning {

/// Look-ahead for collisions with agents. Longer makes crowds timid, shorter lets agents bump.
inline constexpr double kHorizon_s = 2.0;
/// Look-ahead of a stuck agent: shorter, because it then takes gaps that others leave.
inline constexpr double kStuckHorizon_s = 0.5;
/// Look-ahead for walls: at 0.5 s agents can walk along a wall at arm's length.
inline constexpr double kWallHorizon_s = 0.5;
/// Time gap between agents of the same direction. A door of 1 m then passes 1.3 people per second
/// (Weidmann 1993: 1.2). Half of it jams at a second door; double makes door flow too low.
inline constexpr double kTimeGap_s = 0.2;
/// Cosine of the angle up to which directions are the same (60 degrees); opposite from 120 degrees.
inline constexpr double kSameDirection = 0.5;

}  // namespace tuning

class Avoidance {
 public:
  /// Keeps references to all arguments. `by_density`: the density ahead limits preferred speeds.
  /// Otherwise the time gap does, unless the model itself keeps one.
  Avoidance(SteeringState& state, const SteeringModel& model, const Walkable& walkable,
            bool by_density);

  /// Sets the maximum speed and the look-ahead of an agent. To be called before any agent chooses.
  void prepare(size_t slot);

  /// Chooses the next velocities of all agents that decide, and from these their places after one
  /// period. Requires their preferred velocities. Allocates nothing.
  void choose();

 private:
  /// Nearest point of a piece of a surface.
  struct SurfacePoint {
    double distance_m;
    uint32_t footprint, surface;
    Eigen::Vector2d normal, point_m;
  };
  /// Walls near one block of agents; one per worker.
  struct Walls {
    std::vector<float> x, y, clearance_m;
    std::vector<uint32_t> starts;
    std::vector<SurfacePoint> pieces;  ///< near the current agent
  };

  static void keep_foremost(std::vector<SurfacePoint>& pieces);
  void limit(SteeringState::Slots slots, Walls& walls);
  void limit_to_gap(size_t slot);
  void limit_to_density(const SteeringView& people, size_t i, uint32_t slot);
  void choose(SteeringState::Slots slots, Walls& walls);
  void limit_forward(size_t slot);
  bool stands_in_standing_crowd(size_t slot) const;
  SteeringView view_with_walls(SteeringState::Slots slots, Walls& walls);
  void find_walls(size_t slot, Walls& walls);

  SteeringState& state_;
  Decisions& decisions_;
  const SteeringModel& model_;
  const Walkable& walkable_;
  bool by_density_;
  bool limits_;  ///< whether the density or the gap limits speeds
  std::vector<Walls> walls_;
};

}  // namespace throng
