#include "tests/culling/near_rows.h"

#include <fmt/format.h>

#include <algorithm>

#include "culling/culling.h"

namespace throng::test {
namespace {

/// Poses are floats, and so is the way from root to root.
constexpr double kRounding_m = 2e-6;
constexpr uint64_t kByAllEvery = 100;

}  // namespace

void NearRowsTally::add(const NearRowsTally& other) {
  near += other.near;
  touching += other.touching;
  listed += other.listed;
  missed += other.missed;
  outside += other.outside;
  wide += other.wide;
  by_all += other.by_all;
  differing += other.differing;
  if (first_wrong.empty()) first_wrong = other.first_wrong;
}

std::string NearRowsJudge::verdict(const DistanceTree::Placed& a, const DistanceTree::Placed& b,
                                   const Eigen::Vector3d& a_to_b_m, bool touches, PairKey key,
                                   std::span<const NearPair> rows) {
  const auto row = std::lower_bound(
      rows.begin(), rows.end(), key,
      [](const NearPair& one, const PairKey& wanted) { return one.pair < wanted; });
  const bool is_listed = row != rows.end() && row->pair == key;
  // Of a row, however far it reaches.
  const double within_m =
      is_listed ? static_cast<double>(row->hi_m) + 1 : static_cast<double>(near_m_) + 0.01;
  const double distance = touches ? 0 : DistanceTree::distance(a, b, a_to_b_m, within_m);
  const bool is_near = distance <= static_cast<double>(near_m_);
  tally_.near += is_near;
  tally_.touching += touches;
  tally_.listed += is_listed;
  if (is_near && !touches && (tally_.near - tally_.touching) % kByAllEvery == 1) {
    const double by_all = DistanceTree::distance_by_all(a, b, a_to_b_m);
    const bool is_same = std::abs(by_all - distance) <= 1e-9;
    ++(is_same ? tally_.by_all : tally_.differing);
    if (!is_same) return fmt::format("{} m by the tree, {} m by all triangles", distance, by_all);
  }
  if (!is_listed) {
    if (!is_near) return "";
    ++tally_.missed;
    return fmt::format("missed at {} m", distance);
  }
  if (static_cast<double>(row->lo_m) > distance + kRounding_m ||
      static_cast<double>(row->hi_m) < distance - kRounding_m) {
    ++tally_.outside;
    return fmt::format("{} m, not within {} to {} m", distance, row->lo_m, row->hi_m);
  }
  if (row->level == PairLevel::kExact && row->hi_m - row->lo_m > 1e-3f) {
    ++tally_.wide;
    return fmt::format("{} to {} m by triangles", row->lo_m, row->hi_m);
  }
  return "";
}

NearRowsTally check_near_rows(bench::Family family, uint64_t pairs, uint64_t seed) {
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
  NearRowsTally tally;
  for (size_t frame = 0; tally.near < pairs; ++frame) {
    const bench::Couples world(family, kinds, draw);
    CullerOptions options;
    options.exact = frame % 2 == 1;
    options.simd = targets[frame / 2 % targets.size()];
    options.pair_search = kSearches[frame % std::size(kSearches)];
    options.near.near_m = kMargins_m[frame / 2 % std::size(kMargins_m)];
    Workers workers(1 + static_cast<int>(frame % 2));
    Culler culler(types, options, workers);
    culler.step(world.view(), world);
    const std::string how =
        fmt::format("{}, seed {}, frame {}, margin {} m, {}{}", bench::name_of(family), seed, frame,
                    options.near.near_m, name_of(options.simd), options.exact ? ", exact" : "");
    NearRowsJudge judge(options.near.near_m, tally);
    for (uint32_t a = 0; a < 2 * bench::Couples::kCouples; a += 2) {
      const uint32_t b = a + 1;
      const Eigen::Vector3d a_to_b = world.root(b) - world.root(a);
      std::vector<bench::PartBox> boxes_b;
      for (size_t j = 0; j < world.parts_of(b).size(); ++j) boxes_b.push_back(world.box(b, j));
      for (uint32_t i = 0; i < world.parts_of(a).size(); ++i) {
        const bench::PartBox box_a = world.box(a, i);
        for (uint32_t j = 0; j < world.parts_of(b).size(); ++j) {
          const bool touches =
              bench::PartBox::near(box_a, boxes_b[j], a_to_b) && world.touch(a, i, b, j);
          judge.judge({&trees[world.type(a)][i], &world.parts_of(a)[i], world.scale(a)},
                      {&trees[world.type(b)][j], &world.parts_of(b)[j], world.scale(b)}, a_to_b,
                      touches, PairKey(a, b, i, j), culler.near_pairs(), [&] {
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
