// Stage and FrameTimes name the stages of a frame and hold their times.
// Invariant: the order is that of clocks, summary, JSON and LCM; new stages come last, because
// listeners use the index.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "culling/culler.h"

namespace throng {

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
    "steering",     "gait",   "kinematics", "broad_phase",   "mid_phase",
    "narrow_phase", "events", "publish",    "body_avoidance"};

/// Wall-clock times of one frame, in nanoseconds.
struct FrameTimes {
  std::array<double, kStageCount> stage_ns{};
  double frame_ns = 0;
  int64_t culling_began_ns = 0;  ///< system clock since 1970; 0: no culling in this frame

  double& operator[](Stage stage) { return stage_ns[static_cast<size_t>(stage)]; }
  double operator[](Stage stage) const { return stage_ns[static_cast<size_t>(stage)]; }
};

inline constexpr size_t kCullingStageCount = 5;
inline constexpr std::array<std::string_view, kCullingStageCount> kCullingStageNames = {
    "body_sphere", "body_box", "part_box", "part_volume", "triangles"};

/// Counters of the culling stages in the order of their names; `c` may be constant.
template <class Counters>
auto culling_stages(Counters& c) {
  return std::array{&c.body_sphere, &c.body_box, &c.part_box, &c.part_volume, &c.triangles};
}

}  // namespace throng
