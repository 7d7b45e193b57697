// Encounter describes two people who meet on otherwise empty ground, and their paths.
// Retargeted bodies on these paths test body motion; the same start with steering tests steering.
// Invariant: an encounter depends on seed and number only, and its paths keep both discs apart;
// contacts are therefore due to bodies.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>

#include "avatars/gait/gait_style.h"

namespace throng::validation {

enum class EncounterKind : uint8_t { kHeadOn, kCrossing, kSameWay };
inline constexpr size_t kEncounterKinds = 3;
const char* name_of(EncounterKind kind);

/// One of the two people.
struct EncounterPerson {
  double heading_rad = 0;
  double speed_mps = 0;
  double height_m = 0;
  double phase = 0;  ///< gait phase at the start
  GaitStyle style = GaitStyle::kPlain;
  double avoidance_weight = 0;  ///< this person's share of the avoiding displacement
};

class Encounter {
 public:
  /// Diameter of the discs around roots that never overlap.
  static constexpr double kDisc_m = 0.45;
  /// Additional distance between the paths, as a margin for retargeting.
  static constexpr double kMargin_m = 0.005;
  static constexpr double kMaxAcceleration_mps2 = 1.5;
  /// The two are closest after half of this time, if neither avoids.
  static constexpr double kDuration_s = 9;
  /// Maximum distance of both from the centre.
  static constexpr double kReach_m = 9;

  Encounter(uint64_t seed, uint64_t number);

  uint64_t number() const { return number_; }
  EncounterKind kind() const { return kind_; }
  const std::array<EncounterPerson, 2>& people() const { return people_; }
  /// Distance of the centres at closest approach if neither avoids, across the relative motion.
  double offset_m() const { return offset_m_; }
  /// Number of rejected draws, whose paths broke a bound.
  int rejected() const { return rejected_; }

  /// Position of a root relative to the encounter's centre, `time_s` after the start.
  Eigen::Vector2d place_m(size_t person, double time_s) const;

  /// "head-on at 178 degrees, 1.21 and 0.84 m/s, offset 0.12 m"
  std::string description() const;

 private:
  void draw(uint64_t seed, int attempt);
  bool is_sound() const;
  double avoidance_share(double since_closest_s) const;

  uint64_t number_ = 0;
  EncounterKind kind_ = EncounterKind::kHeadOn;
  std::array<EncounterPerson, 2> people_;
  double offset_m_ = 0;
  /// Unit vector from the first person to the second.
  Eigen::Vector2d across_ = Eigen::Vector2d::UnitY();
  double closing_mps_ = 0;  ///< relative speed
  /// Duration of the avoiding motion before closest approach.
  double ramp_s_ = 0;
  int rejected_ = 0;
};

}  // namespace throng::validation
