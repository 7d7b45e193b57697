// The stages of a frame and those of its culling, each in one order: by it go clocks, the summary,
// JSON and LCM. One rule: a new stage comes last, for listeners know the others by their place.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "culling/culler.h"

namespace throng {

/// Where a frame's time goes.
enum class Stage : uint8_t {
  kSteering,
  kGait,
  kKinematics,
  kBroadPhase,
  kMidPhase,
  kNarrowPhase,
  kEvents,
  kPublish,
  kBodyAvoidance
};
inline constexpr size_t kStageCount = 9;
inline constexpr std::array<std::string_view, kStageCount> kStageNames = {
    "steering", "gait",   "kinematics", "broad_phase", "mid_phase",
    "exact",    "events", "publish",    "yielding"};

/// Wall-clock times of one frame, nanoseconds.
struct FrameTimes {
  std::array<double, kStageCount> stage_ns{};
  double frame_ns = 0;
  int64_t culling_began_ns = 0;  ///< since 1970, of the system's clock; 0: nobody was culled

  double& operator[](Stage stage) { return stage_ns[static_cast<size_t>(stage)]; }
  double operator[](Stage stage) const { return stage_ns[static_cast<size_t>(stage)]; }
};

/// The stages that count updates and tests.
inline constexpr size_t kCullingStageCount = 5;
inline constexpr std::array<std::string_view, kCullingStageCount> kCullingStageNames = {
    "avatar", "body_box", "part_box", "part", "exact"};

/// Of CullingCounters, constant or not, in the order of their names.
template <class Counters>
auto culling_stages(Counters& c) {
  return std::array{&c.body_sphere, &c.body_box, &c.part_box, &c.part_volume, &c.triangles};
}

}  // namespace throng
