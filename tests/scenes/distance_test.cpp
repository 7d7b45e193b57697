// Distances by name: of bodies and parts of the latest frame of a simulation.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "scenes/scenes.h"
#include "tests/error_of.h"

namespace throng::distance_test {
namespace {

Scene robot_scene(bool exact) {
  Scene scene = load_scene("robot_in_crowd");
  scene.exact = exact;
  scene.proximity_m = exact ? 0.4 : 0;
  scene.closest_parts_m = exact ? 1.0 : 0;
  return scene;
}

auto bounds_of(const PartDistance& d) { return std::tuple(d.lo_m, d.hi_m, d.depth_m); }

TEST(Distance, EqualsTheRowsOfAnExactRun) {
  Simulation simulation(robot_scene(true), {});
  // Volumes decide contacts here; distances still come from triangles.
  Simulation other(robot_scene(false), {.threads = 2, .postures = false});
  size_t rows = 0, nearest = 0;
  for (int i = 0; i < 40; ++i) {
    const Frame& frame = simulation.step();
    other.step();
    if (i % 8 != 0) continue;
    for (const ProximityPair& row : frame.proximity_pairs) {
      const auto of = [&](const Simulation& run) {
        return run.distance(row.pair.a(), int64_t{row.pair.part_a()}, row.pair.b(),
                            int64_t{row.pair.part_b()});
      };
      const PartDistance found = of(simulation);
      ASSERT_EQ(bounds_of(found), std::tuple(row.lo_m, row.hi_m, row.depth_m));
      ASSERT_EQ(found.point_a_m, row.point_a_m);
      ASSERT_EQ(bounds_of(of(other)), bounds_of(found));
      ++rows;
    }
    for (const ProximityPair& row : frame.closest_parts) {
      const PartDistance found = simulation.distance(row.pair.a(), "", row.pair.b(), "");
      ASSERT_EQ(bounds_of(found), std::tuple(row.lo_m, row.hi_m, row.depth_m));
      ASSERT_EQ(found.part_a, row.pair.part_a());
      ASSERT_EQ(found.part_b, row.pair.part_b());
      ++nearest;
    }
  }
  EXPECT_GT(rows, 100u);
  EXPECT_GT(nearest, 100u);
}

TEST(Distance, OfAWordIsThatOfTheNearestPartWithIt) {
  Simulation plaza(load_scene("plaza"), {});
  const Frame& frame = plaza.step();
  ASSERT_GT(frame.roots.size(), 20u);
  for (uint32_t b = 1; b < 20; ++b) {
    const PartDistance hands = plaza.distance(0, "hand", b, "head"),
                       left = plaza.distance(0, "left_hand", b, "head"),
                       right = plaza.distance(0, "rightHand", b, "head");
    EXPECT_EQ(hands.hi_m, std::min(left.hi_m, right.hi_m));
    EXPECT_LE(hands.lo_m, std::min(left.lo_m, right.lo_m) + 1e-3f);
    EXPECT_EQ(hands.part_a, left.hi_m < right.hi_m ? left.part_a : right.part_a);
    EXPECT_LE(plaza.distance(0, "", b, "").hi_m, hands.hi_m);
  }
}

TEST(Distance, ReachesObstacles) {
  Scene scene = load_scene("plaza");
  ASSERT_FALSE(scene.obstacles.empty());
  Simulation plaza(scene, {});
  const Frame& frame = plaza.step();
  const auto avatars = static_cast<uint32_t>(frame.roots.size());
  for (uint32_t i = 0; i < scene.obstacles.size(); ++i) {
    const PartDistance found = plaza.distance(3, "", avatars + i, 0);
    EXPECT_EQ(found.part_b, 0);
    EXPECT_GT(found.hi_m, 0);
    EXPECT_LE(found.hi_m - found.lo_m, 1e-3f);
    const PartDistance back = plaza.distance(avatars + i, "", 3, "");
    EXPECT_EQ(back.point_a_m, found.point_b_m);
  }
}

TEST(Distance, RejectsWhatTheFrameDoesNotHave) {
  Simulation simulation(robot_scene(false), {});
  EXPECT_EQ(test::error_of([&] { simulation.distance(0, "", 1, ""); }),
            "distance: expected a step before it, found none");
  const Frame& frame = simulation.step();
  const size_t bodies = frame.roots.size() + simulation.scene().obstacles.size();
  EXPECT_EQ(test::error_of([&] { simulation.distance(0, "", static_cast<uint32_t>(bodies), ""); }),
            fmt::format("b: expected a body number from 0 to {}, found {}", bodies - 1, bodies));
  EXPECT_EQ(test::error_of([&] { simulation.distance(1, "", 1, ""); }),
            "b: expected another body than a, found 1");
  const auto& models = simulation.info().models;
  uint32_t person = 0;
  while (!models[simulation.info().model_of_avatar[person]]->is_person) ++person;
  const uint32_t other = person == 0 ? 1 : 0;
  const std::string unknown =
      test::error_of([&] { simulation.distance(person, "hamd", other, ""); });
  EXPECT_EQ(unknown.rfind("part_a: expected a part number up to ", 0), 0u) << unknown;
  EXPECT_NE(unknown.find("leftHand"), std::string::npos) << unknown;
  EXPECT_NE(unknown.find("found 'hamd' (did you mean 'hand'?)"), std::string::npos) << unknown;
  EXPECT_NE(test::error_of([&] { simulation.distance(other, "", person, 99); }).find("found '99'"),
            std::string::npos);
  EXPECT_NE(test::error_of([&] { simulation.distance(other, "", person, -1); }), "");
  EXPECT_NE(test::error_of([&] { simulation.distance(other, "", person, "--"); }), "");
}

TEST(Distance, RejectsAbsentPeople) {
  for (const std::string& name : {std::string("rush_hour"), std::string("metro")}) {
    Simulation simulation(load_scene(name), {});
    for (int i = 0; i < 200; ++i) {
      const Frame& frame = simulation.step();
      const auto absent = std::find(frame.present.begin(), frame.present.end(), 0);
      const auto there = std::find(frame.present.begin(), frame.present.end(), 1);
      if (absent == frame.present.end() || there == frame.present.end()) continue;
      const auto a = static_cast<uint32_t>(absent - frame.present.begin()),
                 b = static_cast<uint32_t>(there - frame.present.begin());
      EXPECT_EQ(test::error_of([&] { simulation.distance(a, "", b, ""); }),
                fmt::format("a: expected a body in the scene in frame {}, found avatar {}, which "
                            "is not",
                            frame.number, a));
      return;
    }
  }
  FAIL() << "all people are present";
}

}  // namespace
}  // namespace throng::distance_test
