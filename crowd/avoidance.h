// Avoidance chooses the velocities of those who decide: it limits what they prefer by gaps or by
// density, shows the walls around to the steering model, and takes the model's choice.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "crowd/navigation/walkable.h"
#include "crowd/steering/steering.h"
#include "crowd/steering_state.h"

namespace throng {
namespace tuning {

/// How far ahead collisions with people are avoided. Longer makes crowds timid, shorter makes them
/// bump.
inline constexpr double kHorizon_s = 2.0;
/// The horizon of somebody stuck: one who looks less far ahead takes gaps that others leave.
inline constexpr double kStuckHorizon_s = 0.5;
/// How far ahead walls slow a person down: at 0.5 s one can walk along a wall at arm's length.
inline constexpr double kWallHorizon_s = 0.5;
/// People of the same way keep a gap of so long: a door of 1 m then lets through 1.3 people a
/// second (Weidmann 1993: 1.2). Halved, a second door after it jams; doubled, doors carry too
/// little.
inline constexpr double kTimeGap_s = 0.2;
/// Ways count as the same up to 60 degrees, and as opposite from 120 on: the cosine.
inline constexpr double kSameDirection = 0.5;

}  // namespace tuning

class Avoidance {
 public:
  /// Keeps references to all. By density, the speed that people prefer is limited by how many are
  /// ahead; otherwise by the gap, unless the model itself keeps one.
  Avoidance(SteeringState& state, const SteeringModel& model, const Walkable& walkable,
            bool by_density);

  /// Decides how fast an agent may be and how far ahead it avoids others, before any chooses.
  void prepare(size_t slot);

  /// Chooses the next velocities of those who decide now, all of whom have a preferred one, and
  /// from these where they will be after a period. Allocates nothing.
  void choose();

 private:
  /// The walls of one block, one a worker.
  struct Walls {
    std::vector<float> x, y, clearance_m;
    std::vector<uint32_t> starts;
  };

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
  bool limits_;  ///< density keeps people apart, and so do models that keep a gap
  std::vector<Walls> walls_;
};

}  // namespace throng
