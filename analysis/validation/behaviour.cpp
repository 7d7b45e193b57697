#include "analysis/validation/behaviour.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "analysis/measures/contact_measures.h"
#include "analysis/measures/motion_measures.h"
#include "analysis/validation/setups.h"
#include "base/portable_math.h"
#include "crowd/dense_placement.h"
#include "scenes/file/density.h"
#include "scenes/retargeting/tracks.h"

namespace throng::validation {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kSample_s = 0.1;

/// Angle between two directions in turns, in (-0.5, 0.5].
double turn_between(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  return std::atan2(from.x() * to.y() - from.y() * to.x(), from.dot(to)) / (2 * kPi);
}

}  // namespace

Plan bundled_plan(const std::string& name, const Conditions& conditions) {
  Plan plan(name, {}, {}, conditions.seed);
  plan.scene = load_scene(name);
  plan.scene.seed = conditions.seed;
  plan.scene.steering.model = conditions.model;
  return plan;
}

SceneAccelerations accelerations_of(const std::string& where, const Plan& plan, double seconds,
                                    Outcome& outcome) {
  Trial trial(plan);
  RecentCrowd crowd(trial.size(), 3);
  Accelerations accelerations(kSample_s);
  PeriodTimer clock(kSample_s);
  do {
    if (!clock.is_due(trial.now_s())) continue;
    take(trial, crowd.next());
    crowd.pushed();
    accelerations.take(crowd);
  } while (trial.step(seconds));
  note(outcome, trial);
  const Histogram& all = accelerations.of_bodies();
  return {where, all.quantile(0.999), all.count()};
}

QueueTurning measure_queue(const std::string& where, const Plan& plan, const Rectangle& area,
                           double seconds, Outcome& outcome) {
  constexpr double kWaits_mps = 0.2;
  constexpr double kSetOut_s = 2;  // all people walk by then
  Trial trial(plan);
  std::vector<double> net(trial.size(), 0);
  QueueTurning out{where, 0, 0, 0};
  while (trial.step(seconds)) {
    if (trial.now_s() < kSetOut_s) continue;
    for (size_t id = 0; id < trial.size(); ++id) {
      if (!trial.is_present(id) || !area.contains(trial.position_m(id)) ||
          trial.velocity_mps(id).norm() >= kWaits_mps)
        continue;
      const double turn = turn_between(trial.previous_heading(id), trial.heading(id));
      net[id] += turn;
      out.all_turns += std::abs(turn);
      out.waited_s += trial.step_s();
    }
  }
  for (const double turns : net) out.net_turns += std::abs(turns);
  note(outcome, trial);
  return out;
}

std::vector<double> facing_shares(const Plan& plan, double seconds, Outcome& outcome) {
  constexpr double kWithin_turns = 20.0 / 360;
  Trial trial(plan);
  PeriodTimer clock(kSample_s);
  std::vector<double> shares;
  do {
    if (!clock.is_due(trial.now_s())) continue;
    int facing = 0, all = 0;
    for (size_t id = 0; id < trial.size(); ++id) {
      const std::optional<Eigen::Vector2d>& look_at_m =
          plan.scene.groups[trial.group(id)].look_at_m;
      if (!trial.is_present(id) || !look_at_m) continue;
      const Eigen::Vector2d direction = *look_at_m - trial.position_m(id);
      facing += std::abs(turn_between(trial.heading(id), direction)) <= kWithin_turns;
      ++all;
    }
    if (all > 0) shares.push_back(static_cast<double>(facing) / all);
  } while (trial.step(seconds));
  note(outcome, trial);
  return shares;
}

DenseStanding place_dense_crowd(double per_m2, const Conditions& conditions, Outcome& outcome) {
  const Rectangle area = {{-3, -3}, {3, 3}};
  Plan plan("standing", {{-10, -10}, {10, 14}}, {conditions.model}, conditions.seed);
  Group& group = plan.people(0, area, {{{-9, -9.5}, {9, -8}}});
  group.density_per_m2 = per_m2;
  group.look_at_m = Eigen::Vector2d(0, 13);
  group.premovement_s = fixed(100);
  group.count = static_cast<int>(count_by_density(plan.scene, group));
  const Trial trial(plan);
  note(outcome, trial);
  const RunInfo& info = trial.info();
  std::vector<StandingBody> bodies;
  for (size_t id = 0; id < trial.size(); ++id) {
    const double height_m = static_cast<double>(info.scale_of_avatar[id]) *
                            static_cast<double>(info.models[info.model_of_avatar[id]]->height_m);
    if (trial.is_present(id) && area.contains(trial.position_m(id)))
      bodies.push_back({trial.position_m(id), trial.heading(id), height_m / 1.70});
  }
  return {per_m2, static_cast<double>(bodies.size()) / area.area_m2(), max_overlap_m(bodies)};
}

namespace {

// Each encounter has a separate room, with walls 3 m from its paths, to limit its flow field.
constexpr double kApart_m = 24;
constexpr uint64_t kColumns = 5;
constexpr uint64_t kBatch = kColumns * kColumns;

/// Both people start where the encounter begins, and would pass its centre if neither avoided.
Scene steered(const std::vector<Encounter>& encounters, const Conditions& conditions) {
  const double half_m = 0.5 * kApart_m * static_cast<double>(kColumns);
  Plan plan("encounters", {{-half_m, -half_m}, {half_m, half_m}}, {conditions.model},
            conditions.seed);
  plan.scene.step_s = 1.0 / 60;
  plan.scene.exact = true;
  plan.scene.part_volume = Scene().part_volume;
  for (uint64_t i = 1; i < kColumns; ++i) {
    const double at_m = kApart_m * static_cast<double>(i) - half_m;
    plan.wall_along_x(-half_m, half_m, at_m, {}, 0);
    plan.wall_along_y(-half_m, half_m, at_m, {}, 0);
  }
  for (size_t i = 0; i < encounters.size(); ++i)
    for (size_t member = 0; member < 2; ++member) {
      const EncounterPerson& person = encounters[i].people()[member];
      const uint64_t column = i % kColumns, row = i / kColumns;
      const Eigen::Vector2d place(static_cast<double>(column) + 0.5,
                                  static_cast<double>(row) + 0.5);
      const Eigen::Vector2d middle = (kApart_m * place).array() - half_m;
      const SinCos turn = sin_cos(person.heading_rad);
      const Eigen::Vector2d from = middle + encounters[i].place_m(member, 0);
      const Eigen::Vector2d to = from + (person.speed_mps * (Encounter::kDuration_s + 1) + 1) *
                                            Eigen::Vector2d(turn.cos, turn.sin);
      const Eigen::Vector2d slack = Eigen::Vector2d::Constant(1e-4);
      const Eigen::Vector2d goal = Eigen::Vector2d::Constant(0.5);
      Group& one = plan.people(1, {from - slack, from + slack}, {{to - goal, to + goal}});
      one.speed_mps = fixed(person.speed_mps);
      one.height_m = fixed(person.height_m);
      one.gait_styles = StyleShares{};
      (*one.gait_styles)[static_cast<size_t>(person.style)] = 1;
    }
  return plan.scene;
}

}  // namespace

std::vector<EncounterOutcome> simulate_encounters(uint64_t count, const Conditions& conditions) {
  std::vector<EncounterOutcome> out;
  for (uint64_t first = 0; first < count; first += kBatch) {
    std::vector<Encounter> encounters;
    for (uint64_t i = first; i < std::min(count, first + kBatch); ++i)
      encounters.emplace_back(conditions.seed, i);
    SimulationOptions options;
    options.postures = false;
    Simulation simulation(steered(encounters, conditions), options);
    std::vector<EncounterOutcome> met(encounters.size());
    for (size_t i = 0; i < met.size(); ++i) met[i] = {encounters[i].kind(), 1e9, false};
    const auto frames = static_cast<int>(Encounter::kDuration_s / simulation.scene().step_s);
    for (int frame = 0; frame <= frames; ++frame) {
      const Frame& now = simulation.step();
      for (size_t i = 0; i < met.size(); ++i) {
        const Eigen::Vector3d apart = now.roots[2 * i].position_m - now.roots[2 * i + 1].position_m;
        met[i].nearest_m = std::min(met[i].nearest_m, apart.head<2>().norm());
      }
      for (const PairKey& pair : now.pairs)
        if (pair.b() < 2 * met.size()) met[pair.a() / 2].touched = true;
    }
    out.insert(out.end(), met.begin(), met.end());
  }
  return out;
}

std::vector<CountedContacts> contacts_of(const Plan& plan, double seconds) {
  Scene scene = plan.scene;
  scene.exact = true;
  // The step of retargeted recordings; longer steps miss short contacts.
  scene.step_s = std::min(scene.step_s, Scene().step_s);
  SimulationOptions options;
  options.postures = false;
  Simulation simulation(std::move(scene), options);
  // Recorded bodies anticipate new neighbours for this time, simulated ones do not. In a corridor
  // at 1 to 2 per m2, a quarter of the contacts were with people who had just appeared.
  ContactMeasures measures(simulation.info(), ContactMeasures::kGap_s, kExpected_s);
  const auto frames = static_cast<int64_t>(std::llround(seconds / simulation.scene().step_s));
  for (int64_t frame = 0; frame < frames; ++frame) measures.frame(simulation.step());
  measures.end();
  std::vector<CountedContacts> out;
  for (size_t i = 0; i < ContactMeasures::kLevels; ++i)
    out.push_back({measures.contacts_at()[i], measures.person_s_at()[i]});
  return out;
}

void add_social_groups(Plan& plan, int groups, const Rectangle& from,
                       const std::vector<Rectangle>& to) {
  for (int i = 0; i < groups; ++i) {
    const int size = 2 + i % 3;
    SocialGroupRule social_groups{1, {0, 0, 0}};
    social_groups.sizes[static_cast<size_t>(size - 2)] = 1;
    plan.people(size, from, to).social_groups = social_groups;
  }
}

Plan crossing_groups_plan(SteeringKind model, uint64_t seed) {
  Plan plan("crossing_groups", {{-20, -20}, {20, 20}}, {model}, seed);
  add_social_groups(plan, 27, {{-19.5, -5}, {-6, 5}}, {{{18, -5}, {20, 5}}});
  add_social_groups(plan, 27, {{-5, -19.5}, {5, -6}}, {{{-5, 18}, {5, 20}}});
  return plan;
}

Plan groups_at_a_door_plan(SteeringKind model, uint64_t seed) {
  Plan plan("groups_at_a_door", {{-10, -4}, {25, 4}}, {model}, seed);
  plan.wall_along_y(-4, 4, 0, {0}, 1);
  add_social_groups(plan, 15, {{-9, -3.5}, {-2, 3.5}}, {{{22, -3}, {24, 3}}});
  return plan;
}

Plan groups_with_two_exits_plan(SteeringKind model, uint64_t seed) {
  Plan plan("groups_with_two_exits", {{0, -3}, {30, 20}}, {model}, seed);
  plan.wall_along_x(0, 30, -0.1, {7.5, 22.5}, 1);
  add_social_groups(plan, 60, {{0, 0}, {15, 20}}, {{{0, -3}, {30, -2.2}}});
  return plan;
}

GroupCohesion measure_cohesion(const std::string& where, const Plan& plan, double seconds,
                               Outcome& outcome) {
  Trial trial(plan);
  constexpr double kReach_m = 3;
  GroupCohesion out{where, 0, 0};
  double next_s = 0;
  while (trial.step(seconds)) {
    if (trial.now_s() < next_s) continue;
    next_s += 0.1;
    // Members of a group have consecutive ids.
    for (size_t id = 0; id < trial.size(); ++id) {
      double nearest_m = INFINITY;
      for (size_t other = id < 3 ? 0 : id - 3; other < trial.size() && other < id + 4; ++other)
        if (other != id && trial.group(other) == trial.group(id) && trial.is_present(other))
          nearest_m = std::min(nearest_m, (trial.position_m(other) - trial.position_m(id)).norm());
      if (!trial.is_present(id) || std::isinf(nearest_m)) continue;
      ++out.moments;
      out.close += nearest_m < kReach_m;
    }
  }
  note(outcome, trial);
  return out;
}

GroupExits measure_group_exits(const Plan& plan, double seconds, Outcome& outcome) {
  Trial trial(plan);
  Gate near(Gate::Along::kY, -0.1, 0, 15, false);
  Gate far(Gate::Along::kY, -0.1, 15, 30, false);
  while (trial.step(seconds)) {
    near.watch(trial);
    far.watch(trial);
  }
  note(outcome, trial);
  std::vector<int> by_near_exit(plan.scene.groups.size(), 0), by_far_exit = by_near_exit;
  for (const Gate::Passage& passage : near.passages()) ++by_near_exit[trial.group(passage.id)];
  for (const Gate::Passage& passage : far.passages()) ++by_far_exit[trial.group(passage.id)];
  GroupExits out{static_cast<int>(plan.scene.groups.size()), 0,
                 static_cast<int>(trial.size() - near.passages().size() - far.passages().size())};
  for (size_t group = 0; group < by_near_exit.size(); ++group)
    out.by_one_exit += (by_near_exit[group] == 0) != (by_far_exit[group] == 0);
  return out;
}

}  // namespace throng::validation
