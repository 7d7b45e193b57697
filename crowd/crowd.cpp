#include "crowd/crowd.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "avatars/gait/gait.h"
#include "base/elementary.h"
#include "crowd/crowd_blocks.h"
#include "crowd/crowd_tuning.h"

namespace throng {
namespace {

/// Nobody runs faster, whatever the scene and however hard others push.
constexpr double kLargest_mps = 100;

std::vector<double> radii_of(std::span<const Person> people) {
  std::vector<double> radii_m;
  for (const Person& person : people) radii_m.push_back(person.radius_m);
  return radii_m;
}

/// The rate at which to turn by so much: no faster than it can be stopped at the end.
double turn_to(double off_rad, double most_radps, double most_radps2, double step_s) {
  const double size = std::abs(off_rad);
  return std::copysign(std::min({most_radps, std::sqrt(2 * most_radps2 * size), size / step_s}),
                       off_rad);
}

}  // namespace

Crowd::Crowd(Ways& ways, std::span<const Person> people, const CrowdOptions& options,
             Workers& workers)
    : ways_(ways),
      workers_(workers),
      options_(options),
      model_(make_steering_model(options.steering.model, options.simd)),
      traits_(model_->traits()),
      detours_(ways, workers),
      journeys_(ways, detours_, people, options.seed),
      traffic_(ways, people, options.seed),
      occasions_(ways, people),
      doorkeeper_(ways, radii_of(people), workers),
      exits_(ways, people, options.seed),
      parties_(ways, people),
      queues_(ways, people),
      grid_(ways.walkable().ground(), people.size(), options.simd) {
  steps_a_period_ =
      std::max(1, static_cast<int>(std::floor(tuning::kPeriod_s / options.step_s + 0.5)));
  period_s_ = steps_a_period_ * options.step_s;
  for (const Person& person : people) {
    radii_m_.push_back(person.radius_m);
    free_speeds_mps_.push_back(person.free_speed_mps);
    faces_m_.push_back(person.face_m);
    squeezes_.push_back(person.squeeze);
    enters_mps_.push_back(static_cast<float>(person.enters_mps.value_or(-1)));
    positions_m_.push_back(person.position_m);
    headings_.push_back(person.heading);
    widest_m_ = std::max(widest_m_, static_cast<float>(person.radius_m));
    fastest_mps_ = std::max(fastest_mps_, person.free_speed_mps);
  }
  const size_t count = people.size();
  velocities_mps_.assign(count, Eigen::Vector2d::Zero());
  walked_m_.assign(count, 0);
  looks_rad_.assign(count, 0);
  slot_of_.assign(count, kNowhere);
  deciders_.resize(count);
  first_deciders_.assign(static_cast<size_t>(steps_a_period_) + 1, 0);
  walkers_.resize(count);
  carried_.resize(count);
  slots_.resize(count, kMaxNeighbours, static_cast<size_t>(block_count(count)));
  walls_.resize(static_cast<size_t>(workers.threads()));
  for (Walls& walls : walls_) {
    walls.x.reserve(kPeopleABlock * kMostWalls);
    walls.y.reserve(kPeopleABlock * kMostWalls);
    walls.clearance_m.reserve(kPeopleABlock * kMostWalls);
    walls.starts.reserve(kPeopleABlock + 1);
  }
  block_values_.resize(static_cast<size_t>(block_count(count)));
  block_ways_m_.resize(block_values_.size() + 1, 0);
  seat_people();
}

/// Everybody takes a slot with all that is known of them; who has just entered starts walking.
void Crowd::seat_people() {
  grid_.rebuild(positions_m_, traffic_.present());
  take_slots();
}

void Crowd::take_slots() {
  std::swap(walkers_, carried_);
  for_slots([this](size_t begin, size_t end, int) {
    std::array<uint32_t, kPeopleABlock> from;
    for (size_t slot = begin; slot < end; ++slot) {
      const uint32_t before = slot_of_[grid_.order()[slot]];
      from[slot - begin] = before == kNowhere ? 0 : before;
    }
    walkers_.carry(carried_, {from.data(), end - begin}, begin);
    for (size_t slot = begin; slot < end; ++slot) {
      if (slot_of_[grid_.order()[slot]] == kNowhere) start_walking(slot);
      show(slot);
    }
  });
  if (traffic_.is_open()) std::fill(slot_of_.begin(), slot_of_.end(), kNowhere);
  for_slots([this](size_t begin, size_t end, int) {
    for (size_t slot = begin; slot < end; ++slot)
      slot_of_[grid_.order()[slot]] = static_cast<uint32_t>(slot);
  });
  list_deciders();
}

/// By counting: each phase in the order of slots.
void Crowd::list_deciders() {
  const std::span<const uint32_t> ids = grid_.order();
  const auto phases = static_cast<uint32_t>(steps_a_period_);
  std::fill(first_deciders_.begin(), first_deciders_.end(), 0);
  for (size_t slot = 0; slot < ids.size(); ++slot) {
    slots_.phase[slot] = static_cast<uint8_t>(parties_.first_of_party(ids[slot]) % phases);
    ++first_deciders_[slots_.phase[slot] + size_t{1}];
  }
  for (size_t phase = 1; phase <= phases; ++phase)
    first_deciders_[phase] += first_deciders_[phase - 1];
  // Filling moves each first to the end of its phase: shift back after, as cells are.
  for (size_t slot = 0; slot < ids.size(); ++slot)
    deciders_[first_deciders_[slots_.phase[slot]]++] = static_cast<uint32_t>(slot);
  std::move_backward(first_deciders_.begin(), first_deciders_.end() - 1, first_deciders_.end());
  first_deciders_.front() = 0;
}

/// What others see of somebody.
void Crowd::show(size_t slot) {
  const AgentState& w = walkers_[slot];
  Seen& seen = walkers_.seen[slot];
  Eigen::Vector2f velocity = w.velocity_mps.cast<float>();
  // People who are stuck show where to, so that others can make way.
  if (traits_.is_nudged)
    velocity += static_cast<float>(tuning::kShownIntent) * seen.urge *
                (Eigen::Vector2f(seen.wanted_x_mps, seen.wanted_y_mps) - velocity);
  seen.vx_mps = velocity.x();
  seen.vy_mps = velocity.y();
  seen.radius_m = static_cast<float>(w.radius_m) * w.squeeze;
  seen.x_m = grid_.x()[slot];
  seen.y_m = grid_.y()[slot];
  look_ahead(slot);
}

/// Where somebody will stand after a period of going on like this.
void Crowd::look_ahead(size_t slot) {
  const AgentState& w = walkers_[slot];
  Seen& seen = walkers_.seen[slot];
  const auto period_s = static_cast<float>(period_s_);
  const Eigen::Vector2f velocity = (w.velocity_mps + w.drift_mps).cast<float>();
  seen.ahead_x_m = seen.x_m + period_s * velocity.x();
  seen.ahead_y_m = seen.y_m + period_s * velocity.y();
}

/// How fast a person enters: as told, or as fast as those ahead let it.
double Crowd::entering_mps(size_t slot) {
  // In single file people are 0.36 m and 1.06 s of their speed behind the one ahead (Seyfried,
  // Steffen, Klingsch & Boltes, 2005).
  constexpr double kRoom_m = 0.36, kHeadway_s = 1.06, kReach_m = 2.5;
  const uint32_t id = grid_.order()[slot], of[] = {static_cast<uint32_t>(slot)};
  if (enters_mps_[id] >= 0) return static_cast<double>(enters_mps_[id]);
  grid_.nearest(of, static_cast<float>(kReach_m), slots_.neighbours.data(),
                slots_.neighbour_counts.data());
  double most_mps = free_speeds_mps_[id];
  for (size_t k = 0; k < slots_.neighbour_counts[slot]; ++k) {
    const uint32_t other = grid_.order()[slots_.neighbours[kMaxNeighbours * slot + k]];
    if (slot_of_[other] == kNowhere) continue;  // enters, too
    const Eigen::Vector2d& way = headings_[id];
    const Eigen::Vector2d offset = positions_m_[other] - positions_m_[id];
    const double ahead_m = offset.dot(way);
    const double aside_m = std::abs(way.x() * offset.y() - way.y() * offset.x());
    if (ahead_m <= 0 || aside_m > radii_m_[id] + radii_m_[other]) continue;
    most_mps = std::min(
        most_mps, std::max(velocities_mps_[other].dot(way), (ahead_m - kRoom_m) / kHeadway_s));
  }
  return std::max(most_mps, 0.0);
}

/// People on their way already walk, but for those who stand too close together for that.
void Crowd::start_walking(size_t slot) {
  const uint32_t id = grid_.order()[slot];
  const bool walks = journeys_.doing(id) == Doing::kWalking && squeezes_[id] == 1;
  AgentState& w = walkers_[slot];
  w.radius_m = radii_m_[id];
  w.free_speed_mps = free_speeds_mps_[id];
  w.position_m = w.anchor_m = positions_m_[id];
  w.heading = headings_[id];
  velocities_mps_[id] =
      walks ? Eigen::Vector2d(entering_mps(slot) * headings_[id]) : Eigen::Vector2d::Zero();
  w.velocity_mps = w.smooth_mps = w.old_mps = w.next_mps = w.intent_mps = velocities_mps_[id];
  w.drift_mps.setZero();
  w.facing.setZero();
  w.own_side_m = 0;
  w.turn_radps = 0;
  w.clearance_m = 0;
  w.look_to_rad = w.look_radps = looks_rad_[id] = 0;
  w.anchor_step = steps_;
  w.queued_steps = 0;
  walkers_.queuing[slot] = walkers_.held_up[slot] = 0;
  w.held = 0;
  w.squeeze = squeezes_[id];
  walkers_.seen[slot].urge = walkers_.seen[slot].eagerness = 0;
  wish_for(slot, velocities_mps_[id].cast<float>());
}

/// at(slot) is the value.
template <typename At>
void Crowd::archive_by_id(Archive& a, const At& at) {
  using Value = std::remove_reference_t<decltype(at(size_t{0}))>;
  std::vector<Value> by_id(size(), zero_of<Value>());
  const std::span<const uint32_t> ids = grid_.order();
  if (!a.is_reading())
    for (size_t slot = 0; slot < ids.size(); ++slot) by_id[ids[slot]] = at(slot);
  a(by_id);
  if (a.is_reading())
    for (size_t slot = 0; slot < ids.size(); ++slot) at(slot) = by_id[ids[slot]];
}

void Crowd::archive(Archive& a) {
  a(steps_, positions_m_, headings_, walked_m_, detours_, journeys_, traffic_, occasions_,
    doorkeeper_, exits_, parties_, counters_);
  queues_.archive(a, journeys_);
  grid_.archive(a);
  if (a.is_reading()) {
    for (uint32_t id = 0; id < size(); ++id)
      if (journeys_.is_present(id) && !ways_.walkable().ground().contains(positions_m_[id]))
        a.refuse("a place on the ground", "one outside");
    std::fill(slot_of_.begin(), slot_of_.end(), kNowhere);
    grid_.rebuild_as_read(positions_m_);
    take_slots();
  }
  a(velocities_mps_, looks_rad_);
  walkers_.for_each_field([&](auto& values, auto field, Saved saved) {
    if (saved == Saved::kElsewhere) return;
    archive_by_id(
        a, [&](size_t slot) -> auto& { return values[slot].*field; });
  });
  archive_by_id(
      a, [&](size_t slot) -> auto& { return walkers_.queuing[slot]; });
  archive_by_id(
      a, [&](size_t slot) -> auto& { return walkers_.held_up[slot]; });
  if (!a.is_reading()) return;
  for (size_t slot = 0; slot < grid_.order().size(); ++slot)
    walkers_[slot].velocity_mps = velocities_mps_[grid_.order()[slot]];
  check_read(a);
  for (size_t slot = 0; slot < grid_.order().size(); ++slot) show(slot);
}

/// Comparisons are written so that NaN is refused, too.
void Crowd::check_read(Archive& a) {
  const auto check_look = [&](float look_rad) {
    if (!(std::abs(look_rad) <= Gait::kMostLook_rad))
      a.refuse("a head turned as far as heads do", "another");
  };
  const auto check_speed = [&](const Eigen::Vector2d& speed) {
    if (!(speed.norm() <= kLargest_mps)) a.refuse("the speed of a person", "another");
  };
  for (const float look_rad : looks_rad_) check_look(look_rad);
  for (const auto* speeds : {&velocities_mps_, &headings_})
    for (const Eigen::Vector2d& speed : *speeds) check_speed(speed);
  constexpr float kFastestLook_radps = 2 * Gait::kMostLook_rad / tuning::kLook_s;
  walkers_.for_each_field([&](const auto& values, auto field, Saved saved) {
    for (size_t slot = 0; slot < grid_.order().size(); ++slot) {
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

void Crowd::step() {
  constexpr size_t kAhead = 8;
  if (size() == 0) return;
  const auto phase = static_cast<int>(steps_ % steps_a_period_);
  if (phase == 0) begin_period();
  decide(phase);
  for_slots([this](size_t begin, size_t end, int) {
    double turned_rad = 0, farthest_m = 0;
    for (size_t slot = begin; slot < end; ++slot) {
      if (slot + kAhead < end) prefetch(grid_.order()[slot + kAhead]);
      farthest_m = std::max(farthest_m, move(slot));
      turned_rad += turn(slot);
      look(slot);
    }
    block_values_[begin / kPeopleABlock] = turned_rad;
    block_ways_m_[begin / kPeopleABlock] = farthest_m;
  });
  const auto blocks = static_cast<size_t>(block_count(grid_.order().size()));
  for (size_t block = 0; block < blocks; ++block) counters_.turned_rad += block_values_[block];
  grid_.add_slack_m(*std::max_element(block_ways_m_.begin(),
                                      block_ways_m_.begin() + static_cast<ptrdiff_t>(blocks)));
  counters_.walked_s += options_.step_s * static_cast<double>(grid_.order().size());
  ++steps_;
}

void Crowd::drive(uint32_t id, const Eigen::Vector2d& position_m, const Eigen::Vector2d& heading,
                  const Eigen::Vector2d& velocity_mps) {
  const double way_m = (position_m - positions_m_[id]).norm();
  walked_m_[id] = way_m;
  positions_m_[id] = position_m;
  headings_[id] = heading;
  velocities_mps_[id] = velocity_mps;
  const uint32_t slot = slot_of_[id];
  if (slot == kNowhere) return;
  AgentState& w = walkers_[slot];
  w.position_m = position_m;
  w.heading = heading;
  w.velocity_mps = w.smooth_mps = w.intent_mps = velocity_mps;
  w.old_mps = w.next_mps = velocity_mps;
  w.drift_mps.setZero();
  w.turn_radps = 0;
  grid_.move(slot, position_m);
  grid_.add_slack_m(way_m);
  show(slot);
  // A driven avatar is not stuck, however long it stands.
  w.anchor_m = position_m;
  w.anchor_step = steps_;
}

void Crowd::lead(uint32_t id, bool is_there) {
  traffic_.lead(id, is_there);
  journeys_.lead(id, is_there);
}

/// Returns how far. The velocity goes over to the one chosen within a period of one's own.
double Crowd::move(size_t slot) {
  AgentState& w = walkers_[slot];
  const size_t steps = static_cast<size_t>(steps_a_period_);
  const auto part = static_cast<double>((phase_ + steps - slots_.phase[slot]) % steps);
  const Eigen::Vector2d change = w.next_mps - w.old_mps;
  const Eigen::Vector2d midway = w.old_mps + (part + 0.5) / steps_a_period_ * change + w.drift_mps;
  w.velocity_mps = w.old_mps + (part + 1) / steps_a_period_ * change;
  const Eigen::Vector2d from = w.position_m;
  Eigen::Vector2d to = from + options_.step_s * midway;
  // Far from any wall at the decision, nobody reaches one before the next.
  const double reach_m =
      period_s_ * (2 * tuning::kHaste * w.free_speed_mps + tuning::kMaxDrift_mps);
  if (w.clearance_m < reach_m + tuning::kWallGap_m)
    to = ways_.walkable().slide(from, to, tuning::kWallGap_m);
  const uint32_t id = grid_.order()[slot];
  if (queues_.any()) to = queues_.keep_out(id, from, to, journeys_);
  w.position_m = to;
  positions_m_[id] = to;
  velocities_mps_[id] = w.velocity_mps;
  grid_.move(slot, to);
  show(slot);
  const double way_m = (to - from).norm();
  walked_m_[id] = way_m;
  return way_m;
}

void Crowd::look(size_t slot) {
  const auto step_s = static_cast<float>(options_.step_s);
  float& look_rad = looks_rad_[grid_.order()[slot]];
  float& look_radps = walkers_[slot].look_radps;
  const float wanted_radps = (walkers_[slot].look_to_rad - look_rad) / (tuning::kLook_s + step_s);
  const float most_radps = tuning::kLook_radps2 * step_s;
  look_radps += std::clamp(wanted_radps - look_radps, -most_radps, most_radps);
  look_rad = std::clamp(look_rad + step_s * look_radps, -Gait::kMostLook_rad, Gait::kMostLook_rad);
}

double Crowd::turn(size_t slot) {
  Eigen::Vector2d& smooth = walkers_[slot].smooth_mps;
  smooth += options_.step_s / (tuning::kTurnSmoothing_s + options_.step_s) *
            (walkers_[slot].velocity_mps - smooth);
  const double speed = smooth.norm(), now_square = walkers_[slot].velocity_mps.squaredNorm();
  if (speed >= tuning::kWalks_mps && now_square >= tuning::kWalks_mps * tuning::kWalks_mps)
    return turn_into_way(slot, smooth / speed);
  const double slower = std::min(speed, std::sqrt(now_square));
  const double walks = (slower - tuning::kStands_mps) / (tuning::kWalks_mps - tuning::kStands_mps);
  const Eigen::Vector2d& facing = walkers_[slot].facing;
  Eigen::Vector2d to = facing;
  if (walks > 0) to = facing.isZero() ? smooth : (1 - walks) * facing + (walks / speed) * smooth;
  return turn_on_spot(slot, std::max(walks, 0.0), to);
}

/// Somebody who walks faces where it goes.
double Crowd::turn_into_way(size_t slot, const Eigen::Vector2d& to) {
  const Eigen::Vector2d& from = walkers_[slot].heading;
  double& rate = walkers_[slot].turn_radps;
  const double left = from.x() * to.y() - from.y() * to.x(), ahead = from.dot(to);
  constexpr double kHardly = 0.99;  // a cosine: the sine is the angle, nearly
  const double off = ahead > kHardly ? left : arc_tan2(left, ahead);
  const double wanted =
      turn_to(off, tuning::kMaxTurn_radps, tuning::kTurnIntoWay_radps2, options_.step_s);
  const double at_once = off / options_.step_s;
  if (wanted != at_once || std::abs(wanted - rate) > tuning::kTurnIntoWay_radps2 * options_.step_s)
    return turn_on(slot, wanted, tuning::kTurnIntoWay_radps2);
  rate = wanted;
  headings_[grid_.order()[slot]] = walkers_[slot].heading = to;
  return std::abs(off);
}

/// Somebody who stands turns when it is worth it, and then all the way. In between, `walks` from 0
/// to 1, it does more and more as those who walk.
double Crowd::turn_on_spot(size_t slot, double walks, const Eigen::Vector2d& to) {
  const double rate = walkers_[slot].turn_radps;
  const Eigen::Vector2d& from = walkers_[slot].heading;
  const double most =
      tuning::kTurnOnSpot_radps + walks * (tuning::kMaxTurn_radps - tuning::kTurnOnSpot_radps);
  const double gently =
      tuning::kTurnStart_radps2 + walks * (tuning::kTurnIntoWay_radps2 - tuning::kTurnStart_radps2);
  double wanted = 0;
  if (!to.isZero()) {
    const double off = arc_tan2(from.x() * to.y() - from.y() * to.x(), from.dot(to));
    const double far = rate == 0 ? (1 - walks) * tuning::kTurnFrom_rad : tuning::kTurnDone_rad;
    if (std::abs(off) > far) wanted = turn_to(off, most, gently, options_.step_s);
  }
  return turn_on(slot, wanted, std::abs(rate) > most ? tuning::kTurnStop_radps2 : gently);
}

/// Turns on, at a rate that comes as near to the one wanted as it may.
double Crowd::turn_on(size_t slot, double wanted_radps, double most_radps2) {
  double& rate = walkers_[slot].turn_radps;
  const double change = most_radps2 * options_.step_s;
  rate += std::clamp(wanted_radps - rate, -change, change);
  if (rate == 0) return 0;
  const Eigen::Vector2d from = walkers_[slot].heading;
  const SinCos turned = sin_cos(rate * options_.step_s);
  headings_[grid_.order()[slot]] = walkers_[slot].heading =
      Eigen::Vector2d(turned.cos * from.x() - turned.sin * from.y(),
                      turned.sin * from.x() + turned.cos * from.y())
          .normalized();
  return std::abs(rate) * options_.step_s;
}

}  // namespace throng
