// Two people who meet on otherwise empty ground: who they are and the ways they take.
// Dressed, they show what bodies make of a path; steered from where they begin, what steering does.
// One rule: an encounter is a function of seed and number, whatever else is run beside it, and its
// ways keep the discs of the two apart by themselves: what touches are bodies on sound paths.
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

/// One of the two.
struct EncounterPerson {
  double heading_rad = 0;
  double speed_mps = 0;
  double height_m = 0;
  double phase = 0;  ///< of the gait, at the start
  GaitStyle style = GaitStyle::kPlain;
  double avoidance_weight = 0;  ///< this one's share of the way by which the two keep clear
};

class Encounter {
 public:
  /// Diameter of the discs around roots that never overlap.
  static constexpr double kDisc_m = 0.45;
  /// Ways keep so much more apart, since bodies are dressed on them.
  static constexpr double kMargin_m = 0.005;
  static constexpr double kMaxAcceleration_mps2 = 1.5;
  /// The two are nearest half of this after the start, if nobody gives way.
  static constexpr double kDuration_s = 9;
  /// Nobody gets farther from the middle.
  static constexpr double kReach_m = 9;

  Encounter(uint64_t seed, uint64_t number);

  uint64_t number() const { return number_; }
  EncounterKind kind() const { return kind_; }
  const std::array<EncounterPerson, 2>& people() const { return people_; }
  /// Across the relative motion: how near their middles would come if nobody gave way.
  double offset_m() const { return offset_m_; }
  /// How many draws were put away before this one, since their ways would have broken a bound.
  int rejected() const { return rejected_; }

  /// Where a root is, from the middle of the encounter, `time_s` after the start.
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
  Eigen::Vector2d across_ = Eigen::Vector2d::UnitY();  ///< from the first to the second
  double closing_mps_ = 0;                             ///< relative speed
  double ramp_s_ = 0;                                  ///< how long before they give way
  int rejected_ = 0;
};

}  // namespace throng::validation
