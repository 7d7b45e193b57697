// Tests that the grid marks the same overlapping spheres as a test of all pairs.
#include <gtest/gtest.h>

#include <algorithm>

#include "base/random.h"
#include "viewer/server/frame_message.h"

namespace throng::sphere_overlaps_test {
namespace {

std::vector<uint8_t> by_all_pairs(const std::vector<PlacedSphere>& spheres) {
  std::vector<uint8_t> flags(spheres.size(), 0);
  for (size_t i = 0; i < spheres.size(); ++i)
    for (size_t j = i + 1; j < spheres.size(); ++j) {
      const PlacedSphere &a = spheres[i], &b = spheres[j];
      const float x = a.x - b.x, y = a.y - b.y, z = a.z - b.z, reach = a.radius + b.radius;
      if (a.radius > 0 && b.radius > 0 && x * x + y * y + z * z <= reach * reach)
        flags[i] = flags[j] = 1;
    }
  return flags;
}

class Crowding : public testing::TestWithParam<double> {};

TEST_P(Crowding, MatchesAllPairs) {
  const double spread_m = GetParam();
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    std::vector<PlacedSphere> spheres;
    for (uint64_t id = 0; id < 200; ++id) {
      const RandomKey key{.seed = seed, .id = id};
      const auto draw = [&](uint32_t index, double low, double high) {
        return static_cast<float>(random_uniform(key, low, high, index));
      };
      const bool is_absent = id % 7 == 0;
      spheres.push_back({draw(0, -spread_m, spread_m), draw(1, -spread_m, 0.2 * spread_m),
                         draw(2, 0, 2), is_absent ? 0 : draw(3, 0.2, 1.2)});
    }
    std::vector<uint8_t> flags(spheres.size(), 9);
    SphereOverlaps crowded;
    const size_t marked = crowded.mark(spheres, flags);
    const std::vector<uint8_t> expected = by_all_pairs(spheres);
    EXPECT_EQ(flags, expected) << "seed " << seed;
    EXPECT_EQ(marked, static_cast<size_t>(std::count(expected.begin(), expected.end(), 1)));
  }
}

// From one cell with all spheres to a crowd so sparse that cells are larger than any sphere.
INSTANTIATE_TEST_SUITE_P(Spreads, Crowding, testing::Values(0.5, 8.0, 60.0, 2e6));

TEST(Crowding, IsEmptyWithoutSpheres) {
  SphereOverlaps crowded;
  EXPECT_EQ(crowded.mark({}, {}), 0u);
  std::vector<uint8_t> flag(1, 7);
  const PlacedSphere alone{3, 4, 1, 0.8F};
  EXPECT_EQ(crowded.mark({&alone, 1}, flag), 0u);
  EXPECT_EQ(flag[0], 0);
}

}  // namespace
}  // namespace throng::sphere_overlaps_test
