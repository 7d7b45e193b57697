// Where the parts of an avatar are in a frame, for sinks and whatever else reads frames.
// One rule: poses are relative to the avatar's root position, so that floats hold them anywhere.
#pragma once

#include <cstddef>
#include <span>

#include "kinematics/kinematics.h"
#include "scenes/run/sink.h"

namespace throng {

/// Of a frame with postures (SinkNeeds::postures); `out` has room for the parts of the avatar's
/// model.
void part_poses(const RunInfo& run, const Frame& frame, size_t avatar, std::span<PartPose> out);

}  // namespace throng
