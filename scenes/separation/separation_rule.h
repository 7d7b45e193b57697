// How far a robot has to be from people: what a scene says of it.
// One rule: parameters of a study; no table of any standard stands here.
#pragma once

#include <optional>
#include <string>

namespace throng {

/// Of speed and separation monitoring, see scenes/separation/protective_distance.h.
struct SeparationRule {
  std::optional<double> human_mps;  ///< towards the robot; none: as measured
  std::optional<double> robot_mps;  ///< towards the person; none: as measured
  double reaction_s = 0;            ///< until the robot begins to stop
  /// From then until it stands: so long, or by so much; the scene says one of the two.
  std::optional<double> stopping_s, deceleration_mps2;
  double intrusion_m = 0;    ///< C: what is reached in before it is seen
  double human_error_m = 0;  ///< Z_d: of where the person is
  double robot_error_m = 0;  ///< Z_r: of where the robot is
  std::string where{};       ///< in the file, for complaints

  /// Speeds are known where the triangles were asked.
  bool is_measured() const { return !human_mps || !robot_mps; }
};

}  // namespace throng
