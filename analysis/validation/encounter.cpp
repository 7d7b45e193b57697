#include "analysis/validation/encounter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/portable_math.h"
#include "base/random.h"
#include "crowd/people.h"

namespace throng::validation {
namespace {

/// Headings that differ by less count as the same way, those within this of opposite as head-on.
constexpr double kParallelWithin_rad = 15 * kDegree;
/// At lower closing speeds the two stay next to each other longer than an encounter lasts.
constexpr double kMinClosing_mps = 0.25;
constexpr double kCheck_s = 1.0 / 240;

Eigen::Vector2d direction(double heading_rad) {
  const SinCos turn = sin_cos(heading_rad);
  return {turn.cos, turn.sin};
}

double angle_between(EncounterKind kind, double share) {
  switch (kind) {
    case EncounterKind::kHeadOn:
      return std::numbers::pi + (2 * share - 1) * kParallelWithin_rad;
    case EncounterKind::kSameWay:
      return (2 * share - 1) * kParallelWithin_rad;
    case EncounterKind::kCrossing:
      break;
  }
  const double side = share < 0.5 ? -1 : 1;
  const double within = share < 0.5 ? 2 * share : 2 * share - 1;
  return side * (kParallelWithin_rad + within * (std::numbers::pi - 2 * kParallelWithin_rad));
}

}  // namespace

const char* name_of(EncounterKind kind) {
  switch (kind) {
    case EncounterKind::kHeadOn:
      return "head-on";
    case EncounterKind::kCrossing:
      return "crossing";
    case EncounterKind::kSameWay:
      return "same way";
  }
  return "";
}

Encounter::Encounter(uint64_t seed, uint64_t number) : number_(number) {
  for (int attempt = 0;; ++attempt) {
    draw(seed, attempt);
    rejected_ = attempt;
    if (is_sound()) return;
  }
}

void Encounter::draw(uint64_t seed, int attempt) {
  uint32_t index = 0;
  const auto uniform = [&](double low, double high) {
    return random_uniform({seed, number_, static_cast<uint64_t>(attempt), Purpose::kSpawnPosition},
                          low, high, index++);
  };
  kind_ = static_cast<EncounterKind>(std::min(uniform(0, kEncounterKinds), kEncounterKinds - 0.5));
  people_[0].heading_rad = uniform(0, 2 * std::numbers::pi);
  people_[1].heading_rad = people_[0].heading_rad + angle_between(kind_, uniform(0, 1));
  offset_m_ = uniform(0, 0.6);
  const double side = uniform(-1, 1) < 0 ? -1 : 1;
  ramp_s_ = uniform(1.3, 1.8);
  people_[0].avoidance_weight = uniform(0.35, 0.65);
  people_[1].avoidance_weight = 1 - people_[0].avoidance_weight;
  const AgeGroup& adults = age_group(Age::kAdult);
  for (size_t i = 0; i < 2; ++i) {
    EncounterPerson& person = people_[i];
    person.speed_mps = uniform(0.6, 1.8);
    person.phase = uniform(0, 1);
    const uint64_t id = 2 * number_ + i;
    person.height_m = throng::draw(adults.height_m, seed, id, Purpose::kHeight);
    person.style = draw_style(adults.styles, seed, id);
  }
  const Eigen::Vector2d relative = people_[1].speed_mps * direction(people_[1].heading_rad) -
                                   people_[0].speed_mps * direction(people_[0].heading_rad);
  closing_mps_ = relative.norm();
  if (closing_mps_ > 0)
    across_ = side * Eigen::Vector2d(-relative.y(), relative.x()) / closing_mps_;
}

/// Share of the avoiding displacement: 1 while the discs pass each other, with a raised-cosine ramp
/// before and after.
double Encounter::avoidance_share(double since_closest_s) const {
  const double beside_s = (kDisc_m + kMargin_m) / closing_mps_;
  const double outside = (std::abs(since_closest_s) - beside_s) / ramp_s_;
  if (outside <= 0) return 1;
  if (outside >= 1) return 0;
  return 0.5 + 0.5 * sin_cos(std::numbers::pi * outside).cos;
}

Eigen::Vector2d Encounter::place_m(size_t person, double time_s) const {
  const double since_s = time_s - 0.5 * kDuration_s;
  const EncounterPerson& one = people_[person];
  const double missing_m = std::max(0.0, kDisc_m + kMargin_m - offset_m_);
  const double off_m =
      0.5 * offset_m_ + one.avoidance_weight * missing_m * avoidance_share(since_s);
  return since_s * one.speed_mps * direction(one.heading_rad) +
         (person == 0 ? -off_m : off_m) * across_;
}

/// Checks the sampled paths against the bounds.
bool Encounter::is_sound() const {
  if (closing_mps_ < kMinClosing_mps) return false;
  const auto count = static_cast<int>(kDuration_s / kCheck_s);
  for (int i = 0; i <= count; ++i) {
    const double time_s = i * kCheck_s;
    if ((place_m(1, time_s) - place_m(0, time_s)).norm() < kDisc_m) return false;
    for (size_t person = 0; person < 2; ++person) {
      const Eigen::Vector2d before = place_m(person, time_s - kCheck_s),
                            at = place_m(person, time_s),
                            after = place_m(person, time_s + kCheck_s);
      if (at.norm() > kReach_m) return false;
      const double acceleration_mps2 = (after - 2 * at + before).norm() / (kCheck_s * kCheck_s);
      if (acceleration_mps2 > kMaxAcceleration_mps2) return false;
    }
  }
  return true;
}

std::string Encounter::description() const {
  const double apart_rad =
      std::remainder(people_[1].heading_rad - people_[0].heading_rad, 2 * std::numbers::pi);
  return fmt::format("{} at {:.0f} degrees, {:.2f} and {:.2f} m/s, offset {:.2f} m", name_of(kind_),
                     std::abs(apart_rad) / kDegree, people_[0].speed_mps, people_[1].speed_mps,
                     offset_m_);
}

}  // namespace throng::validation
