// The grid against looking at everybody.
#include "scenes/neighbour_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "base/random.h"

namespace throng {
namespace {

std::vector<Neighbour> brute_force(std::span<const Eigen::Vector2d> points, uint32_t id,
                                   double reach_m, size_t count) {
  std::vector<Neighbour> all;
  for (uint32_t other = 0; other < points.size(); ++other) {
    const double square = (points[other] - points[id]).squaredNorm();
    if (other != id && square <= reach_m * reach_m) all.push_back({square, other});
  }
  std::sort(all.begin(), all.end(), [](const Neighbour& a, const Neighbour& b) {
    return a.square_m2 != b.square_m2 ? a.square_m2 < b.square_m2 : a.id < b.id;
  });
  all.resize(std::min(all.size(), count));
  return all;
}

/// Random points, some exactly on a lattice (equal distances), some outside the ground.
std::vector<Eigen::Vector2d> scatter(uint64_t seed, size_t count, const Rectangle& ground) {
  std::vector<Eigen::Vector2d> points;
  for (size_t i = 0; i < count; ++i) {
    const RandomKey key{seed, i, 0, Purpose::kBoxWorld};
    Eigen::Vector2d point(random_uniform(key, ground.min_m.x() - 0.5, ground.max_m.x() + 0.5, 0),
                          random_uniform(key, ground.min_m.y() - 0.5, ground.max_m.y() + 0.5, 1));
    if (i % 3 == 0) point = point.array().floor();
    points.push_back(point);
  }
  return points;
}

TEST(NeighbourGrid, FindsWhatLookingAtEverybodyFinds) {
  for (uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const Rectangle ground{{-4, 2}, {-4 + static_cast<double>(seed), 2 + 12.3}};
    const std::vector<Eigen::Vector2d> points = scatter(seed, 30 * seed % 400 + 2, ground);
    NeighbourGrid grid(ground);
    grid.rebuild(points);
    for (const double reach_m : {0.7, 2.0, 5.0}) {
      for (uint32_t id = 0; id < points.size(); ++id) {
        std::array<Neighbour, 10> out;
        const size_t found = grid.nearest(id, reach_m, out);
        const std::vector<Neighbour> expected = brute_force(points, id, reach_m, out.size());
        ASSERT_EQ(found, expected.size()) << "id " << id << " reach " << reach_m << " m";
        for (size_t k = 0; k < found; ++k) ASSERT_EQ(out[k].id, expected[k].id) << "rank " << k;
      }
    }
  }
}

TEST(NeighbourGrid, OrderHoldsEverybodyOnce) {
  const Rectangle ground{{0, 0}, {30, 20}};
  NeighbourGrid grid(ground);
  for (const uint64_t seed : {3u, 4u}) {  // the second rebuild starts from used arrays
    grid.rebuild(scatter(seed, 500, ground));
    std::vector<uint32_t> ids(grid.order().begin(), grid.order().end());
    std::sort(ids.begin(), ids.end());
    for (uint32_t id = 0; id < 500; ++id) ASSERT_EQ(ids[id], id);
  }
}

}  // namespace
}  // namespace throng
