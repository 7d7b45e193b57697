// JointSpeeds measures joint speeds and accelerations; ArmSwing measures the swing of the arms.
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

// Speeds and accelerations are differences of posture rows of successive frames, without smoothing.
// After an entry or a jump a person counts from the next frame on.

/// Half of a body: legs carry the body and follow the feet; the upper body moves freely.
enum class BodyHalf : uint8_t { kLegs, kUpper };
inline constexpr size_t kBodyHalves = 2;

/// Limits of a joint, in degrees; prismatic joints in metres.
struct JointLimit {
  const char* joint;  ///< name without its side
  BodyHalf half;
  double speed_per_s;
  double acceleration_per_s2;
};

/// Returns the limits of all joints of the bundled adult; sources are stated at the definition.
const std::vector<JointLimit>& joint_limits();
/// Returns null for a joint of another model.
const JointLimit* limit_of(const std::string& joint);

/// Statistics of the joints of one name, left and right together.
struct JointMotion {
  JointMotion(bool is_prismatic_in);

  bool is_prismatic;
  Histogram speeds, accelerations;  ///< degrees or metres, per s and per s2
  uint64_t over_speed = 0;          ///< above the limit
  uint64_t over_acceleration = 0;
};

class JointSpeeds final : public Sink {
 public:
  /// Below this speed a person stands.
  static constexpr double kStanding_mps = 0.2;
  /// Above this speed a displacement is a jump.
  static constexpr double kJump_mps = 12;

  JointSpeeds();

  SinkNeeds needs() const override { return {.postures = true}; }
  void begin(const RunInfo& run) override;
  void frame(const RunInfo& run, const Frame& frame) override;
  void end(const RunInfo&, const RunEnd&) override {}

  /// By joint name without "left_" and "right_".
  const std::map<std::string, JointMotion>& joints() const { return joints_; }
  /// Number of person frames with known speeds, and those in which a joint of a half exceeded its
  /// limit.
  uint64_t frames() const { return frames_; }
  uint64_t frames_over_speed(BodyHalf half) const { return over_speed_[index(half)]; }
  uint64_t frames_over_acceleration(BodyHalf half) const { return over_acceleration_[index(half)]; }
  /// Turning speeds of roots in degrees per second: standing people, and all.
  const Histogram& standing_turns() const { return standing_turns_; }
  const Histogram& turns() const { return turns_; }

 private:
  struct Column {
    JointMotion* motion;
    double unit;  ///< degrees per radian, or 1
    size_t half;
    double max_speed, max_acceleration;
  };
  static size_t index(BodyHalf half) { return static_cast<size_t>(half); }
  void take(const RunInfo& run, const Frame& frame, size_t id);

  std::map<std::string, JointMotion> joints_;
  std::vector<std::vector<Column>> columns_;  ///< indexed by model; empty: not a person
  std::vector<float> before_, earlier_;       ///< rows of the last two frames
  std::vector<RootPose> roots_before_;
  std::vector<uint8_t>
      history_frames_;  ///< indexed by avatar: number of known earlier frames, at most 2
  uint64_t frames_ = 0;
  std::array<uint64_t, kBodyHalves> over_speed_{}, over_acceleration_{};
  Histogram standing_turns_, turns_;
};

/// Sums of arm swing and of the swing that the gait style prescribes at the same speed. Each whole
/// cycle of each shoulder counts by its duration.
struct SwingSums {
  double time_s = 0;  ///< duration of cycles, summed over people
  double swing_rad_s = 0;
  double reference_rad_s = 0;  ///< swing of the gait style

  double mean_deg() const;
  double share() const { return swing_rad_s / reference_rad_s; }
};

class ArmSwing final : public Sink {
 public:
  /// Density levels: people per m2 within 2 m.
  static constexpr std::array<double, 5> kBounds_per_m2 = {0.5, 1, 2, 3.57, 5};
  static constexpr size_t kLevels = kBounds_per_m2.size() + 1;
  /// A cycle counts only above this speed.
  static constexpr float kWalking_mps = 0.3f;

  /// `simulation` runs the frames and provides phases and styles.
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
  /// State of an avatar since its phase was last 0.
  struct Cycle {
    bool is_whole = false;  ///< began at phase 0, and the avatar walked since
    int frames = 0;
    float last_phase = -1;  ///< below 0: not present before
    std::array<Range, 2> swing, reference;
  };
  struct Kind {
    std::array<int, 2> shoulders{-1, -1};  ///< columns, right and left
    size_t columns = 0;
    std::vector<std::unique_ptr<Gait>> gaits;  ///< indexed by style; null for unused ones
  };

  void finish(const RunInfo& run, const Frame& frame, size_t id);

  const Simulation& simulation_;
  std::vector<Kind> kinds_;  ///< indexed by model
  std::vector<Cycle> cycles_;
  std::vector<float> row_;
  std::unique_ptr<LocalDensity> density_;
  std::vector<Eigen::Vector2d> positions_m_;
  bool is_placed_ = false;
  std::array<SwingSums, kLevels> levels_{};
};

/// Returns the tables of `realism joints`: a row per joint name, left and right together.

std::string joint_report(const std::string& name, const JointSpeeds& speeds, const ArmSwing& swing);

}  // namespace throng::realism
