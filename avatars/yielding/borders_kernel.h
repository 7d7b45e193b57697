// A border after the other: the reference for borders_simd.cpp. Internal to the folder.
#pragma once

#include <span>

#include "avatars/yielding/yielding.h"

namespace throng {

YieldMotion wanted_one_by_one(const SeenBody& own, std::span<const SeenBody* const> near,
                              std::span<const NearWall> walls);

}  // namespace throng
