#include "crowd/social_groups.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "crowd/crowd_tuning.h"
#include "crowd/steering_state.h"

namespace throng {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

// Places. Members walk 0.75 to 0.8 m apart side by side, those in the middle a little behind. The
// denser the crowd, the farther behind (Moussaid et al. 2010, Zanlungo et al. 2014).
constexpr double kAbreast_m = 0.8;
constexpr double kBend_m = 0.12;      ///< how far the middle ones are behind in the open
constexpr double kBendMore_m2 = 0.5;  ///< increase per non-member and square metre
constexpr double kMaxBend_m = 0.3;    ///< upper bound
constexpr double kInFile_m = 0.9;
/// Lengths are for discs of this radius; wider ones keep more distance.
constexpr double kRadius_m = 0.22;
/// Lateral clearance: file at or below the first value, free formation from the second on. Groups
/// of four walk in two rows below the third and in one row above the fourth.
constexpr double kFile_m = 0.45, kBeside_m = 0.75, kTwoRows_m = 1.4, kLine_m = 1.9;
/// Non-members take part of that clearance from the first density on, and all of it at the second.
constexpr double kLoose_per_m2 = 0.3, kDense_per_m2 = 1.3;
/// Distance of a shoulder to walls.
constexpr double kShoulder_m = 0.3;
/// Paths bend around walls nearer than this.
constexpr double kBends_m = 1.6;
/// Look-ahead for lateral clearance, and its number of samples.
constexpr double kProbe_m = 0.75;
constexpr int kProbes = 4;

/// Members this close, with directions within 60 degrees (the cosine), walk side by side.
constexpr double kRow_m = 4;
constexpr double kSameDirection = 0.5;
/// With all members this close to the first, no member is behind.
constexpr double kTogether_m = 2.5;
/// Cosine: members whose path parts from that of the first member, within sight of it, follow it.
constexpr double kSplitCosine = 0.3;
constexpr double kSight_m = 6;
/// A line of sight is blocked by obstacles this close to it, tested at samples.
constexpr double kBody_m = 0.2;
constexpr int kSightSamples = 8;

/// Members walk side by side above this sum of velocities, with at least this gap between discs.
constexpr double kBeside_mps = 0.3;
constexpr double kBesideGap_m = 0.14;

// Taking a place: maximum tangent of the sideways direction, and the distance from which it applies
// (less with less clearance).
// Then the distance along the path at which the full speed factor applies, and the factor's bounds.
constexpr double kMaxSideways = 0.5, kAside_m = 0.8;
/// A member this far to the side of its place falls back by up to the last value.
constexpr double kAstray_m = 0.35, kFarAstray_m = 0.8, kFallBack_m = 0.9;
constexpr double kAlong_m = 1.5, kMinFactor = 0.7, kMaxFactor = 1.15;

// Waiting: a member this far ahead of its place slows down, and stands from the second value on.
// Members farther off are lost; those without progress for this time are not waited for.
constexpr double kMaxLead_m = 0.7, kStands_m = 2;
constexpr double kLost_m = 25;
constexpr double kPatience_s = 30;
constexpr double kProgress_m = 0.3;
/// Distance behind at which a member hurries.
constexpr double kBehind_m = 1;
/// In narrow passages and dense crowds no member blocks others: the least speed factor.
constexpr double kPassage_m = 1.4;
constexpr double kMinWaitingFactor = 0.6;

/// A waiting member steps aside from the line of the one it waits for. It stays on its side unless
/// it is closer than the second value.
constexpr double kStepAside_m = 0.9, kInLine_m = 0.15;

double smooth_step(double from, double to, double x) {
  const double share = tuning::ramp(from, to, x);
  return share * share * (3 - 2 * share);
}

Eigen::Vector2d left_of(const Eigen::Vector2d& direction) {
  return {-direction.y(), direction.x()};
}

/// Place in a row: ahead of its middle and to its left.
struct Place {
  double ahead_m = 0, left_m = 0;
};

/// Returns the place of a member: `ahead` of `count` are farther ahead, `left` are farther left,
/// within this lateral clearance.
Place place_of(size_t count, size_t ahead, size_t left, double abreast_m, double clearance_m,
               double bend_m) {
  const double last = static_cast<double>(count) - 1;
  const double in_file = 0.5 * last - static_cast<double>(ahead);
  const double in_line = 0.5 * last - static_cast<double>(left);
  const Place file{in_file * kInFile_m, 0};
  // In one row, as close as the clearance requires, and staggered to compensate.
  const double step_m = std::min(abreast_m, clearance_m / last);
  const double behind_m = std::max(
      count > 2 ? bend_m : 0.0, std::sqrt(std::max(0.0, abreast_m * abreast_m - step_m * step_m)));
  Place line{0, in_line * step_m};
  if (count == 2) {
    line.ahead_m = in_file * behind_m;
  } else {  // a V of three, a U of four
    const bool is_inner = left > 0 && left + 1 < count;
    const double inner = last - 1;
    line.ahead_m = behind_m * (is_inner ? -2 / (inner + 2) : inner / (inner + 2));
  }
  if (count == 4) {
    // Two rows: a member ahead of two others walks in the first row.
    const double side = left < 2 ? 0.5 : -0.5;
    const Place rows{ahead < 2 ? 0.5 * kInFile_m : -0.5 * kInFile_m,
                     side * std::min(abreast_m, clearance_m)};
    const double share = smooth_step(kTwoRows_m, kLine_m, clearance_m);
    line.ahead_m = rows.ahead_m + share * (line.ahead_m - rows.ahead_m);
    line.left_m = rows.left_m + share * (line.left_m - rows.left_m);
  }
  const double share = smooth_step(kFile_m, kBeside_m, clearance_m);
  return {file.ahead_m + share * (line.ahead_m - file.ahead_m), share * line.left_m};
}

}  // namespace

struct SocialGroups::Formation {
  uint32_t mask = UINT32_MAX;  ///< bit mask of the members
  std::array<const Member*, SocialGroupRule::kMaxMembers> members{};
  size_t count = 0;
  Eigen::Vector2d direction = Eigen::Vector2d::Zero();  ///< unit
  Eigen::Vector2d middle_m = Eigen::Vector2d::Zero();
  double abreast_m = 0, clearance_m = 0, bend_m = 0;  ///< see place_of()
};

SocialGroups::SocialGroups(const NavigationMap& map, std::span<const AgentSpec> people)
    : map_(map) {
  for (uint32_t id = 0; id < people.size();) {
    uint32_t end = id + 1;
    while (people[id].social_group != AgentSpec::kAlone && end < people.size() &&
           people[end].social_group == people[id].social_group)
      ++end;
    if (end - id > 1) social_groups_.push_back({id, end});
    id = end;
  }
  if (!any()) return;
  group_numbers_.assign(people.size(), 0);
  for (size_t i = 0; i < social_groups_.size(); ++i)
    for (uint32_t id = social_groups_[i].begin; id < social_groups_[i].end; ++id)
      group_numbers_[id] = static_cast<uint32_t>(i + 1);
  for (const AgentSpec& person : people) radii_m_.push_back(person.radius_m);
  others_per_m2_.assign(people.size(), 0);
  adjustments_.resize(people.size());
  visits_.assign(people.size(), UINT32_MAX);
  min_distances_m_.assign(people.size(), kFar);
  since_s_.assign(people.size(), 0);
}

void SocialGroups::archive(Archive& a) {
  if (!any()) return;
  a(visits_, min_distances_m_, since_s_);
  if (!a.is_reading()) return;
  // Negated to reject NaN as well.
  for (size_t id = 0; id < visits_.size(); ++id)
    if (!(min_distances_m_[id] >= 0) || !(since_s_[id] >= 0) || since_s_[id] == kFar)
      a.reject("progress of a member of a social group", "another value");
}

Eigen::Vector2d SocialGroups::group_direction(uint32_t id) const {
  const Adjustment& adjustment = adjustments_[id];
  if (adjustment.solo_direction.isZero()) return adjustment.solo_direction;
  const Eigen::Vector2d direction = adjustment.towards.isZero()
                                        ? adjustment.solo_direction + adjustment.sideways
                                        : adjustment.towards;
  const double length = direction.norm();
  return length > 0 ? Eigen::Vector2d(direction / length) : adjustment.solo_direction;
}

void SocialGroups::find_neighbours(SteeringState& state, std::span<const uint32_t> slots) {
  for (const uint32_t slot : slots) {
    const uint32_t id = state.id(slot);
    if (!has(id)) continue;
    others_per_m2_[id] = others_per_m2(state, slot);
    drop_group_members(state, slot);
  }
}

/// Within two metres of the path; weight decreases with distance.
double SocialGroups::others_per_m2(const SteeringState& state, size_t slot) const {
  constexpr double kReach_m = 2;
  const Eigen::Vector2d& intent = state.agents[slot].smoothed_preferred_mps;
  const double speed = intent.norm();
  double sum = 0;
  for (const uint32_t other : state.neighbours(slot)) {
    if (are_in_one_group(state.id(slot), state.id(other))) continue;
    const Eigen::Vector2d offset = state.agents[other].position_m - state.agents[slot].position_m;
    const double away_m = offset.norm();
    const double ahead_m = speed > 0 ? offset.dot(intent) / speed : 0;
    const double sideways = away_m > 0 ? 1 - ahead_m * ahead_m / (away_m * away_m) : 1;
    sum += 2 * sideways * std::max(0.0, 1 - away_m / kReach_m);
  }
  // Volume of a cone of that radius and height 1.
  return sum * 3 / (std::numbers::pi * kReach_m * kReach_m);
}

/// Members that walk side by side do not avoid each other. Members that are too close do.
void SocialGroups::drop_group_members(SteeringState& state, size_t slot) const {
  const auto walks_beside = [&](uint32_t other) {
    if (!are_in_one_group(state.id(slot), state.id(other))) return false;
    const Eigen::Vector2d offset = state.agents[other].position_m - state.agents[slot].position_m;
    const Eigen::Vector2d both_mps =
        state.agents[slot].velocity_mps + state.agents[other].velocity_mps;
    const double along = std::abs(offset.dot(both_mps)), square_m2 = offset.squaredNorm();
    const double gap_m = state.agents[slot].radius_m + state.agents[other].radius_m + kBesideGap_m;
    return both_mps.squaredNorm() > kBeside_mps * kBeside_mps && square_m2 > gap_m * gap_m &&
           2 * along * along < square_m2 * both_mps.squaredNorm();
  };
  uint32_t* near = state.decisions.neighbours.data() + SteeringState::kMaxNeighbours * slot;
  uint8_t& count = state.decisions.neighbour_counts[slot];
  count = static_cast<uint8_t>(std::remove_if(near, near + count, walks_beside) - near);
}

void SocialGroups::update(uint32_t remainder, uint32_t parts, const Journeys& journeys,
                          std::span<const Eigen::Vector2d> positions_m, double now_s,
                          Workers& workers) {
  constexpr size_t kBlockSize = 32;
  const size_t blocks = (social_groups_.size() + kBlockSize - 1) / kBlockSize;
  workers.for_blocks(static_cast<int>(blocks), [&](int block, int) {
    const size_t begin = static_cast<size_t>(block) * kBlockSize;
    const size_t end = std::min(begin + kBlockSize, social_groups_.size());
    const auto is_due = [&](const SocialGroup& social_group) {
      return social_group.begin % parts == remainder;
    };
    // Prefetches the fields that member() reads.
    for (size_t i = begin; i < end; ++i)
      for (uint32_t id = social_groups_[i].begin;
           is_due(social_groups_[i]) && id < social_groups_[i].end; ++id)
        journeys.prefetch(id, positions_m[id]);
    for (size_t i = begin; i < end; ++i)
      if (is_due(social_groups_[i])) update(social_groups_[i], journeys, positions_m, now_s);
  });
}

void SocialGroups::update(const SocialGroup& social_group, const Journeys& journeys,
                          std::span<const Eigen::Vector2d> positions_m, double now_s) {
  std::array<Member, SocialGroupRule::kMaxMembers> all;
  size_t count = 0;
  bool are_near = true;
  for (uint32_t id = social_group.begin; id < social_group.end; ++id) {
    adjustments_[id] = {};
    const JourneyState state = journeys.state(id);
    if (state != JourneyState::kWalking && state != JourneyState::kWaiting) continue;
    all[count] = member(id, journeys, positions_m[id]);
    adjustments_[id].solo_direction = all[count].direction;
    const Member &m = all[count++], &first = all[0];
    are_near &= m.is_on_path && m.visits == first.visits &&
                (m.at_m - first.at_m).squaredNorm() < kTogether_m * kTogether_m;
  }
  // A near member is awaited regardless of its progress.
  for (size_t i = 0; i < count; ++i) {
    if (are_near)
      visits_[all[i].id] = UINT32_MAX;
    else
      watch_progress(all[i], journeys.state(all[i].id) == JourneyState::kWaiting, now_s);
  }
  const std::span<const Member> members(all.data(), count);
  Formation formation;
  for (size_t index = 0; index < count && count > 1; ++index) {
    const Member& m = members[index];
    if (m.direction.isZero()) continue;
    Adjustment& adjustment = adjustments_[m.id];
    find_formation(members, index, formation);
    const double length_m = formation.count > 1 ? keep_in_formation(formation, m, adjustment) : 0;
    wait_for_others(members, index, formation, length_m, adjustment);
  }
}

SocialGroups::Member SocialGroups::member(uint32_t id, const Journeys& journeys,
                                          const Eigen::Vector2d& at_m) const {
  const Stop& stop = journeys.stop(id);
  Member m{.id = id, .visits = journeys.visits(id), .at_m = at_m, .field = &journeys.field(id)};
  m.direction = journeys.direction(id, at_m);
  m.is_on_path = journeys.state(id) == JourneyState::kWalking && !stop.contains(at_m) &&
                 !journeys.is_at_goal(id, at_m);
  return m;
}

void SocialGroups::watch_progress(Member& m, bool waits, double now_s) {
  m.to_go_m = m.field->distance_m(m.at_m);
  // Waiting at a goal, or to set out, ends by itself.
  if (waits || m.visits != visits_[m.id] || m.to_go_m < min_distances_m_[m.id] - kProgress_m) {
    visits_[m.id] = m.visits;
    min_distances_m_[m.id] = m.to_go_m;
    since_s_[m.id] = now_s;
  }
  m.is_awaited = now_s - since_s_[m.id] < kPatience_s;
}

/// Finds the members next to which a member walks. All members of a row find the same ones:
/// `formation` then already has the result.
void SocialGroups::find_formation(std::span<const Member> members, size_t index,
                                  Formation& formation) const {
  const Member& self = members[index];
  uint32_t mask = 0;
  for (size_t i = 0; i < members.size() && self.is_on_path; ++i) {
    const Member& m = members[i];
    if (m.is_on_path && m.visits == self.visits &&
        m.direction.dot(self.direction) >= kSameDirection &&
        (m.at_m - self.at_m).squaredNorm() <= kRow_m * kRow_m)
      mask |= 1u << i;
  }
  if (mask == formation.mask) return;
  formation = {};
  formation.mask = mask;
  double others_per_m2 = 0, radius_m = 0;
  for (size_t i = 0; i < members.size(); ++i) {
    if ((mask >> i & 1) == 0) continue;
    formation.members[formation.count++] = &members[i];
    formation.direction += members[i].direction;
    formation.middle_m += members[i].at_m;
    others_per_m2 += others_per_m2_[members[i].id];
    radius_m += radii_m_[members[i].id];
  }
  if (formation.count < 2) return;
  const auto count = static_cast<double>(formation.count);
  formation.direction.normalize();
  formation.middle_m /= count;
  others_per_m2 /= count;
  formation.abreast_m = kAbreast_m + 2 * (radius_m / count - kRadius_m);
  formation.clearance_m =
      lateral_clearance_m(formation, *self.field, (count - 1) * formation.abreast_m) *
      (1 - smooth_step(kLoose_per_m2, kDense_per_m2, others_per_m2));
  formation.bend_m = kBend_m + std::min(kBendMore_m2 * others_per_m2, kMaxBend_m);
}

/// Lateral clearance of bodies along the path, from the middle of a row on.
double SocialGroups::lateral_clearance_m(const Formation& formation, const FlowField& field,
                                         double target_m) const {
  const Walkable& walkable = map_.walkable();
  const auto free_distance_m = [&](const Eigen::Vector2d& from_m, const Eigen::Vector2d& to) {
    double distance_m = 0;
    constexpr int kMaxSteps = 8;
    for (int i = 0; i < kMaxSteps && distance_m < target_m; ++i) {
      const double step_m = walkable.clearance_m(from_m + distance_m * to) - kShoulder_m;
      if (step_m < 0.02) break;
      distance_m += step_m;
    }
    return distance_m;
  };
  double min_m = target_m;
  Eigen::Vector2d at_m = formation.middle_m, direction = formation.direction;
  double clear_m = 0;
  for (int i = 0; i < kProbes; ++i, clear_m -= kProbe_m) {
    // Far from walls there is clearance on both sides.
    if (clear_m < kShoulder_m + 0.5 * target_m) clear_m = walkable.clearance_m(at_m);
    if (clear_m < kShoulder_m + 0.5 * target_m) {
      const Eigen::Vector2d left = left_of(direction);
      min_m = std::min(min_m, free_distance_m(at_m, left) + free_distance_m(at_m, -left));
    }
    at_m += kProbe_m * direction;
    if (clear_m > kBends_m) continue;
    const Eigen::Vector2d next = field.direction(at_m);
    if (!next.isZero()) direction = next;
  }
  return min_m;
}

/// Returns how far the last of the row should be behind.
double SocialGroups::keep_in_formation(const Formation& formation, const Member& self,
                                       Adjustment& adjustment) const {
  const Eigen::Vector2d left = left_of(formation.direction);
  const auto place_now = [&](const Member& m) {
    return Place{(m.at_m - formation.middle_m).dot(formation.direction),
                 (m.at_m - formation.middle_m).dot(left)};
  };
  const Place now = place_now(self);
  size_t ahead = 0, to_left = 0;
  for (size_t i = 0; i < formation.count; ++i) {
    const Member& m = *formation.members[i];
    const Place other = place_now(m);
    ahead += other.ahead_m > now.ahead_m || (other.ahead_m == now.ahead_m && m.id < self.id);
    to_left += other.left_m > now.left_m || (other.left_m == now.left_m && m.id < self.id);
  }
  const auto place = [&](size_t before, size_t farther_left) {
    return place_of(formation.count, before, farther_left, formation.abreast_m,
                    formation.clearance_m, formation.bend_m);
  };
  const Place target = place(ahead, to_left);
  const double aside_m = target.left_m - now.left_m;
  double along_m = target.ahead_m - now.ahead_m;
  // Members do not walk through those in between: except for the first, they come from behind.
  if (ahead > 0) along_m -= kFallBack_m * smooth_step(kAstray_m, kFarAstray_m, std::abs(aside_m));
  const double full_shift_m = std::clamp(formation.clearance_m, kFile_m, kAside_m);
  const double sideways = std::clamp(aside_m / full_shift_m, -1.0, 1.0);
  const double clearance_m =
      map_.walkable().clearance_m(self.at_m + std::copysign(kShoulder_m, sideways) * left);
  const double free = std::clamp((clearance_m - 0.1) / 0.2, 0.0, 1.0);
  adjustment.sideways = kMaxSideways * sideways * free * left;
  adjustment.speed_factor = std::clamp(1 + along_m / kAlong_m, kMinFactor, kMaxFactor);
  double length_m = 0;
  for (size_t i = 0; i < formation.count; ++i)
    length_m = std::max(length_m, target.ahead_m - place(i, i).ahead_m);
  return length_m;
}

void SocialGroups::wait_for_others(std::span<const Member> members, size_t index,
                                   const Formation& formation, double length_m,
                                   Adjustment& adjustment) const {
  const Member& self = members[index];
  const Member* last = nullptr;
  double behind_m = 0, ahead_m = 0;
  for (const Member& m : members) {
    if (m.id == self.id) continue;
    const double away_m = (m.at_m - self.at_m).norm();
    // Distance by which the other member is behind.
    double lag_m = m.to_go_m - self.to_go_m;
    if (m.visits != self.visits)
      lag_m = m.visits < self.visits ? away_m : -away_m;
    else if (m.is_on_path && self.is_on_path && away_m < kRow_m &&
             m.direction.dot(self.direction) > kSameDirection)
      lag_m = (self.at_m - m.at_m).dot(formation.direction);  // both are in the row
    else if (!self.is_on_path || !(std::abs(lag_m) < kFar))
      lag_m = 0;  // at the goal already, or at a wall, in no cell of the field
    if (std::abs(lag_m) > kLost_m) continue;
    ahead_m = std::max(ahead_m, -lag_m);
    if (!m.is_awaited || lag_m <= behind_m) continue;
    behind_m = lag_m;
    last = &m;
  }
  if (ahead_m > kBehind_m && behind_m < kBehind_m)
    adjustment.speed_factor = std::max(adjustment.speed_factor, kMaxFactor);
  const Member& first = members.front();
  if (first.id != self.id && first.is_on_path && self.is_on_path && first.visits == self.visits &&
      first.direction.dot(self.direction) < kSplitCosine &&
      (first.at_m - self.at_m).squaredNorm() < kSight_m * kSight_m &&
      map_.walkable().is_clear_between(self.at_m, first.at_m, kBody_m, kSightSamples))
    adjustment.towards = (first.at_m - self.at_m).normalized();
  if (last == nullptr) return;
  const double too_far_m = behind_m - length_m - kMaxLead_m;
  double speed_factor = 1 - std::clamp(too_far_m / kStands_m, 0.0, 1.0);
  if (speed_factor == 1) return;
  double min_factor =
      kMinWaitingFactor * smooth_step(kLoose_per_m2, kDense_per_m2, others_per_m2_[self.id]);
  if (map_.walkable().gap_at(self.at_m, kPassage_m).width_m < kPassage_m)
    min_factor = kMinWaitingFactor;
  speed_factor = std::max(speed_factor, min_factor);
  adjustment.speed_factor = std::min(adjustment.speed_factor, speed_factor);
  adjustment.behind_m = last->at_m;
  // Steps aside for agents that come between.
  const Eigen::Vector2d left = left_of(self.direction);
  const double off_m = (self.at_m - last->at_m).dot(left);
  const auto clearance_m = [&](double side) {
    return map_.walkable().clearance_m(self.at_m + side * kStepAside_m * left);
  };
  double side = off_m > 0 ? 1 : -1;
  if (std::abs(off_m) < kInLine_m) side = clearance_m(1) > clearance_m(-1) ? 1 : -1;
  const double deficit = std::clamp(1 - std::abs(off_m) / kStepAside_m, 0.0, 1.0);
  if (clearance_m(side) > kShoulder_m)
    adjustment.sideways +=
        kMaxSideways * deficit * std::min(1.0, 2 * (1 - speed_factor)) * side * left;
}

}  // namespace throng
