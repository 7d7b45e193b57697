#include "crowd/steering_state.h"

#include <cmath>
#include <type_traits>

#include "avatars/gait/gait.h"
#include "crowd/turning.h"

namespace throng {
namespace {

/// Upper bound of speeds for any scene, including pushes.
constexpr double kMaxSpeed_mps = 100;

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

/// Comparisons are negated to reject NaN as well.
void check_read(Archive& a, SteeringState& state) {
  const auto check_head_yaw = [&](float head_yaw_rad) {
    if (!(std::abs(head_yaw_rad) <= Gait::kMaxHeadYaw_rad))
      a.reject("a head yaw within its limits", "another value");
  };
  const auto check_speed = [&](const Eigen::Vector2d& speed) {
    if (!(speed.norm() <= kMaxSpeed_mps)) a.reject("the speed of an agent", "another value");
  };
  for (const float head_yaw_rad : state.head_yaws_rad) check_head_yaw(head_yaw_rad);
  for (const auto* speeds : {&state.velocities_mps, &state.headings})
    for (const Eigen::Vector2d& speed : *speeds) check_speed(speed);
  constexpr float kMaxHeadYaw_radps = 2 * Gait::kMaxHeadYaw_rad / tuning::kHeadYawTime_s;
  state.agents.for_each_field([&](const auto& values, auto field, FieldCheck check) {
    for (size_t slot = 0; slot < state.grid.order().size(); ++slot) {
      const auto& value = values[slot].*field;
      using Value = std::remove_cvref_t<decltype(value)>;
      if constexpr (std::is_same_v<Value, double>) {
        if (check == FieldCheck::kTurnRate && !(std::abs(value) <= 1.001 * tuning::kMaxTurn_radps))
          a.reject("a turn rate within its limits", "another value");
      } else if constexpr (std::is_same_v<Value, float>) {
        if (check == FieldCheck::kHeadYaw) check_head_yaw(value);
        if (check == FieldCheck::kHeadYawRate && !(std::abs(value) <= kMaxHeadYaw_radps))
          a.reject("a head yaw rate within its limits", "another value");
        if (check == FieldCheck::kShare && !(value > 0 && value <= 1))
          a.reject("a radius scale above 0 and up to 1", "another value");
        if (check == FieldCheck::kUnitInterval && !(value >= 0 && value <= 1))
          a.reject("a share from 0 to 1", "another value");
        if (check == FieldCheck::kSpeedComponent &&
            !(std::abs(value) <= static_cast<float>(kMaxSpeed_mps)))
          a.reject("the speed of an agent", "another value");
      } else if constexpr (std::is_same_v<Value, Eigen::Vector2d>) {
        if (check == FieldCheck::kSpeed) check_speed(value);
      }
    }
  });
}

}  // namespace

SteeringState::SteeringState(const Rectangle& ground, std::span<const AgentSpec> people,
                             double seconds_per_step, const SteeringTraits& model_traits,
                             SimdTarget simd, Workers& workers_of_run)
    : workers(workers_of_run),
      traits(model_traits),
      step_s(seconds_per_step),
      grid(ground, people.size(), simd) {
  steps_per_period = std::max(1, static_cast<int>(std::floor(tuning::kPeriod_s / step_s + 0.5)));
  period_s = steps_per_period * step_s;
  for (const AgentSpec& person : people) {
    radii_m.push_back(person.radius_m);
    desired_speeds_mps.push_back(person.desired_speed_mps);
    positions_m.push_back(person.position_m);
    headings.push_back(person.heading);
    max_radius_m = std::max(max_radius_m, static_cast<float>(person.radius_m));
    max_desired_speed_mps = std::max(max_desired_speed_mps, person.desired_speed_mps);
  }
  const size_t count = people.size();
  const auto blocks = static_cast<size_t>(block_count(count));
  velocities_mps.assign(count, Eigen::Vector2d::Zero());
  displacements_m.assign(count, 0);
  head_yaws_rad.assign(count, 0);
  slot_of.assign(count, kNowhere);
  decider_slots.resize(count);
  first_deciders.assign(static_cast<size_t>(steps_per_period) + 2, 0);
  agents.resize(count);
  decisions.resize(count, kMaxNeighbours, blocks);
  block_values.resize(blocks);
}

void SteeringState::set_preferred(size_t slot, const Eigen::Vector2f& preferred_mps) {
  NeighbourState& published = agents.published[slot];
  published.preferred_x_mps = preferred_mps.x();
  published.preferred_y_mps = preferred_mps.y();
  const float length =
      std::sqrt(preferred_mps.x() * preferred_mps.x() + preferred_mps.y() * preferred_mps.y());
  const bool walks = length >= static_cast<float>(tuning::kMinPreferred_mps);
  published.direction_x = walks ? preferred_mps.x() / length : 0.0f;
  published.direction_y = walks ? preferred_mps.y() / length : 0.0f;
}

void SteeringState::archive_agents(Archive& a) {
  a(velocities_mps, head_yaws_rad);
  agents.for_each_field([&](auto& values, auto field, FieldCheck check) {
    if (check == FieldCheck::kDerived) return;
    archive_by_id(
        a, *this, [&](size_t slot) -> auto& { return values[slot].*field; });
  });
  archive_by_id(
      a, *this, [&](size_t slot) -> auto& { return agents.queuing[slot]; });
  archive_by_id(
      a, *this, [&](size_t slot) -> auto& { return agents.stall_cause[slot]; });
  if (!a.is_reading()) return;
  for (size_t slot = 0; slot < grid.order().size(); ++slot)
    agents[slot].velocity_mps = velocities_mps[grid.order()[slot]];
  check_read(a, *this);
  for (size_t slot = 0; slot < grid.order().size(); ++slot) publish_state(slot);
}

}  // namespace throng
