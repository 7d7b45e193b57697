// How joints move: their speeds, the swing of the arms, and the tables of `realism joints`.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "analysis/contacts/local_density.h"
#include "analysis/measures/measure_table.h"
#include "avatars/gait/gait.h"
#include "scenes/run/postures.h"
#include "scenes/run/simulation.h"
#include "scenes/run/sink.h"

namespace throng::realism {

// How fast joints move and how hard they speed up, from the posture rows of one frame to the next;
// and how fast those who stand turn.
// Differences of frames, nothing smoothed; who has just come in or has jumped counts from
// the next frame on.

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

/// Of all joints of the bundled adult; its definition says where they come from.
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
    double max_speed, max_acceleration;
  };
  static size_t index(BodyHalf half) { return static_cast<size_t>(half); }
  void take(const RunInfo& run, const Frame& frame, size_t id);

  std::map<std::string, JointMotion> joints_;
  std::vector<std::vector<Column>> columns_;  ///< by model; empty: nobody
  std::vector<float> before_, earlier_;       ///< rows of the last two frames
  std::vector<RootPose> roots_before_;
  std::vector<uint8_t> history_frames_;  ///< by avatar: how many frames before are, at most 2
  uint64_t frames_ = 0;
  std::array<uint64_t, kBodyHalves> over_speed_{}, over_acceleration_{};
  Histogram standing_turns_, turns_;
};

/// How far arms swing, of what the style of walking has them swing at that speed, by density.
/// Each whole cycle of each shoulder counts by its time, beside the gait's own posture in
/// the same frames.
struct SwingSums {
  double time_s = 0;  ///< of cycles, of persons
  double swing_rad_s = 0;
  double reference_rad_s = 0;  ///< the style's

  double mean_deg() const;
  double share() const { return swing_rad_s / reference_rad_s; }
};

class ArmSwing final : public Sink {
 public:
  /// People per m2 within 2 m.
  static constexpr std::array<double, 5> kBounds_per_m2 = {0.5, 1, 2, 3.57, 5};
  static constexpr size_t kLevels = kBounds_per_m2.size() + 1;
  /// Slower, or slower at any time of a cycle, nobody is said to walk.
  static constexpr float kWalking_mps = 0.3f;

  /// The simulation whose frames come; it knows phases and styles.
  explicit ArmSwing(const Simulation& simulation);

  SinkNeeds needs() const override { return {.postures = true}; }
  void begin(const RunInfo& run) override;
  void frame(const RunInfo& run, const Frame& frame) override;
  void end(const RunInfo&, const RunEnd&) override {}

  const std::array<SwingSums, kLevels>& levels() const { return levels_; }

 private:
  struct Range {
    float min = 0, max = 0;
    void begin(float value) { min = max = value; }
    void add(float value);
    double width() const { return static_cast<double>(max - min); }
  };
  /// Of somebody, since the phase was 0 last.
  struct Cycle {
    bool is_whole = false;  ///< began at phase 0, and walked since
    int frames = 0;
    float last_phase = -1;  ///< below 0: was not there
    std::array<Range, 2> swing, reference;
  };
  struct Kind {
    std::array<int, 2> shoulders{-1, -1};  ///< columns, right and left
    size_t columns = 0;
    std::vector<std::unique_ptr<Gait>> gaits;  ///< by style; of others, null
  };

  void finish(const RunInfo& run, const Frame& frame, size_t id);

  const Simulation& simulation_;
  std::vector<Kind> kinds_;  ///< by model
  std::vector<Cycle> cycles_;
  std::vector<float> row_;
  std::unique_ptr<LocalDensity> density_;
  std::vector<Eigen::Vector2d> positions_m_;
  bool is_placed_ = false;
  std::array<SwingSums, kLevels> levels_{};
};

// The tables of `realism joints`.
// A row a joint, left and right together.

std::string joint_report(const std::string& name, const JointSpeeds& speeds, const ArmSwing& swing);

}  // namespace throng::realism
