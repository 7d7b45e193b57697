// People who are moved from outside walk on the path they are given.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "scenes/run/crowd_change.h"
#include "scenes/run/simulation.h"
#include "tests/scenes/slide_meter.h"

namespace throng::external_people_test {
namespace {

Scene scene_of(int count, int spare = 0) {
  return read_scene_text(fmt::format(R"(name: guided
ground: {{min_m: [-20, -20], max_m: [20, 20]}}
groups:
  - name: guided
    count: {}
    spare: {}
    spawn: {{min_m: [-15, -15], max_m: [15, 15]}}
    externally_controlled: true
)",
                                     count, spare),
                         "scene");
}

/// Moves all people on circles, at about 1.2 m/s.
void walk_in_circles(Simulation& run) {
  const double turn = 1.2 / 3 * run.info().step_s * static_cast<double>(run.next_frame());
  for (uint32_t id = 0; id < static_cast<uint32_t>(run.info().avatar_count()); ++id) {
    const Eigen::Vector2d at = run.external_pose(id)->root.position_m.head<2>();
    const double own = turn + id;
    run.walk_to(id, at + 1.2 * run.info().step_s * Eigen::Vector2d(std::cos(own), std::sin(own)));
  }
}

TEST(ExternalPeople, PlantTheirFeet) {
  Simulation run(scene_of(20), {});
  SlideMeter meter(run);
  run.step();
  for (int i = 0; i < 300; ++i) {
    walk_in_circles(run);
    const Frame& frame = run.step();
    if (i > 60) meter.watch(frame);  // after they have got under way
  }
  ASSERT_GT(meter.slides.all_m.size(), 100u);
  std::printf("stances that slide, median %.4f m, 90 %% %.4f m\n", meter.slides.quantile_m(0.5),
              meter.slides.quantile_m(0.9));
  EXPECT_LT(meter.slides.quantile_m(0.5), 0.01);
  EXPECT_LT(meter.slides.quantile_m(0.9), 0.03);
}

TEST(ExternalPeople, AreWhereTheyWereSent) {
  Simulation run(scene_of(5), {});
  run.step();
  for (int i = 0; i < 60; ++i) {
    walk_in_circles(run);
    std::vector<Eigen::Vector2d> sent;
    for (uint32_t id = 0; id < 5; ++id)
      sent.emplace_back(run.external_pose(id)->root.position_m.head<2>());
    const Frame& frame = run.step();
    for (uint32_t id = 0; id < 5; ++id) EXPECT_EQ(frame.roots[id].position_m.head<2>(), sent[id]);
  }
}

TEST(ExternalPeople, StandWithoutACall) {
  Simulation run(scene_of(3), {});
  run.step();
  for (int i = 0; i < 60; ++i) {
    walk_in_circles(run);
    EXPECT_GT(run.step().speeds_mps[0], 1);
  }
  EXPECT_EQ(run.step().speeds_mps[0], 0);
}

TEST(ExternalPeople, JumpWithoutASpeed) {
  Simulation run(scene_of(1), {});
  run.step();
  EXPECT_EQ(run.walk_to(0, {10, 10}), 0);
  const Frame& frame = run.step();
  EXPECT_EQ(frame.roots[0].position_m.head<2>(), Eigen::Vector2d(10, 10));
  EXPECT_EQ(frame.speeds_mps[0], 0);
}

TEST(ExternalPeople, EnterWhereTheyAreAdded) {
  Simulation run(scene_of(1, 2), {});
  EXPECT_EQ(run.step().present[1], 0);
  const AgentEntry entry{.position_m = {3, 4}, .heading_rad = 0.5};
  EXPECT_EQ(run.add("guided", {&entry, 1}), 1u);
  const Frame& frame = run.step();
  EXPECT_EQ(frame.present[1], 1);
  EXPECT_EQ(frame.roots[1].position_m.head<2>(), Eigen::Vector2d(3, 4));
}

}  // namespace
}  // namespace throng::external_people_test
