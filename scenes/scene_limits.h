// How large a scene may be.
// One rule: each limit is what some array or grid was built for, and says which.
#pragma once

#include <cstdint>

#include "culling/pair_events.h"

namespace throng {

/// People and obstacles together: their ids stay below PairKey::kMaxId.
inline constexpr int64_t kMaxBodies = PairKey::kMaxId;
/// Every obstacle is a body type of its own, and types are 16 bits; the rest is for models.
inline constexpr int64_t kMaxObstacles = 60'000;
/// A million cells of flow field are then 3 m wide, the coarsest that keep clear of walls.
inline constexpr double kMaxGround_m2 = 1e7;

}  // namespace throng
