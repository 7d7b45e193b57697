// Boxes around parts as posed, eight at a time. Internal to the folder.
// One rule: every SIMD target gives the same bits.
#pragma once

#include <cstddef>
#include <span>

#include "avatars/yielding/upper_room.h"

namespace throng {

inline constexpr size_t kShapesAtOnce = 8;

/// The box around all; false: `all` does not hold it.
bool find_upper_box(const UpperRoom::Shapes& shapes, std::span<const PartPose> poses,
                    const RoundRoom& all, SimdTarget target, RootBox& box);

bool find_upper_box_one_by_one(const UpperRoom::Shapes& shapes, std::span<const PartPose> poses,
                               const RoundRoom& all, RootBox& box);

}  // namespace throng
