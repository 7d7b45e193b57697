#include "crowd/steering_state.h"

#include <cmath>
#include <type_traits>

#include "avatars/gait/gait.h"
#include "crowd/turning.h"

namespace throng {
namespace {

/// Nobody runs faster, whatever the scene and however hard others push.
constexpr double kLargest_mps = 100;

/// at(slot) is the value.
template <typename At>
void archive_by_id(Archive& a, const SteeringState& state, const At& at) {
  using Value = std::remove_reference_t<decltype(at(size_t{0}))>;
  std::vector<Value> by_id(state.size(), zero_of<Value>());
  const std::span<const uint32_t> ids = state.grid.order();
  if (!a.is_reading())
    for (size_t slot = 0; slot < ids.size(); ++slot) by_id[ids[slot]] = at(slot);
  a(by_id);
  if (a.is_reading())
    for (size_t slot = 0; slot < ids.size(); ++slot) at(slot) = by_id[ids[slot]];
}

/// Comparisons are written so that NaN is refused, too.
void check_read(Archive& a, SteeringState& state) {
  const auto check_look = [&](float look_rad) {
    if (!(std::abs(look_rad) <= Gait::kMostLook_rad))
      a.refuse("a head turned as far as heads do", "another");
  };
  const auto check_speed = [&](const Eigen::Vector2d& speed) {
    if (!(speed.norm() <= kLargest_mps)) a.refuse("the speed of a person", "another");
  };
  for (const float look_rad : state.looks_rad) check_look(look_rad);
  for (const auto* speeds : {&state.velocities_mps, &state.headings})
    for (const Eigen::Vector2d& speed : *speeds) check_speed(speed);
  constexpr float kFastestLook_radps = 2 * Gait::kMostLook_rad / tuning::kLook_s;
  state.agents.for_each_field([&](const auto& values, auto field, Saved saved) {
    for (size_t slot = 0; slot < state.grid.order().size(); ++slot) {
      const auto& value = values[slot].*field;
      using Value = std::remove_cvref_t<decltype(value)>;
      if constexpr (std::is_same_v<Value, double>) {
        if (saved == Saved::kAsTurn && !(std::abs(value) <= 1.001 * tuning::kMaxTurn_radps))
          a.refuse("a turn as fast as people turn", "another");
      } else if constexpr (std::is_same_v<Value, float>) {
        if (saved == Saved::kAsLook) check_look(value);
        if (saved == Saved::kAsLookSpeed && !(std::abs(value) <= kFastestLook_radps))
          a.refuse("a head that turns as fast as heads do", "another");
        if (saved == Saved::kAsShare && !(value > 0 && value <= 1))
          a.refuse("a share of a disc", "another");
        if (saved == Saved::kAsPart && !(value >= 0 && value <= 1)) a.refuse("a share", "another");
        if (saved == Saved::kAsPace && !(std::abs(value) <= static_cast<float>(kLargest_mps)))
          a.refuse("the speed of a person", "another");
      } else if constexpr (std::is_same_v<Value, Eigen::Vector2d>) {
        if (saved == Saved::kAsSpeed) check_speed(value);
      }
    }
  });
}

}  // namespace

SteeringState::SteeringState(const Rectangle& ground, std::span<const Person> people,
                             double seconds_per_step, const SteeringTraits& model_traits,
                             SimdTarget simd, Workers& workers_of_run)
    : workers(workers_of_run),
      traits(model_traits),
      step_s(seconds_per_step),
      grid(ground, people.size(), simd) {
  steps_per_period = std::max(1, static_cast<int>(std::floor(tuning::kPeriod_s / step_s + 0.5)));
  period_s = steps_per_period * step_s;
  for (const Person& person : people) {
    radii_m.push_back(person.radius_m);
    free_speeds_mps.push_back(person.free_speed_mps);
    positions_m.push_back(person.position_m);
    headings.push_back(person.heading);
    widest_m = std::max(widest_m, static_cast<float>(person.radius_m));
    fastest_mps = std::max(fastest_mps, person.free_speed_mps);
  }
  const size_t count = people.size();
  const auto blocks = static_cast<size_t>(block_count(count));
  velocities_mps.assign(count, Eigen::Vector2d::Zero());
  walked_m.assign(count, 0);
  looks_rad.assign(count, 0);
  slot_of.assign(count, kNowhere);
  decider_slots.resize(count);
  first_deciders.assign(static_cast<size_t>(steps_per_period) + 2, 0);
  agents.resize(count);
  decisions.resize(count, kMaxNeighbours, blocks);
  block_values.resize(blocks);
}

void SteeringState::set_preferred(size_t slot, const Eigen::Vector2f& wanted_mps) {
  Seen& seen = agents.seen[slot];
  seen.wanted_x_mps = wanted_mps.x();
  seen.wanted_y_mps = wanted_mps.y();
  const float length = std::sqrt(wanted_mps.x() * wanted_mps.x() + wanted_mps.y() * wanted_mps.y());
  const bool walks = length >= static_cast<float>(tuning::kWish_mps);
  seen.way_x = walks ? wanted_mps.x() / length : 0.0f;
  seen.way_y = walks ? wanted_mps.y() / length : 0.0f;
}

void SteeringState::archive_agents(Archive& a) {
  a(velocities_mps, looks_rad);
  agents.for_each_field([&](auto& values, auto field, Saved saved) {
    if (saved == Saved::kElsewhere) return;
    archive_by_id(
        a, *this, [&](size_t slot) -> auto& { return values[slot].*field; });
  });
  archive_by_id(
      a, *this, [&](size_t slot) -> auto& { return agents.queuing[slot]; });
  archive_by_id(
      a, *this, [&](size_t slot) -> auto& { return agents.held_up[slot]; });
  if (!a.is_reading()) return;
  for (size_t slot = 0; slot < grid.order().size(); ++slot)
    agents[slot].velocity_mps = velocities_mps[grid.order()[slot]];
  check_read(a, *this);
  for (size_t slot = 0; slot < grid.order().size(); ++slot) show(slot);
}

}  // namespace throng
