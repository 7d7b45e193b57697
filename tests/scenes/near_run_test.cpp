// Distances of a run: the same for threads and behind a checkpoint, and no event is another for
// them.
#include <gtest/gtest.h>

#include "base/errors.h"
#include "scenes/run/runner.h"
#include "scenes/run/simulation.h"

namespace throng {
namespace {

Scene plaza(double near_m, double person_near_m) {
  Scene scene = load_scene("plaza");
  std::vector<std::string> notes;
  scale_to(scene, 80, notes);
  scene.exact = true;
  scene.near_m = near_m;
  scene.person_near_m = person_near_m;
  scene.duration_s = 0.5;
  return scene;
}

RunSummary summary_of(const Scene& scene, int threads) {
  SimulationOptions options;
  options.threads = threads;
  Simulation simulation(scene, options);
  return run(simulation, {});
}

TEST(NearRun, HasTheSameRowsForThreadsAndChangesNoEvent) {
  const RunSummary one = summary_of(plaza(0.2, 0.6), 1), three = summary_of(plaza(0.2, 0.6), 3),
                   none = summary_of(plaza(0, 0), 1);
  EXPECT_GT(one.near.pairs, 100u);
  EXPECT_GT(one.near.people, 100u);
  EXPECT_EQ(one.near.hash, three.near.hash);
  EXPECT_EQ(one.hash, three.hash);
  EXPECT_EQ(one.hash, none.hash);
  EXPECT_FALSE(none.near.is_asked);
  EXPECT_NE(one.run_id, none.run_id) << "what a run lists is part of its name";
}

TEST(NearRun, GoesOnBehindACheckpoint) {
  const Scene scene = plaza(0.2, 0.6);
  Simulation whole(scene, {}), rest(scene, {});
  for (int i = 0; i < 10; ++i) whole.step();
  rest.resume(whole.saved(), "test");
  for (int i = 0; i < 10; ++i) {
    const Frame &expected = whole.step(), &found = rest.step();
    ASSERT_EQ(found.near_hash, expected.near_hash) << "frame " << expected.number;
    ASSERT_EQ(found.near_pairs.size(), expected.near_pairs.size());
    for (size_t k = 0; k < found.near_pairs.size(); ++k) {
      const float a = found.near_pairs[k].closing_mps, b = expected.near_pairs[k].closing_mps;
      ASSERT_TRUE(a == b || (a != a && b != b)) << "frame " << expected.number << ", row " << k;
    }
  }
}

/// The people of a row of two people are nowhere else nearer.
TEST(NearRun, NamesTheNearestPartsOfEachTwoPeople) {
  Simulation simulation(plaza(0.3, 0.3), {});
  int rows = 0;
  for (int i = 0; i < 20; ++i) {
    const Frame& frame = simulation.step();
    for (const NearPair& people : frame.near_people) {
      ++rows;
      for (const NearPair& parts : frame.near_pairs)
        if (parts.pair.a() == people.pair.a() && parts.pair.b() == people.pair.b()) {
          ASSERT_LE(people.hi_m, parts.hi_m);
        }
    }
  }
  EXPECT_GT(rows, 50);
}

}  // namespace
}  // namespace throng
