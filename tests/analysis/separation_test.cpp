// Separation of robots and people: hand-made cases, an oracle over all pairs of all frames, and
// invalid input.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "analysis/separation/separation_sink.h"
#include "base/random.h"
#include "scenes/run/runner.h"
#include "scenes/run/simulation.h"
#include "scenes/run/sink.h"
#include "scenes/separation/separation_rule.h"
#include "tests/scenes/scene_file.h"

namespace throng::separation_test {
namespace {

using testing::HasSubstr;

TEST(BodyRegions, CoverAllPartsOfTheBundledPerson) {
  std::map<BodyRegion, int> parts;
  const std::shared_ptr<const Model> adult = load_model(adult_urdf());
  for (const Part& part : adult->parts) {
    EXPECT_NE(body_region(part.name), BodyRegion::kOther) << part.name;
    ++parts[body_region(part.name)];
  }
  const std::map<BodyRegion, int> expected = {
      {BodyRegion::kHead, 1},      {BodyRegion::kTrunk, 2}, {BodyRegion::kUpperArms, 2},
      {BodyRegion::kLowerArms, 2}, {BodyRegion::kHands, 2}, {BodyRegion::kLegs, 4},
      {BodyRegion::kFeet, 2}};
  EXPECT_EQ(parts, expected);
}

TEST(BodyRegions, FollowFromTheNameOfAPart) {
  EXPECT_EQ(body_region("Neck_1"), BodyRegion::kNeck);
  EXPECT_EQ(body_region("left_forearm"), BodyRegion::kLowerArms);
  EXPECT_EQ(body_region("RIGHT_TOE"), BodyRegion::kFeet);
  EXPECT_EQ(body_region("arm"), BodyRegion::kOther) << "ambiguous: upper or lower";
  EXPECT_EQ(body_region("head_and_neck"), BodyRegion::kOther) << "ambiguous: two regions";
  EXPECT_EQ(body_region(""), BodyRegion::kOther);
}

double uniform(uint64_t seed, uint32_t index, double low, double high) {
  return random_uniform({seed, 0, 0, Purpose::kBoxWorld}, low, high, index);
}

/// Distance covered by both in small steps until the robot stops.
double walked_m(const SeparationRule& rule, double human_speed_mps, double robot_speed_mps) {
  const double stops_s =
      rule.stopping_s ? *rule.stopping_s : robot_speed_mps / *rule.deceleration_mps2;
  const int steps = 20000;
  double sum_m = rule.intrusion_m + rule.human_uncertainty_m + rule.robot_uncertainty_m;
  const double step_s = (rule.reaction_s + stops_s) / steps;
  for (int i = 0; i < steps; ++i) {
    const double now_s = (i + 0.5) * step_s;
    const double braking_s = std::max(0.0, now_s - rule.reaction_s);
    sum_m +=
        step_s * (human_speed_mps + robot_speed_mps * (stops_s > 0 ? 1 - braking_s / stops_s : 1));
  }
  return sum_m;
}

TEST(ProtectiveDistance, IsTheDistanceCoveredUntilTheRobotStops) {
  for (uint64_t seed = 0; seed < 200; ++seed) {
    SeparationRule rule;
    rule.reaction_s = uniform(seed, 0, 0.01, 1);
    if (seed % 2 == 0)
      rule.stopping_s = uniform(seed, 1, 0.01, 2);
    else
      rule.deceleration_mps2 = uniform(seed, 1, 0.2, 10);
    rule.intrusion_m = uniform(seed, 2, 0, 0.5);
    rule.human_uncertainty_m = uniform(seed, 3, 0, 0.2);
    rule.robot_uncertainty_m = uniform(seed, 4, 0, 0.2);
    const double human = uniform(seed, 5, -2, 2), robot = uniform(seed, 6, -2, 2);
    const double expected = walked_m(rule, std::max(0.0, human), std::max(0.0, robot));
    EXPECT_NEAR(protective_distance(rule, human, robot).total_m(), expected, 1e-3 * expected)
        << "seed " << seed;
  }
  SeparationRule rule;
  rule.stopping_s = 0.1;
  EXPECT_TRUE(std::isnan(protective_distance(rule, NAN, 1).total_m()));
  EXPECT_TRUE(std::isnan(protective_distance(rule, 1, NAN).total_m()));
}

/// Two robots among people, with the given separation.
std::string scene_text(const std::string& separation,
                       const std::string& more = "proximity_m: 0.6\n") {
  return fmt::format(
      "step_s: 1/20\nduration_s: 2\nculling: {{exact: {}}}\n"
      "ground: {{min_m: [-5, -4], max_m: [5, 4]}}\n"
      "groups:\n"
      "  - {{name: picker, model: {}/examples/picker.urdf, count: 2, height_m: 1.3, "
      "desired_speed_mps: "
      "0.8, "
      "radius_m: 0.4, spawn: {{min_m: [-4, -3], max_m: [4, 3]}}, goals: [{{min_m: [-4, -3], max_m: "
      "[-2, 3]}}, {{min_m: [2, -3], max_m: [4, 3]}}]}}\n"
      "  - {{name: people, count: 8, spawn: {{min_m: [-4, -3], max_m: [4, 3]}}, goals: [{{min_m: "
      "[2, -3], max_m: [4, 3]}}, {{min_m: [-4, -3], max_m: [-2, 3]}}]}}\n"
      "{}separation: {}\n",
      separation.find("human_speed_mps: ") == std::string::npos, THRONG_SOURCE_DIR, more,
      separation);
}

constexpr const char* kNamed =
    "{human_speed_mps: 1, robot_speed_mps: 0.8, reaction_s: 0.1, stopping_s: 0.2, intrusion_m: "
    "0.05}";
constexpr const char* kMeasured =
    "{reaction_s: 0.2, deceleration_mps2: 2, intrusion_m: 0.05, human_uncertainty_m: 0.03, "
    "robot_uncertainty_m: 0.02}";

using Triple = std::tuple<uint32_t, uint32_t, BodyRegion>;

/// A pair of parts within the margin of a robot and a person.
struct ObservedPair {
  ProximityPair proximity;
  uint32_t person;
  float required_m;  ///< NaN without a speed
};
/// Pairs of one frame by robot and region.
struct Observation {
  std::map<std::pair<uint32_t, BodyRegion>, std::vector<ObservedPair>> pairs;
  std::map<Triple, bool> is_short, is_unknown;
};

class Oracle {
 public:
  Oracle(const RunInfo& run, const SeparationRule& rule) : run_(run), rule_(rule) {}

  Observation look(const Frame& frame) {
    Observation observed;
    std::map<uint32_t, std::vector<Eigen::Isometry3d>> now;
    for (uint32_t id = 0; id < run_.model_of_avatar.size(); ++id)
      if (!model(id).is_person) now[id] = poses(frame, id);
    for (const ProximityPair& pair : frame.proximity_pairs)
      for (const bool robot_is_a : {true, false}) {
        const uint32_t robot = robot_is_a ? pair.pair.a() : pair.pair.b();
        const uint32_t person = robot_is_a ? pair.pair.b() : pair.pair.a();
        const auto avatars = run_.model_of_avatar.size();
        if (robot >= avatars || person >= avatars || model(robot).is_person ||
            !model(person).is_person)
          continue;
        const uint32_t part = robot_is_a ? pair.pair.part_b() : pair.pair.part_a();
        const BodyRegion region = body_region(model(person).parts[part].name);
        double robot_speed_mps = NAN;
        const uint32_t own = robot_is_a ? pair.pair.part_a() : pair.pair.part_b();
        if (previous_.contains(robot)) {
          const Eigen::Vector3d at((robot_is_a ? pair.point_a_m : pair.point_b_m).data());
          const Eigen::Vector3d previous = previous_[robot][own] * (now[robot][own].inverse() * at);
          Eigen::Vector3d normal(pair.normal[0], pair.normal[1], pair.normal[2]);
          if (!robot_is_a) normal = -normal;
          robot_speed_mps = (at - previous).dot(normal) / run_.step_s;
        }
        const double human_speed_mps = rule_.human_speed_mps.value_or(
            static_cast<double>(pair.closing_speed_mps) - robot_speed_mps);
        robot_speed_mps = rule_.robot_speed_mps.value_or(robot_speed_mps);
        const double required =
            protective_distance(rule_, human_speed_mps, robot_speed_mps).total_m();
        observed.pairs[{robot, region}].push_back({pair, person, static_cast<float>(required)});
        const Triple triple{robot, person, region};
        observed.is_short[triple] |= static_cast<double>(pair.lo_m) < required;
        observed.is_unknown[triple] |= std::isnan(required);
      }
    previous_ = now;
    return observed;
  }

 private:
  const Model& model(uint32_t id) const { return *run_.models[run_.model_of_avatar[id]]; }
  std::vector<Eigen::Isometry3d> poses(const Frame& frame, uint32_t id) const {
    std::vector<PartPose> parts(static_cast<size_t>(model(id).part_count()));
    part_poses(run_, frame, id, parts);
    std::vector<Eigen::Isometry3d> out;
    for (const PartPose& part : parts)
      out.push_back(Eigen::Translation3d(frame.roots[id].position_m) * to_isometry(part));
    return out;
  }

  const RunInfo& run_;
  SeparationRule rule_;
  std::map<uint32_t, std::vector<Eigen::Isometry3d>> previous_;
};

class Separation : public SceneFile {
 protected:
  static constexpr int kFrames = 40;
  /// Compares a run with the oracle; returns the number of shortfalls.
  size_t compare(const std::string& separation, uint64_t seed) {
    Scene scene = load(scene_text(separation) + fmt::format("seed: {}\n", seed));
    const SeparationRule rule = *scene.separation;
    Simulation simulation(std::move(scene), {});
    const RunInfo& run = simulation.info();
    SeparationMonitor monitor(run);
    Oracle oracle(run, rule);
    std::map<Triple, int64_t> open;
    size_t begun = 0;
    for (int i = 0; i < kFrames; ++i) {
      SCOPED_TRACE(fmt::format("seed {}, frame {}", seed, i));
      const Frame& frame = simulation.step();
      const Observation observed = oracle.look(frame);
      monitor.frame(run, frame);
      compare_rows(monitor, observed);
      begun += compare_shortfalls(monitor, observed, i, open);
      if (HasFailure()) return begun;
    }
    monitor.end();
    std::set<Triple> ended;
    for (const Shortfall& each : monitor.ended()) {
      EXPECT_TRUE(each.is_truncated);
      EXPECT_EQ(each.end_frame, kFrames);
      ended.insert({each.robot, each.person, each.region});
    }
    EXPECT_EQ(ended.size(), open.size());
    EXPECT_EQ(begun, monitor.totals().shortfalls);
    return begun;
  }

 private:
  static void compare_rows(const SeparationMonitor& monitor, const Observation& observed) {
    ASSERT_EQ(monitor.rows().size(), 2u * 7) << "two robots, seven regions (no neck)";
    for (const RegionSeparation& row : monitor.rows()) {
      const auto found = observed.pairs.find({row.robot, row.region});
      if (found == observed.pairs.end()) {
        ASSERT_TRUE(row.is_far());
        ASSERT_EQ(row.lo_m, 0.6f);
        ASSERT_EQ(row.people_too_close, 0u);
        continue;
      }
      const auto key = [](const ObservedPair& p) {
        return std::tuple(p.proximity.lo_m, p.proximity.hi_m, p.proximity.pair);
      };
      const ObservedPair& nearest = *std::min_element(
          found->second.begin(), found->second.end(),
          [&](const ObservedPair& p, const ObservedPair& q) { return key(p) < key(q); });
      ASSERT_EQ(row.pair, nearest.proximity.pair);
      ASSERT_EQ(row.lo_m, nearest.proximity.lo_m);
      ASSERT_EQ(row.hi_m, nearest.proximity.hi_m);
      expect_same(row.required_m, nearest.required_m);
      float min_slack_m = NAN;
      std::set<uint32_t> people;
      for (const ObservedPair& pair : found->second) {
        const float slack_m = pair.proximity.lo_m - pair.required_m;
        if (!std::isnan(slack_m))
          min_slack_m = std::isnan(min_slack_m) ? slack_m : std::min(min_slack_m, slack_m);
        if (slack_m < 0) people.insert(pair.person);
      }
      expect_same(row.min_slack_m, min_slack_m);
      ASSERT_EQ(row.people_too_close, people.size());
    }
  }
  /// Tolerates the rounding of poses as matrices.
  static void expect_same(float found, float expected) {
    if (std::isnan(expected))
      ASSERT_TRUE(std::isnan(found));
    else
      ASSERT_NEAR(found, expected, 1e-5);
  }
  static size_t compare_shortfalls(const SeparationMonitor& monitor, const Observation& observed,
                                   int frame, std::map<Triple, int64_t>& open) {
    std::set<Triple> begins, ends;
    for (const auto& [triple, is_short] : observed.is_short)
      if (is_short && !open.contains(triple)) begins.insert(triple);
    for (const auto& [triple, since] : open) {
      const auto is_short = observed.is_short.find(triple);
      const auto is_unknown = observed.is_unknown.find(triple);
      const bool goes_on =
          is_short != observed.is_short.end() && (is_short->second || is_unknown->second);
      if (!goes_on) ends.insert(triple);
    }
    std::set<Triple> begun, ended;
    for (const Shortfall& each : monitor.begun()) {
      begun.insert({each.robot, each.person, each.region});
      EXPECT_EQ(each.begin_frame, frame);
    }
    for (const Shortfall& each : monitor.ended()) {
      const Triple triple{each.robot, each.person, each.region};
      ended.insert(triple);
      EXPECT_EQ(each.begin_frame, open[triple]);
      EXPECT_EQ(each.end_frame, frame);
      EXPECT_GT(each.max_shortfall_m, 0);
    }
    EXPECT_EQ(begun, begins);
    EXPECT_EQ(ended, ends);
    for (const Triple& triple : ended) open.erase(triple);
    for (const Triple& triple : begun) open[triple] = frame;
    return begun.size();
  }
};

TEST_F(Separation, MatchesTheOracleForConfiguredSpeeds) {
  size_t begun = 0;
  for (uint64_t seed = 1; seed <= 20 && !HasFailure(); ++seed) begun += compare(kNamed, seed);
  EXPECT_GT(begun, 100u);
}

TEST_F(Separation, MatchesTheOracleForMeasuredSpeeds) {
  size_t begun = 0;
  for (uint64_t seed = 1; seed <= 4 && !HasFailure(); ++seed) begun += compare(kMeasured, seed);
  EXPECT_GT(begun, 10u);
}

/// An arm of 0.6 m that turns towards a person who stands still.
TEST_F(Separation, MeasuresTheSpeedOfTheArmNotOfTheBase) {
  Scene scene =
      load(fmt::format("step_s: 1/100\nduration_s: 1\nculling: {{exact: true}}\nproximity_m: 1\n"
                       "ground: {{min_m: [-5, -4], max_m: [5, 4]}}\n"
                       "groups:\n"
                       "  - {{name: picker, model: {}/examples/picker.urdf, control_channel: PICK, "
                       "count: 1, spawn: {{min_m: "
                       "[-0.1, -0.1], max_m: [0.1, 0.1]}}}}\n"
                       "  - {{name: person, control_channel: STAND, count: 1, spawn: {{min_m: "
                       "[0.4, 0.8], max_m: [0.6, "
                       "1]}}}}\nseparation: {{reaction_s: 0.1, stopping_s: 0.1}}\n",
                       THRONG_SOURCE_DIR));
  Simulation simulation(std::move(scene), {});
  SeparationMonitor monitor(simulation.info());
  constexpr double kTurn_radps = 0.5;
  int checked = 0;
  for (int i = 0; i < 40; ++i) {
    const double joints[] = {kTurn_radps * i / 100, 0};
    ExternalPose pose;
    pose.joints = joints;
    ASSERT_EQ(simulation.set_pose(0, pose), 0);
    const Frame& frame = simulation.step();
    monitor.frame(simulation.info(), frame);
    if (i < 2) continue;
    for (const RegionSeparation& row : monitor.rows()) {
      if (row.is_far() || row.pair.part_a() != 2) continue;
      for (const ProximityPair& pair : frame.proximity_pairs) {
        if (pair.pair != row.pair) continue;
        const Eigen::Vector3d at(pair.point_a_m.data());
        const Eigen::Vector3d speed =
            kTurn_radps * Eigen::Vector3d::UnitZ().cross(at - frame.roots[0].position_m);
        const Eigen::Vector3d normal(pair.normal[0], pair.normal[1], pair.normal[2]);
        EXPECT_NEAR(row.robot_speed_mps, speed.dot(normal), 2e-3);
        EXPECT_NEAR(row.human_speed_mps, 0, 2e-3);
        ++checked;
      }
    }
  }
  EXPECT_GT(checked, 20);
}

TEST_F(Separation, IsRejectedIfItCannotBeJudged) {
  const auto rejection = [&](const std::string& text) {
    try {
      Simulation simulation(load(text), {});
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_EQ(rejection(scene_text(kNamed)), "accepted");
  EXPECT_THAT(rejection(scene_text(kNamed, "")), HasSubstr("s.yaml:8: expected 'proximity_m'"));
  EXPECT_THAT(rejection(scene_text(kNamed, "proximity_m: 0.3\n")),
              HasSubstr("of at least 0.51, the distance that 'separation' requires, found 0.3"));
  EXPECT_THAT(rejection(scene_text(kMeasured, "proximity_m: 0.05\n")),
              HasSubstr("of at least 0.1, the distance that 'separation' requires at least"));
  std::string coarse = scene_text(kMeasured);
  coarse.replace(coarse.find("exact: true"), 11, "exact: false");
  EXPECT_THAT(rejection(coarse), HasSubstr("--exact"));
}

TEST_F(Separation, ReportsInvalidKeys) {
  EXPECT_THAT(complaint(scene_text("{reaction_s: 0.1}")),
              HasSubstr("expected one of 'stopping_s' and 'deceleration_mps2', found neither"));
  EXPECT_THAT(complaint(scene_text("{reaction_s: 0.1, stopping_s: 1, deceleration_mps2: 1}")),
              HasSubstr("found both"));
  EXPECT_THAT(complaint(scene_text("{stopping_s: 0.1}")), HasSubstr("reaction_s"));
  EXPECT_THAT(complaint(scene_text("{reaction_s: 0.1, stopping_s: 1, human_speed_mps: -1}")),
              HasSubstr("human_speed_mps"));
  EXPECT_THAT(complaint(kGround + "groups: [{count: 1, spawn: {min_m: [1, 1], max_m: [9, 9]}, "
                                  "goals: [{min_m: [1, 1], max_m: [9, 9]}]}]\n"
                                  "separation: {reaction_s: 0.1, stopping_s: 1}\n"),
              HasSubstr("found people alone"));
}

TEST_F(Separation, NotesTheSpeedThatTheMarginCovers) {
  EXPECT_TRUE(separation_notes(load(scene_text(kNamed))).empty());
  // 0.972 = (0.6 - 0.5 * (0.2 + 0.5 * 0.25)) / (0.2 + 0.25).
  const auto notes = separation_notes(
      load(scene_text("{robot_speed_mps: 0.5, reaction_s: 0.2, deceleration_mps2: 2}")));
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_THAT(notes[0], HasSubstr("at up to 0.972 m/s"));
  EXPECT_THAT(separation_notes(load(scene_text(kMeasured))), testing::SizeIs(1));
}

TEST_F(Separation, ChangesTheContentHashButNotTheEvents) {
  const Scene with = load(scene_text(kNamed));
  std::string text = scene_text(kNamed);
  const Scene without = load(text.substr(0, text.find("separation")));
  EXPECT_NE(with.content_hash, without.content_hash);
  Simulation a(with, {}), b(without, {});
  EXPECT_EQ(run(a, {}).hash, run(b, {}).hash);
}

TEST_F(Separation, WritesTheRowsOfTheMonitor) {
  Simulation simulation(load(scene_text(kMeasured)), {});
  SeparationSink sink(folder_ / "out", *simulation.scene().separation);
  Sink* const sinks[] = {&sink};
  const RunSummary summary = run(simulation, sinks);
  const auto lines_of = [&](const char* name) {
    std::ifstream in(folder_ / "out" / name);
    std::vector<std::string> lines;
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    return lines;
  };
  const auto rows = lines_of("separation.csv"), shortfalls = lines_of("shortfalls.csv");
  EXPECT_EQ(static_cast<int64_t>(rows.size()), 1 + summary.frames * 2 * 7);
  EXPECT_EQ(shortfalls.size(), 1 + sink.totals()->shortfalls);
  EXPECT_GT(shortfalls.size(), 3u);
  for (const auto& lines : {rows, shortfalls}) {
    const auto commas = std::count(lines[0].begin(), lines[0].end(), ',');
    for (const std::string& line : lines)
      EXPECT_EQ(std::count(line.begin(), line.end(), ','), commas) << line;
  }
  // Rows and totals have equal shortfall times by region, counting each robot once.
  std::map<std::string, double> shortfall_s;
  for (size_t i = 1; i < rows.size(); ++i) {
    std::vector<std::string> fields;
    std::istringstream in(rows[i]);
    for (std::string field; std::getline(in, field, ',');) fields.push_back(field);
    if (fields.back() != "0") shortfall_s[fields[3]] += 0.05;
  }
  for (size_t i = 0; i < kBodyRegions; ++i)
    EXPECT_NEAR(sink.totals()->regions[i].shortfall_s,
                shortfall_s[std::string(name_of(static_cast<BodyRegion>(i)))], 1e-6);
  std::ifstream figure(folder_ / "out" / "separation.svg");
  EXPECT_EQ(has_gnuplot(), figure.good());
}

}  // namespace
}  // namespace throng::separation_test
