#include "tests/culling/proximity_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "culling/culling.h"

namespace throng::test {

namespace {

/// True if there is a point for each touching pair, with a position.
bool has_point_of_each(const Culler& culler) {
  return std::equal(
      culler.pairs().begin(), culler.pairs().end(), culler.contact_points().begin(),
      culler.contact_points().end(), [](const PairKey& pair, const ContactPoint& point) {
        return point.pair == pair && std::isfinite(point.point_m[0]) && point.depth_m >= 0;
      });
}

}  // namespace

ProximityTally check_proximity_rows(bench::Family family, uint64_t pairs, uint64_t seed) {
  constexpr PairSearch kSearches[] = {PairSearch::kGrid, PairSearch::kSweep, PairSearch::kBrute};
  constexpr float kMargins_m[] = {0.02f, 0.1f, 0.3f};
  const std::vector<SimdTarget> targets = simd_targets_of_this_machine();
  bench::Draw draw(seed, 2000 + static_cast<uint64_t>(family));
  const std::vector<bench::BodyKind> kinds = bench::kinds_of(family, draw);
  std::vector<std::shared_ptr<const BodyType>> types;
  std::vector<std::vector<DistanceTree>> trees;
  for (const bench::BodyKind& kind : kinds) {
    types.push_back(kind.type);
    trees.emplace_back(kind.type->parts().begin(), kind.type->parts().end());
  }
  ProximityTally tally;
  for (size_t frame = 0; tally.tested < pairs; ++frame) {
    const bench::RandomPairs world(family, kinds, draw);
    CullerOptions options;
    options.exact = frame % 2 == 1;
    options.simd = targets[frame / 2 % targets.size()];
    options.pair_search = kSearches[frame % std::size(kSearches)];
    options.proximity.margin_m = kMargins_m[frame / 2 % std::size(kMargins_m)];
    options.proximity.contact_points = options.exact;
    Workers workers(1 + static_cast<int>(frame % 2));
    Culler culler(types, options, workers);
    culler.step(world.view(), world);
    const std::string how = fmt::format(
        "{}, seed {}, frame {}, margin {} m, {}{}", bench::name_of(family), seed, frame,
        options.proximity.margin_m, name_of(options.simd), options.exact ? ", exact" : "");
    if (options.exact) {
      CullerOptions no_margin = options;
      no_margin.proximity = {.contact_points = true};
      Culler without_margin(types, no_margin, workers);
      without_margin.step(world.view(), world);
      if (!has_point_of_each(culler) || !has_point_of_each(without_margin)) {
        ++tally.missed;
        if (tally.first_wrong.empty()) tally.first_wrong = how + ": contact points";
      }
    }
    ProximityOracle judge(options.proximity.margin_m, tally);
    for (uint32_t a = 0; a < 2 * bench::RandomPairs::kPairs; a += 2) {
      const uint32_t b = a + 1;
      const Eigen::Vector3d a_to_b = world.root(b) - world.root(a);
      std::vector<bench::PartBox> boxes_b;
      for (size_t j = 0; j < world.parts_of(b).size(); ++j) boxes_b.push_back(world.box(b, j));
      for (uint32_t i = 0; i < world.parts_of(a).size(); ++i) {
        const bench::PartBox box_a = world.box(a, i);
        for (uint32_t j = 0; j < world.parts_of(b).size(); ++j) {
          const bool touches = bench::PartBox::is_within_margin(box_a, boxes_b[j], a_to_b) &&
                               world.touch(a, i, b, j);
          judge.judge({&trees[world.type(a)][i], &world.parts_of(a)[i], world.scale(a)},
                      {&trees[world.type(b)][j], &world.parts_of(b)[j], world.scale(b)}, a_to_b,
                      touches, PairKey(a, b, i, j), culler.proximity_pairs(), [&] {
                        return fmt::format("{}: bodies {} and {}, parts {} and {}", how, a, b, i,
                                           j);
                      });
        }
      }
    }
  }
  return tally;
}

}  // namespace throng::test
