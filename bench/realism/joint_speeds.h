// How fast joints move and how hard they speed up, from the posture rows of one frame to the next;
// and how fast those who stand turn.
// One rule: differences of frames, nothing smoothed; who has just come in or has jumped counts from
// the next frame on.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "analysis/measures/histogram.h"
#include "scenes/run/sink.h"

namespace throng::realism {

/// What moves together: legs carry the body and follow from where feet are put, the upper body is
/// free to do something else.
enum class BodyHalf : uint8_t { kLegs, kUpper };
inline constexpr size_t kBodyHalves = 2;

/// What a joint keeps below; degrees, or metres of prismatic ones.
struct JointLimit {
  const char* joint;  ///< without its side
  BodyHalf half;
  double speed_per_s;
  double acceleration_per_s2;
};

/// Of all joints of the bundled adult; joint_limits.cpp says where they come from.
const std::vector<JointLimit>& joint_limits();
/// Null: a joint of another model.
const JointLimit* limit_of(const std::string& joint);

/// Of joints of one name, left and right together.
struct JointMotion {
  JointMotion(bool is_prismatic_in);

  bool is_prismatic;
  Histogram speeds, accelerations;  ///< degrees or metres, a second and squared
  uint64_t over_speed = 0;          ///< above the limit
  uint64_t over_acceleration = 0;
};

class JointSpeeds final : public Sink {
 public:
  /// Slower, somebody stands.
  static constexpr double kStanding_mps = 0.2;
  /// Faster is no way but a jump.
  static constexpr double kJump_mps = 12;

  JointSpeeds();

  SinkNeeds needs() const override { return {.postures = true}; }
  void begin(const RunInfo& run) override;
  void frame(const RunInfo& run, const Frame& frame) override;
  void end(const RunInfo&, const RunEnd&) override {}

  /// By name, without "left_" and "right_".
  const std::map<std::string, JointMotion>& joints() const { return joints_; }
  /// Frames of people of which speeds are known, and in how many of these any joint of a half was
  /// above its limit.
  uint64_t frames() const { return frames_; }
  uint64_t frames_over_speed(BodyHalf half) const { return over_speed_[index(half)]; }
  uint64_t frames_over_acceleration(BodyHalf half) const { return over_acceleration_[index(half)]; }
  /// Degrees a second by which roots turn, of those who stand and of all.
  const Histogram& standing_turns() const { return standing_turns_; }
  const Histogram& turns() const { return turns_; }

 private:
  struct Column {
    JointMotion* motion;
    double unit;  ///< degrees a radian, or 1
    size_t half;
    double most_speed, most_acceleration;
  };
  static size_t index(BodyHalf half) { return static_cast<size_t>(half); }
  void take(const RunInfo& run, const Frame& frame, size_t id);

  std::map<std::string, JointMotion> joints_;
  std::vector<std::vector<Column>> columns_;  ///< by model; empty: nobody
  std::vector<float> before_, earlier_;       ///< rows of the last two frames
  std::vector<RootPose> roots_before_;
  std::vector<uint8_t> known_;  ///< by avatar: how many frames before are, at most 2
  uint64_t frames_ = 0;
  std::array<uint64_t, kBodyHalves> over_speed_{}, over_acceleration_{};
  Histogram standing_turns_, turns_;
};

}  // namespace throng::realism
