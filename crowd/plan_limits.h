// How large a scene may be.
// One rule: each limit is what some array or grid was built for, and says which.
#pragma once

#include <cstdint>

#include "culling/pair.h"

namespace throng {

/// People and obstacles together: their ids stay below PairKey::kMaxId.
inline constexpr int64_t kMaxBodies = PairKey::kMaxId;
/// Every obstacle is a body type of its own, and types are 16 bits; the rest is for models.
inline constexpr int64_t kMaxObstacles = 60'000;
/// Everybody who walks near one looks at each.
inline constexpr int64_t kMaxDoors = 1000;
/// A million cells of flow field are then 3 m wide, the coarsest that keep clear of walls.
inline constexpr double kMaxGround_m2 = 1e7;
/// Radii of steering discs. Walls are looked up 2.5 m around a centre (Walkable::kReach_m): the
/// widest disc sees them half a metre before it touches them.
inline constexpr double kMinRadius_m = 0.05;
inline constexpr double kMaxRadius_m = 2.0;
/// Heights that a scene may ask for: of people as far as the gait's curves hold, of robots from a
/// toy to a crane.
inline constexpr double kMinPerson_m = 0.5;
inline constexpr double kMaxPerson_m = 2.5;
inline constexpr double kMinRobot_m = 0.01;
inline constexpr double kMaxRobot_m = 100;

}  // namespace throng
