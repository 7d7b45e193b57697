// Tests of the neighbour grid against brute force.
#include "crowd/neighbours/neighbour_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <numeric>

#include "base/random.h"

namespace throng::neighbour_grid_test {
namespace {

/// The nearest slots by (distance, slot), by brute force.
std::vector<uint32_t> brute_force(const NeighbourGrid& grid, uint32_t own, float reach_m) {
  std::vector<std::pair<float, uint32_t>> all;
  for (uint32_t slot = 0; slot < grid.order().size(); ++slot) {
    const float dx = grid.x()[slot] - grid.x()[own], dy = grid.y()[slot] - grid.y()[own];
    const float square = dx * dx + dy * dy;
    if (slot != own && square <= reach_m * reach_m) all.emplace_back(square, slot);
  }
  std::sort(all.begin(), all.end());
  std::vector<uint32_t> slots;
  for (const auto& [square, slot] : all)
    if (slots.size() < NeighbourGrid::kMaxNeighbours) slots.push_back(slot);
  return slots;
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

TEST(NeighbourGrid, MatchesBruteForceOnEveryTarget) {
  for (const SimdTarget target : simd_targets_of_this_machine()) {
    for (uint64_t seed = 1; seed <= 40; ++seed) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", " << name_of(target));
      const Rectangle ground{{-4, 2}, {-4 + static_cast<double>(seed), 2 + 12.3}};
      const std::vector<Eigen::Vector2d> points = scatter(seed, 30 * seed % 400 + 2, ground);
      // Wide and narrow cells: for the actual number of agents, for few and for many.
      for (const size_t expected_people : {points.size(), size_t{3}, size_t{5000}}) {
        NeighbourGrid grid(ground, expected_people, target);
        grid.rebuild(points);
        std::vector<uint32_t> all(points.size());
        std::iota(all.begin(), all.end(), 0);
        std::vector<uint32_t> found(points.size() * NeighbourGrid::kMaxNeighbours);
        std::vector<uint8_t> counts(points.size());
        for (const float reach_m : {0.7f, 2.0f, 5.0f}) {
          grid.nearest(all, reach_m, found.data(), counts.data());
          for (uint32_t slot = 0; slot < points.size(); ++slot) {
            const auto first =
                found.begin() + static_cast<ptrdiff_t>(NeighbourGrid::kMaxNeighbours * slot);
            const std::vector<uint32_t> slots(first, first + counts[slot]);
            ASSERT_EQ(slots, brute_force(grid, slot, reach_m))
                << "slot " << slot << " reach " << reach_m << " m";
          }
        }
      }
    }
  }
}

TEST(NeighbourGrid, FindsMovedAgents) {
  for (const SimdTarget target : simd_targets_of_this_machine())
    for (uint64_t seed = 1; seed <= 20; ++seed) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", " << name_of(target));
      const Rectangle ground{{0, 0}, {20, 12}};
      const std::vector<Eigen::Vector2d> points = scatter(seed, 200, ground);
      NeighbourGrid grid(ground, points.size(), target);
      grid.rebuild(points);
      std::vector<uint32_t> slots(points.size());
      std::iota(slots.begin(), slots.end(), 0);
      std::vector<uint32_t> found(points.size() * NeighbourGrid::kMaxNeighbours);
      std::vector<uint8_t> counts(points.size());
      for (uint64_t step = 1; step <= 3; ++step) {
        double farthest_m = 0;
        for (uint32_t slot = 0; slot < points.size(); ++slot) {
          const RandomKey key{seed, slot, step, Purpose::kBoxWorld};
          const Eigen::Vector2d displacement(random_uniform(key, -0.5, 0.5, 0),
                                             random_uniform(key, -0.5, 0.5, 1));
          const Eigen::Vector2d from =
              grid.middle_m() + Eigen::Vector2f(grid.x()[slot], grid.y()[slot]).cast<double>();
          grid.move(slot, from + displacement);
          farthest_m = std::max(farthest_m, displacement.norm());
        }
        grid.add_slack_m(farthest_m);
        grid.nearest(slots, 2, found.data(), counts.data());
        for (const uint32_t slot : slots) {
          const auto first =
              found.begin() + static_cast<ptrdiff_t>(NeighbourGrid::kMaxNeighbours * slot);
          ASSERT_EQ(std::vector<uint32_t>(first, first + counts[slot]), brute_force(grid, slot, 2))
              << "slot " << slot << " after step " << step;
        }
      }
    }
}

TEST(NeighbourGrid, VisitsAllAgentsWithinReachAfterMovesAndInsertions) {
  for (uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const Rectangle ground{{-10, 3}, {-10 + static_cast<double>(seed), 15}};
    std::vector<Eigen::Vector2d> points = scatter(seed, 150, ground);
    std::vector<uint8_t> present(points.size(), 1);
    for (size_t id = 100; id < points.size(); ++id) present[id] = 0;
    NeighbourGrid grid(ground, points.size());
    for (uint64_t step = 0; step < 6; ++step) {
      const auto draw = [&](size_t id, uint32_t index, double max) {
        return random_uniform({seed, id, step, Purpose::kBoxWorld}, -max, max, index);
      };
      if (step % 4 == 0) grid.rebuild(points, present);
      for (auto& point : points) {
        const auto id = static_cast<size_t>(&point - points.data());
        point += Eigen::Vector2d(draw(id, 0, 0.2), draw(id, 1, 0.2));
      }
      grid.add_slack_m(0.29);
      // Two absent agents enter, two jump.
      for (const size_t id : {100 + 2 * step, 101 + 2 * step, step, step / 2}) {
        present[id] = 1;
        points[id] += Eigen::Vector2d(draw(id, 2, 8), draw(id, 3, 8));
        grid.insert(static_cast<uint32_t>(id), points[id]);
      }
      for (const double reach_m : {0.3, 2.0, 30.0})
        for (size_t own = 0; own < points.size(); own += 7) {
          std::vector<uint8_t> is_visited(points.size());
          grid.visit_near(points[own], reach_m, [&](uint32_t id) { is_visited[id] = 1; });
          for (size_t id = 0; id < points.size(); ++id) {
            if (present[id] == 0) {
              ASSERT_EQ(is_visited[id], 0) << id << " is absent";
            } else if ((points[id] - points[own]).norm() <= reach_m) {
              ASSERT_EQ(is_visited[id], 1) << id << " from " << own << " in step " << step;
            }
          }
        }
    }
  }
}

TEST(NeighbourGrid, OmitsAbsentAgents) {
  const Rectangle ground{{0, 0}, {30, 20}};
  NeighbourGrid grid(ground, 300);
  std::vector<uint8_t> present(300);
  for (size_t id = 0; id < present.size(); ++id) present[id] = id % 3 == 0 ? 0 : 1;
  grid.rebuild(scatter(7, present.size(), ground), present);
  EXPECT_EQ(grid.order().size(), 200u);
  for (const uint32_t id : grid.order()) EXPECT_NE(id % 3, 0u);
}

TEST(NeighbourGrid, OrdersEachAgentOnce) {
  const Rectangle ground{{0, 0}, {30, 20}};
  NeighbourGrid grid(ground, 500);
  for (const uint64_t seed : {3u, 4u}) {  // the second rebuild starts from used arrays
    grid.rebuild(scatter(seed, 500, ground));
    std::vector<uint32_t> ids(grid.order().begin(), grid.order().end());
    std::sort(ids.begin(), ids.end());
    for (uint32_t id = 0; id < 500; ++id) ASSERT_EQ(ids[id], id);
  }
}

}  // namespace
}  // namespace throng::neighbour_grid_test
