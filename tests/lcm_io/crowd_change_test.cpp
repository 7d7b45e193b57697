// People are added, removed and redirected while a run goes on. No contact is missed, and begins
// and ends pair up. Threads, SIMD targets, a resumed run and a culled log change nothing.
#include "scenes/run/crowd_change.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <lcm/lcm-cpp.hpp>
#include <map>
#include <numbers>
#include <set>

#include "base/errors.h"
#include "base/random.h"
#include "base/simd.h"
#include "lcm_io/codec/message_validation.h"
#include "lcm_io/codec/rows.h"
#include "lcm_io/log/log_reader.h"
#include "lcm_io/wire/crowd_change_receiver.h"
#include "scenes/run/postures.h"
#include "tests/lcm_io/culled_again.h"
#include "tests/lcm_io/nearly_touching.h"
#include "tests/nightly.h"
#include "tests/scenes/person_pairs.h"

namespace throng::crowd_change_test {
namespace {

constexpr int kFrames = 60;
constexpr const char* kScenes[] = {
    // A crowd in a room with a pillar, densely placed, with people to add and to move.
    R"(name: room
seed: 1
step_s: 0.05
ground: {min_m: [-6, -6], max_m: [6, 6]}
culling: {exact: true}
obstacles:
  - {name: pillar, kind: box, position_m: [0, 0], size_m: [1, 1, 2]}
groups:
  - name: crowd
    count: 14
    spare: 60
    spawn: {min_m: [-5, -5], max_m: [-2, 5]}
    goals: [{min_m: [3, -4], max_m: [5, 4]}, {min_m: [-5, -5], max_m: [-2, 5]}]
  - name: guided
    count: 3
    spare: 8
    spawn: {min_m: [2, -2], max_m: [4, 2]}
    externally_controlled: true
)",
    // People enter, queue and leave.
    R"(name: counter
seed: 2
step_s: 0.05
ground: {min_m: [-6, -4], max_m: [6, 4]}
culling: {exact: true}
groups:
  - name: crowd
    count: 8
    spare: 40
    on_arrival: leave
    spawn: {min_m: [-5, -3], max_m: [-2, 3]}
    goals: [{min_m: [0, -0.5], max_m: [1, 0.5], wait_s: 0.5, capacity: 1}, {min_m: [4, -3], max_m: [5.5, 3]}]
    sources: [{area: {min_m: [-5.5, -3], max_m: [-4, 3]}, count: 20, rate_per_s: 4}]
  - name: guided
    count: 2
    spare: 4
    spawn: {min_m: [2, 1], max_m: [3, 3]}
    externally_controlled: true
)",
    // Two floors of doors and friends who walk together.
    R"(name: doorways
seed: 3
step_s: 0.05
ground: {min_m: [-6, -5], max_m: [6, 5]}
culling: {exact: true}
obstacles:
  - {name: a, kind: box, position_m: [0, -3.5], size_m: [0.2, 3, 2]}
  - {name: b, kind: box, position_m: [0, 0], size_m: [0.2, 2, 2]}
  - {name: c, kind: box, position_m: [0, 3.5], size_m: [0.2, 3, 2]}
doors:
  - {name: north, from_m: [0, 1], to_m: [0, 2], opens: [1], closes: [2]}
groups:
  - name: crowd
    count: 16
    spare: 40
    on_arrival: stay
    social_groups: {share: 0.8}
    spawn: {min_m: [-5, -4], max_m: [-2, 4]}
    goals: [{min_m: [2, -4], max_m: [5, 4]}]
  - name: guided
    count: 2
    spare: 4
    spawn: {min_m: [3, -2], max_m: [4, 2]}
    externally_controlled: true
)",
    // A floor that is no rectangle; no agent enters or leaves by itself.
    R"(name: hall
seed: 4
step_s: 0.05
ground: {polygon: [[-6, -5], [6, -5], [6, 5], [1, 5], [1, 1], [-1, 1], [-1, 5], [-6, 5]]}
culling: {exact: true}
groups:
  - name: crowd
    count: 18
    spawn: {min_m: [-5, -4], max_m: [-2, 4]}
    goals: [{polygon: [[2, 2], [5, 2], [5, 4]]}, {min_m: [-5, -4], max_m: [-2, 4]}]
  - name: guided
    count: 2
    spawn: {min_m: [2, -3], max_m: [4, -1]}
    externally_controlled: true
)"};

Scene scene_of(uint64_t seed) {
  Scene scene = read_scene_text(kScenes[seed % std::size(kScenes)], "scene");
  scene.seed = seed;
  scene.content_hash = content_hash_of(scene);
  return scene;
}

/// Makes the same calls before the same frame of equal runs.
class Caller {
 public:
  Caller(Simulation& run, uint64_t seed) : run_(run), seed_(seed) {}

  void call() {
    draws_ = 0;
    const auto wave = static_cast<uint64_t>(run_.next_frame());
    frame_ = wave;
    if (uniform() < 0.35) attempt([&] { add(); });
    if (uniform() < 0.25) attempt([&] { run_.remove(some(3)); });
    if (uniform() < 0.25) attempt([&] { run_.set_goal(some(6), goal()); });
    if (uniform() < 0.2) {
      const std::vector<uint32_t> ids = some(5);
      const std::vector<double> speeds(ids.size(), 0.05 + 4 * uniform());  // some are too slow
      attempt([&] { run_.set_desired_speed(ids, speeds); });
    }
    move_guided();
  }

  int changes = 0, rejected = 0;

 private:
  template <typename Change>
  void attempt(const Change& change) {
    try {
      change();
      ++changes;
    } catch (const InputError&) {
      ++rejected;
    }
  }
  double uniform() { return random_uniform({seed_, frame_, 0, Purpose::kGoal}, draws_++); }
  Eigen::Vector2d point() { return {-6.2 + 12.4 * uniform(), -5.2 + 10.4 * uniform()}; }

  void add() {
    std::vector<AgentEntry> entries(1 + static_cast<size_t>(3 * uniform()));
    for (AgentEntry& entry : entries) {
      entry.position_m = point();
      if (uniform() < 0.5) entry.heading_rad = 7 * uniform();
      entry.speed_mps = 1.5 * uniform();
    }
    run_.add(uniform() < 0.8 ? "crowd" : "guided", entries);
  }

  /// Mostly people who are there.
  std::vector<uint32_t> some(int count) {
    std::set<uint32_t> ids;
    const auto people = static_cast<double>(run_.info().avatar_count());
    for (int i = 0; i < count; ++i) {
      const auto id = static_cast<uint32_t>(uniform() * (people + 0.2));
      const std::span<const uint8_t> present = present_;
      if (id >= present.size() || present[id] != 0 || uniform() < 0.02) ids.insert(id);
    }
    return {ids.begin(), ids.end()};
  }

  std::string goal() {
    const Eigen::Vector2d from = point().cwiseMax(-5.0).cwiseMin(4.0);
    return fmt::format("{{min_m: [{}, {}], max_m: [{}, {}], wait_s: {}}}", from.x(), from.y(),
                       from.x() + 0.5 + uniform(), from.y() + 0.5 + uniform(),
                       uniform() < 0.5 ? 0 : 1);
  }

  void move_guided() {
    for (uint32_t id = 0; id < static_cast<uint32_t>(run_.info().avatar_count()); ++id) {
      const ExternalPose* pose = run_.external_pose(id);
      if (pose == nullptr || uniform() < 0.1) continue;
      const double turn = 0.3 * static_cast<double>(frame_) + id;
      const Eigen::Vector2d to = pose->root.position_m.head<2>() +
                                 0.06 * Eigen::Vector2d(std::cos(turn), std::sin(0.7 * turn));
      if (uniform() < 0.9) {
        run_.walk_to(id, to);
      } else {
        ExternalPose glides = *pose;
        glides.walks = false;
        glides.root.position_m.head<2>() = to;
        run_.set_pose(id, glides);
      }
    }
  }

 public:
  void look(const Frame& frame) { present_.assign(frame.present.begin(), frame.present.end()); }

 private:
  Simulation& run_;
  uint64_t seed_;
  uint64_t frame_ = 0;
  uint32_t draws_ = 0;
  std::vector<uint8_t> present_;
};

SimulationOptions options_with(int threads, SimdTarget simd) {
  SimulationOptions options;
  options.threads = threads;
  options.culler.simd = simd;
  return options;
}

/// Runs a scene from its start, or from a saved state, and returns the hash.
uint64_t hash_of(const Scene& scene, uint64_t seed, const SimulationOptions& options) {
  Simulation run(scene, options);
  Caller caller(run, seed);
  for (int i = 0; i < kFrames; ++i) {
    caller.call();
    caller.look(run.step());
  }
  return run.finish().hash;
}

/// Contacts that have begun and not ended.
class OpenContacts {
 public:
  void take(std::span<const PairEvent> events) {
    for (const PairEvent& event : events) {
      const bool is_begin = event.kind == EventKind::kBegin;
      const auto known = open_.find(event.pair);
      EXPECT_EQ(known == open_.end(), is_begin);
      if (is_begin)
        open_.insert(event.pair);
      else if (known != open_.end())
        open_.erase(known);
    }
  }
  void expect_present(const Frame& frame) const {
    for (const PairKey& pair : open_)
      for (const uint32_t body : {pair.a(), pair.b()})
        EXPECT_TRUE(body >= frame.roots.size() || frame.present.empty() || frame.present[body] != 0)
            << "body " << body << " is not in the scene, but in contact";
  }
  bool empty() const { return open_.empty(); }

 private:
  std::set<PairKey> open_;
};

TEST(CrowdChanges, MissNoContactAndGiveOneResult) {
  uint64_t touching = 0, changes = 0, rejected = 0;
  const std::vector<SimdTarget> targets = simd_targets_of_this_machine();
  const uint64_t seeds = test::is_nightly() ? 500 : 24;
  for (uint64_t seed = 1; seed <= seeds; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const Scene scene = scene_of(seed);
    const ScratchFile log;
    Simulation run(scene, {});
    LogSink sink(log.path(), {});
    sink.begin(run.info());
    Caller caller(run, seed);
    test::PersonPairs oracle(run);
    OpenContacts open;
    std::vector<CulledFrame> frames;
    std::vector<uint8_t> saved;
    std::vector<uint8_t> present_then;
    const int stop = static_cast<int>(seed % kFrames);
    for (int i = 0; i < kFrames; ++i) {
      caller.call();
      if (i == stop) saved = run.saved();
      const Frame& frame = run.step();
      caller.look(frame);
      sink.frame(run.info(), frame);
      oracle.check(frame);
      open.take(frame.events);
      open.expect_present(frame);
      frames.push_back(culled_frame_of(frame));
    }
    const RunEnd end = run.finish();
    sink.end(run.info(), end);
    open.take(end.events);
    EXPECT_TRUE(open.empty());
    EXPECT_EQ(oracle.missed, 0u) << oracle.first_miss;
    touching += oracle.touching;
    changes += static_cast<uint64_t>(caller.changes);
    rejected += static_cast<uint64_t>(caller.rejected);
    ASSERT_FALSE(HasFailure());

    ASSERT_EQ(hash_of(scene, seed, options_with(3, targets[seed % targets.size()])), end.hash);
    ASSERT_EQ(hash_of(scene, seed, options_with(1, targets[(seed + 1) % targets.size()])),
              end.hash);

    if (stop > 0) {
      Simulation rest(scene, {});
      rest.resume(saved, "test");
      Caller later(rest, seed);
      for (int i = stop; i < kFrames; ++i) {
        if (i > stop) later.call();
        later.look(rest.step());
      }
      ASSERT_EQ(rest.finish().hash, end.hash) << "resumed before frame " << stop;
    }

    const std::vector<CulledFrame> again = culled_again(log.path());
    ASSERT_EQ(again.size(), frames.size());
    const Simulation shape(scene, {});
    const Placed placed(shape);
    for (size_t i = 0; i < frames.size(); ++i) expect_near(placed, frames[i], again[i]);
    ASSERT_FALSE(HasFailure());
  }
  std::printf("%llu sequences, %llu changes, %llu rejected: %llu touching pairs\n",
              static_cast<unsigned long long>(seeds), static_cast<unsigned long long>(changes),
              static_cast<unsigned long long>(rejected), static_cast<unsigned long long>(touching));
  EXPECT_GT(touching, seeds);
  EXPECT_GT(rejected, 0u);
}

/// A run that takes changes over LCM within one process.
struct ChangedRun {
  ChangedRun()
      : lcm(std::make_shared<lcm::LCM>("memq://")),
        simulation(with_channel(scene_of(4)), {}),
        receiver(simulation.info(), lcm) {}

  static Scene with_channel(Scene scene) {
    scene.change_channel = "CHANGES";
    return scene;
  }
  static crowd_change_t message(const CrowdChange& change) {
    crowd_change_t m{};
    m.chunk_count = 1;
    m.schema = kSchema;
    set_change(m, change, 0,
               change.kind == CrowdChange::Kind::kAdd ? change.entries.size() : change.ids.size());
    return m;
  }
  const Frame& step_after(const crowd_change_t& m) {
    lcm->publish("CHANGES", &m);
    receiver.apply(simulation);
    return simulation.step();
  }

  std::shared_ptr<lcm::LCM> lcm;
  Simulation simulation;
  CrowdChangeReceiver receiver;
};

CrowdChange addition(const std::string& group, const Eigen::Vector2d& position_m) {
  CrowdChange change{.kind = CrowdChange::Kind::kAdd, .group = group};
  change.ids = {0};
  change.entries.resize(1);
  change.entries[0].position_m = position_m;
  return change;
}

TEST(CrowdChangeReceiver, AppliesMessagesBeforeTheNextFrame) {
  ChangedRun run;
  const auto first = static_cast<uint32_t>(14);
  EXPECT_EQ(run.step_after(ChangedRun::message(addition("crowd", {3, 4}))).present[first], 1);
  CrowdChange removal{.kind = CrowdChange::Kind::kRemove, .ids = {first}};
  EXPECT_EQ(run.step_after(ChangedRun::message(removal)).present[first], 0);
  EXPECT_EQ(run.receiver.counts().messages, 2);
  EXPECT_EQ(run.receiver.counts().rejected, 0);
}

TEST(CrowdChangeReceiver, CountsWhatTheRunCannotDoAndGoesOn) {
  ChangedRun run;
  const auto reason_after = [&](const crowd_change_t& m) {
    run.step_after(m);
    return run.receiver.counts().rejection;
  };
  EXPECT_EQ(reason_after(ChangedRun::message(addition("crowd", {0, 0}))).substr(0, 15),
            "positions_m[0]:");
  EXPECT_NE(
      reason_after(ChangedRun::message(addition("crwd", {3, 4}))).find("did you mean 'crowd'"),
      std::string::npos);
  crowd_change_t other = ChangedRun::message(addition("crowd", {3, 4}));
  other.run_id = 7;
  EXPECT_NE(reason_after(other).find("a change for run 0000000000000007"), std::string::npos);
  CrowdChange removal{.kind = CrowdChange::Kind::kRemove, .ids = {9999}};
  EXPECT_EQ(reason_after(ChangedRun::message(removal)).substr(0, 7), "ids[0]:");
  crowd_change_t damaged = ChangedRun::message(addition("crowd", {3, 4}));
  damaged.kind = 9;
  EXPECT_NE(reason_after(damaged), "");
  EXPECT_EQ(run.receiver.counts().rejected, 5);
  EXPECT_EQ(run.receiver.counts().messages, 0);
}

TEST(CrowdChangeReceiver, SurvivesDamagedMessages) {
  ChangedRun run;
  const crowd_change_t sound = ChangedRun::message(addition("crowd", {3, 4}));
  std::vector<uint8_t> bytes(static_cast<size_t>(sound.getEncodedSize()));
  sound.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  for (size_t i = 0; i < 400; ++i) {
    std::vector<uint8_t> wrong = bytes;
    wrong[(37 * i) % wrong.size()] ^= static_cast<uint8_t>(1 + i % 255);
    if (i % 3 == 0) wrong.resize(i % wrong.size());
    run.lcm->publish("CHANGES", wrong.data(), static_cast<unsigned>(wrong.size()));
  }
  run.receiver.apply(run.simulation);
  run.simulation.step();
  EXPECT_GT(run.receiver.counts().rejected, 200);
}

TEST(CrowdChanges, ResumeAfterARouteOfRemovedPeopleWasReplaced) {
  const Scene scene = read_scene_text(R"(name: two
ground: {min_m: [0, 0], max_m: [10, 10]}
groups:
  - {name: a, count: 2, spawn: {min_m: [1, 1], max_m: [4, 9]}, goals: [{min_m: [8, 1], max_m: [9, 9]}]}
  - {name: b, count: 2, spawn: {min_m: [1, 1], max_m: [4, 9]}, goals: [{min_m: [8, 1], max_m: [9, 9]}]}
)",
                                      "scene");
  Simulation run(scene, {});
  run.step();
  const uint32_t a[] = {0, 1}, b[] = {2, 3};
  run.set_goal(a, "{min_m: [5, 1], max_m: [6, 2]}");
  run.step();
  run.remove(a);
  run.set_goal(b, "{min_m: [5, 8], max_m: [6, 9]}");
  run.step();
  const std::vector<uint8_t> saved = run.saved();
  Simulation rest(scene, {});
  rest.resume(saved, "test");
  for (int i = 0; i < 60; ++i) {
    const Eigen::Vector3d there = run.step().roots[2].position_m;
    EXPECT_EQ(rest.step().roots[2].position_m, there);
  }
}

TEST(CrowdChanges, AreInTheLog) {
  const ScratchFile log;
  Simulation run(scene_of(4), {});
  LogSink sink(log.path(), {});
  sink.begin(run.info());
  sink.frame(run.info(), run.step());
  std::vector<AgentEntry> entries(3);
  for (size_t i = 0; i < entries.size(); ++i)
    entries[i] = {{3, 2 + static_cast<double>(i)}, 0.5, 1};
  const uint32_t first = run.add("crowd", entries);
  const uint32_t ids[] = {first, first + 1};
  run.set_goal(ids, "{min_m: [-5, -5], max_m: [-4, -4]}");
  sink.frame(run.info(), run.step());
  sink.end(run.info(), run.finish());
  std::vector<CrowdChange> changes;
  LogReader reader(log.path());
  for (LogEvent event; reader.next(event) == LogReader::Status::kEvent;) {
    crowd_change_t m;
    if (event.channel != name_of(Channel::kChanges)) continue;
    ASSERT_EQ(decode(event.data, m), "");
    EXPECT_EQ(m.frame, 1);
    changes.push_back(change_of(m));
  }
  ASSERT_EQ(changes.size(), 2u);
  EXPECT_EQ(changes[0].group, "crowd");
  EXPECT_EQ(changes[0].entries.size(), 3u);
  EXPECT_EQ(changes[0].entries[2].position_m, Eigen::Vector2d(3, 4));
  EXPECT_EQ(changes[1].ids, (std::vector<uint32_t>{first, first + 1}));
  EXPECT_EQ(changes[1].goal, "{min_m: [-5, -5], max_m: [-4, -4]}");
}

}  // namespace
}  // namespace throng::crowd_change_test
