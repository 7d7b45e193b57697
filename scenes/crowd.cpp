#include "scenes/crowd.h"

#include <algorithm>
#include <cmath>

#include "base/elementary.h"
#include "scenes/crowd_blocks.h"
#include "scenes/crowd_tuning.h"

namespace throng {
namespace {

/// Nobody runs faster, whatever the scene and however hard others push.
constexpr double kLargest_mps = 100;

}  // namespace

Crowd::Crowd(const Ways& ways, std::span<const Person> people, const CrowdOptions& options,
             Workers& workers)
    : ways_(ways),
      workers_(workers),
      options_(options),
      model_(make_steering_model(options.steering.model, options.simd)),
      journeys_(ways, people, options.seed),
      traffic_(ways, people, options.seed),
      grid_(ways.walkable().ground(), people.size(), options.simd) {
  steps_a_decision_ =
      std::max(1, static_cast<int>(std::floor(tuning::kPeriod_s / options.step_s + 0.5)));
  period_s_ = steps_a_decision_ * options.step_s;
  const SinCos largest = sin_cos(tuning::kMaxTurn_radps * options.step_s);
  turn_cos_ = largest.cos;
  turn_sin_ = largest.sin;
  for (const Person& person : people) {
    radii_m_.push_back(person.radius_m);
    free_speeds_mps_.push_back(person.free_speed_mps);
    positions_m_.push_back(person.position_m);
    headings_.push_back(person.heading);
    widest_m_ = std::max(widest_m_, static_cast<float>(person.radius_m));
    fastest_mps_ = std::max(fastest_mps_, person.free_speed_mps);
  }
  const size_t count = people.size();
  velocities_mps_.assign(count, Eigen::Vector2d::Zero());
  smooth_velocities_mps_ = old_velocities_mps_ = next_velocities_mps_ = intents_mps_ =
      velocities_mps_;
  anchors_m_ = positions_m_;
  drifts_mps_.assign(count, Eigen::Vector2d::Zero());
  walked_m_.assign(count, 0);
  clearances_m_.assign(count, 0);
  anchor_steps_.assign(count, 0);
  queued_steps_.assign(count, 0);
  queuing_.assign(count, 0);
  slots_.resize(count);
  walls_.resize(static_cast<size_t>(workers.threads()));
  for (Walls& walls : walls_) {
    walls.x.reserve(kPeopleABlock * kMostWalls);
    walls.y.reserve(kPeopleABlock * kMostWalls);
    walls.clearance_m.reserve(kPeopleABlock * kMostWalls);
    walls.starts.reserve(kPeopleABlock + 1);
  }
  block_values_.resize(static_cast<size_t>(block_count(count)));
  grid_.rebuild(positions_m_, traffic_.present());
  for (uint32_t id = 0; id < count; ++id)
    if (journeys_.is_present(id)) start_walking(id, headings_[id]);
}

/// Whoever is on the way already walks at the free speed.
void Crowd::start_walking(uint32_t id, const Eigen::Vector2d& heading) {
  const bool walks = journeys_.doing(id) == Doing::kWalking;
  headings_[id] = heading;
  velocities_mps_[id] = smooth_velocities_mps_[id] = old_velocities_mps_[id] =
      next_velocities_mps_[id] = intents_mps_[id] =
          walks ? Eigen::Vector2d(free_speeds_mps_[id] * heading) : Eigen::Vector2d::Zero();
  drifts_mps_[id] = Eigen::Vector2d::Zero();
  anchors_m_[id] = positions_m_[id];
  anchor_steps_[id] = steps_;
  queued_steps_[id] = 0;
}

void Crowd::archive(Archive& a) {
  a(steps_, positions_m_, velocities_mps_, headings_, smooth_velocities_mps_, walked_m_);
  a(old_velocities_mps_, next_velocities_mps_, drifts_mps_, intents_mps_, clearances_m_);
  a(journeys_, traffic_, anchors_m_, anchor_steps_, queued_steps_, queuing_, counters_);
  if (!a.is_reading() || size() == 0) return;
  for (uint32_t id = 0; id < size(); ++id)
    if (journeys_.is_present(id) && !ways_.walkable().ground().contains(positions_m_[id]))
      a.refuse("a place on the ground", "one outside");
  // Written so that NaN is refused, too.
  for (const auto* speeds :
       {&velocities_mps_, &headings_, &smooth_velocities_mps_, &old_velocities_mps_,
        &next_velocities_mps_, &drifts_mps_, &intents_mps_})
    for (const Eigen::Vector2d& speed : *speeds)
      if (!(speed.norm() <= kLargest_mps)) a.refuse("the speed of a person", "another");
  grid_.rebuild(positions_m_, traffic_.present());
}

void Crowd::Slots::resize(size_t count) {
  for (std::vector<float>* each :
       {&vx_mps, &vy_mps, &radius_m, &wanted_x_mps, &wanted_y_mps, &max_speed_mps, &horizon_s,
        &urge, &next_x_mps, &next_y_mps, &expected_x_m, &expected_y_m, &swept_x_m, &swept_y_m})
    each->resize(count);
  neighbours.resize(count * kMaxNeighbours);
  neighbour_counts.resize(count);
  close_counts.resize(count);
}

void Crowd::step() {
  if (size() == 0) return;
  if (steps_ % steps_a_decision_ == 0) decide();
  const std::span<const double> turned = by_block([this](size_t begin, size_t end) {
    double turned_rad = 0;
    for (size_t slot = begin; slot < end; ++slot) {
      move(grid_.order()[slot]);
      turned_rad += turn(grid_.order()[slot]);
    }
    return turned_rad;
  });
  for (const double each : turned) counters_.turned_rad += each;
  counters_.walked_s += options_.step_s * static_cast<double>(grid_.order().size());
  ++steps_;
}

void Crowd::drive(uint32_t id, const Eigen::Vector2d& position_m, const Eigen::Vector2d& heading,
                  const Eigen::Vector2d& velocity_mps) {
  walked_m_[id] = (position_m - positions_m_[id]).norm();
  positions_m_[id] = position_m;
  headings_[id] = heading;
  velocities_mps_[id] = smooth_velocities_mps_[id] = intents_mps_[id] = velocity_mps;
  old_velocities_mps_[id] = next_velocities_mps_[id] = velocity_mps;
  drifts_mps_[id].setZero();
  // Who is driven is not stuck, however long it stands.
  anchors_m_[id] = position_m;
  anchor_steps_[id] = steps_;
}

void Crowd::move(uint32_t id) {
  const auto part = static_cast<double>(steps_ % steps_a_decision_);
  const Eigen::Vector2d change = next_velocities_mps_[id] - old_velocities_mps_[id];
  const Eigen::Vector2d midway =
      old_velocities_mps_[id] + (part + 0.5) / steps_a_decision_ * change + drifts_mps_[id];
  velocities_mps_[id] = old_velocities_mps_[id] + (part + 1) / steps_a_decision_ * change;
  const Eigen::Vector2d from = positions_m_[id];
  Eigen::Vector2d to = from + options_.step_s * midway;
  // Far from any wall at the decision, nobody reaches one before the next.
  const double reach_m =
      period_s_ * (2 * tuning::kHaste * free_speeds_mps_[id] + tuning::kMaxDrift_mps);
  if (clearances_m_[id] < reach_m + tuning::kWallGap_m)
    to = ways_.walkable().slide(from, to, tuning::kWallGap_m);
  walked_m_[id] = (to - from).norm();
  positions_m_[id] = to;
}

double Crowd::turn(uint32_t id) {
  Eigen::Vector2d& smooth = smooth_velocities_mps_[id];
  smooth += options_.step_s / (tuning::kTurnSmoothing_s + options_.step_s) *
            (velocities_mps_[id] - smooth);
  const double speed = smooth.norm();
  if (speed < tuning::kTurnSpeed_mps) return 0;
  const Eigen::Vector2d to = smooth / speed;
  const Eigen::Vector2d from = headings_[id];
  if (from.dot(to) >= turn_cos_) {
    headings_[id] = to;
    return (to - from).norm();  // less than a thousandth below the angle
  }
  const double side = from.x() * to.y() - from.y() * to.x() >= 0 ? turn_sin_ : -turn_sin_;
  const Eigen::Vector2d turned(turn_cos_ * from.x() - side * from.y(),
                               side * from.x() + turn_cos_ * from.y());
  headings_[id] = turned.normalized();
  return tuning::kMaxTurn_radps * options_.step_s;
}

}  // namespace throng
