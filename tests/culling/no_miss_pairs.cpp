#include "tests/culling/no_miss_pairs.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "culling/culling.h"

namespace throng::test {
namespace {

void check_bodies(const bench::RandomPairs& world, uint32_t a, uint32_t b,
                  std::span<const PairKey> reported, const std::string& how, NoMissCounts& sum) {
  const Eigen::Vector3d shift = world.root(b) - world.root(a);
  std::vector<bench::PartBox> boxes_b;
  for (size_t j = 0; j < world.parts_of(b).size(); ++j) boxes_b.push_back(world.box(b, j));
  for (size_t i = 0; i < world.parts_of(a).size(); ++i) {
    const bench::PartBox box_a = world.box(a, i);
    for (size_t j = 0; j < boxes_b.size(); ++j) {
      if (!bench::PartBox::is_within_margin(box_a, boxes_b[j], shift)) continue;
      ++sum.tested;
      const PairKey key(a, b, static_cast<uint32_t>(i), static_cast<uint32_t>(j));
      const bool is_reported = std::binary_search(reported.begin(), reported.end(), key);
      sum.reported += is_reported;
      if (!world.touch(a, i, b, j)) continue;
      ++sum.touching;
      if (is_reported) continue;
      if (sum.missed++ == 0)
        sum.first_miss = fmt::format("{}: bodies {} and {}, parts {} and {}", how, a, b, i, j);
    }
  }
}

using Types = std::vector<std::shared_ptr<const BodyType>>;

constexpr PairSearch kSearches[] = {PairSearch::kGrid, PairSearch::kSweep, PairSearch::kBrute};

/// Checks one frame with the options against the scalar reference.
void check_frame(const bench::RandomPairs& world, const Types& types, CullerOptions options,
                 const std::string& how, NoMissCounts& sum) {
  Workers workers(1);
  Culler culler(types, options, workers);
  culler.step(world.view(), world);
  if (options.simd != SimdTarget::kScalar) {
    options.simd = SimdTarget::kScalar;
    Culler reference(types, options, workers);
    reference.step(world.view(), world);
    const auto found = culler.pairs(), expected = reference.pairs();
    if (!std::equal(found.begin(), found.end(), expected.begin(), expected.end()) &&
        sum.differing++ == 0)
      sum.first_difference =
          fmt::format("{}: {} pairs, the reference {}", how, found.size(), expected.size());
  }
  for (uint32_t a = 0; a < 2 * bench::RandomPairs::kPairs; a += 2)
    check_bodies(world, a, a + 1, culler.pairs(), how, sum);
}

Types types_of(const std::vector<bench::BodyKind>& kinds) {
  Types types;
  for (const bench::BodyKind& kind : kinds) types.push_back(kind.type);
  return types;
}

/// The same bodies with random volumes per part; a fifth of the parts have none.
Types mixed_types(const std::vector<bench::BodyKind>& kinds, bench::Draw& draw) {
  Types types;
  for (const bench::BodyKind& kind : kinds) {
    std::vector<PartShape> parts = kind.type->parts();
    for (PartShape& part : parts)
      if (draw.integer(0, 4) > 0)
        part.volume = kAllVolumes[draw.integer(0, static_cast<int>(std::size(kAllVolumes)) - 1)];
    types.push_back(std::make_shared<BodyType>(std::move(parts), kind.type->sphere(), false));
  }
  return types;
}

}  // namespace

NoMissCounts check_no_misses(Family family, uint64_t pairs, uint64_t seed) {
  const std::vector<SimdTarget> targets = simd_targets_of_this_machine();
  bench::Draw draw(seed, static_cast<uint64_t>(family));
  const std::vector<bench::BodyKind> kinds = bench::kinds_of(family, draw);
  const Types types = types_of(kinds);
  NoMissCounts sum;
  const size_t round = targets.size() * std::size(kAllVolumes);
  for (size_t frame = 0; sum.tested < pairs || frame % round != 0; ++frame) {
    CullerOptions options;
    options.part_volume = kAllVolumes[frame / targets.size() % std::size(kAllVolumes)];
    options.simd = targets[frame % targets.size()];
    options.pair_search = kSearches[frame / 3 % std::size(kSearches)];
    options.exact = family == Family::kMixed;
    const bench::RandomPairs world(family, kinds, draw);
    check_frame(world, types, options,
                fmt::format("{}, seed {}, frame {}, {}, {}", name_of(family), seed, frame,
                            throng::name_of(options.part_volume), throng::name_of(options.simd)),
                sum);
  }
  return sum;
}

NoMissCounts check_mixtures(Family family, int maps, uint64_t seed) {
  const std::vector<SimdTarget> targets = simd_targets_of_this_machine();
  bench::Draw draw(seed, 1000 + static_cast<uint64_t>(family));
  const std::vector<bench::BodyKind> kinds = bench::kinds_of(family, draw);
  const Types single = types_of(kinds);
  Workers two(2);
  NoMissCounts sum;
  for (int map = 0; map < maps; ++map) {
    const Types types = mixed_types(kinds, draw);
    const bench::RandomPairs world(family, kinds, draw);
    std::optional<uint64_t> hash;
    for (const SimdTarget target : targets)
      for (const PairSearch search : kSearches) {
        CullerOptions options{.pair_search = search, .simd = target};
        options.part_volume = kAllVolumes[static_cast<size_t>(map) % std::size(kAllVolumes)];
        const std::string how = fmt::format("{}, seed {}, map {}, {}", name_of(family), seed, map,
                                            throng::name_of(target));
        if (family != Family::kMixed) check_frame(world, types, options, how, sum);
        Culler again(types, options, two);
        again.step(world.view(), world);
        if (again.hash() != hash.value_or(again.hash()) && sum.differing++ == 0)
          sum.first_difference = how + ": different hash";
        hash = again.hash();
      }
    // With triangles the volumes do not affect the result.
    Culler exact(types, {.exact = true}, two), same(single, {.exact = true}, two);
    exact.step(world.view(), world);
    same.step(world.view(), world);
    if (exact.hash() != same.hash() && sum.differing++ == 0)
      sum.first_difference = fmt::format("{}, seed {}, map {}: different pairs with triangles",
                                         name_of(family), seed, map);
  }
  return sum;
}

}  // namespace throng::test
