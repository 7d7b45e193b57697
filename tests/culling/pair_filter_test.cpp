// PairFilter drops exactly the pairs that are not selected: contacts and proximity rows equal those
// of an unfiltered run, filtered one by one.
#include "culling/pair_filter.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "base/errors.h"
#include "culling/strategies/paper_culler.h"
#include "tests/culling/random_bodies.h"

namespace throng::pair_filter_test {
namespace {

using test::BodyDraw;
using test::RandomBodies;

TEST(PairFilter, MatchesOneOfEachSide) {
  const auto left = PairFilter::left_of(3), right = PairFilter::right_of(3);
  EXPECT_TRUE(PairFilter::match(left, right));
  EXPECT_TRUE(PairFilter::match(right, left));
  EXPECT_FALSE(PairFilter::match(left, left));
  EXPECT_FALSE(PairFilter::match(right, right));
  EXPECT_FALSE(PairFilter::match(left, PairFilter::right_of(4)));
  EXPECT_TRUE(PairFilter::match(left | right, left)) << "on both sides: also with each other";
  EXPECT_FALSE(PairFilter::match(0, left | right));
  EXPECT_TRUE(PairFilter::match(PairFilter::left_of(15), PairFilter::right_of(15)));
}

/// Random rules. A third of the filters select bodies only, a third parts only.
PairFilter random_filter(const RandomBodies& world, BodyDraw& draw, uint64_t seed) {
  const int rules = draw.integer(1, PairFilter::kMaxRules);
  const auto sides = [&] {
    PairFilter::Sides out = 0;
    for (int rule = 0; rule < rules; ++rule) {
      if (draw.integer(0, 3) == 0) out |= PairFilter::left_of(rule);
      if (draw.integer(0, 3) == 0) out |= PairFilter::right_of(rule);
    }
    return out;
  };
  PairFilter filter;
  if (seed % 3 != 1)
    for (uint32_t id = 0; id <= world.ids.back() - 2; ++id) filter.sides_of_body.push_back(sides());
  if (seed % 3 != 2)
    for (const auto& type : world.types) {
      filter.sides_of_part.emplace_back();
      for (int part = 0; part < type->part_count(); ++part)
        filter.sides_of_part.back().push_back(sides());
    }
  return filter;
}

/// Reference: rule by rule.
bool is_included(const PairFilter& filter, const RandomBodies& world, const PairKey& key) {
  const auto match = [](PairFilter::Sides a, PairFilter::Sides b) {
    for (int rule = 0; rule < PairFilter::kMaxRules; ++rule) {
      const auto left = PairFilter::left_of(rule), right = PairFilter::right_of(rule);
      if (((a & left) != 0 && (b & right) != 0) || ((b & left) != 0 && (a & right) != 0))
        return true;
    }
    return false;
  };
  const auto type_of = [&](uint32_t id) {
    const auto at = std::lower_bound(world.ids.begin(), world.ids.end(), id) - world.ids.begin();
    return world.type_of[static_cast<size_t>(at)];
  };
  const auto sides_of_body = [&](uint32_t id) {
    return id < filter.sides_of_body.size() ? filter.sides_of_body[id] : 0;
  };
  if (!filter.sides_of_body.empty() && !match(sides_of_body(key.a()), sides_of_body(key.b())))
    return false;
  return filter.sides_of_part.empty() ||
         match(filter.sides_of_part[type_of(key.a())][key.part_a()],
               filter.sides_of_part[type_of(key.b())][key.part_b()]);
}

struct Answer {
  std::vector<PairKey> pairs;
  std::vector<std::tuple<PairKey, float, float>> proximity;
};

Answer answer(const RandomBodies& world, const CullerOptions& options, int threads) {
  Workers workers(threads);
  Culler culler(world.types, options, workers);
  culler.step(world.view(), world);
  Answer out{{culler.pairs().begin(), culler.pairs().end()}, {}};
  for (const ProximityPair& row : culler.proximity_pairs())
    out.proximity.emplace_back(row.pair, row.lo_m, row.hi_m);
  return out;
}

TEST(PairFilter, KeepsSelectedPairsAsWithoutAFilter) {
  constexpr PairSearch kSearches[] = {PairSearch::kGrid, PairSearch::kSweep, PairSearch::kBrute};
  uint64_t kept = 0, left_out = 0;
  for (uint64_t seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    const RandomBodies world(seed, 60, 2.5, Eigen::Vector3d::Zero());
    CullerOptions options;
    options.exact = seed % 2 == 0;
    options.proximity.margin_m = 0.2f;
    options.pair_search = kSearches[seed % 3];
    if (seed % 5 == 0) options.budget_tests = 1'000'000'000;
    Answer whole = answer(world, options, 1);
    BodyDraw draw(seed);
    options.filter = random_filter(world, draw, seed);
    const Answer sifted = answer(world, options, 1 + static_cast<int>(seed % 3));
    const size_t pairs = whole.pairs.size();
    std::erase_if(whole.pairs,
                  [&](const PairKey& key) { return !is_included(options.filter, world, key); });
    std::erase_if(whole.proximity, [&](const auto& row) {
      return !is_included(options.filter, world, std::get<0>(row));
    });
    EXPECT_EQ(sifted.pairs, whole.pairs);
    EXPECT_EQ(sifted.proximity, whole.proximity);
    kept += whole.pairs.size();
    left_out += pairs - whole.pairs.size();
  }
  EXPECT_GT(kept, 1000u);
  EXPECT_GT(left_out, 1000u);
}

/// One body among many: no other bodies are posed.
TEST(PairFilter, PosesSelectedBodiesOnly) {
  const RandomBodies world(3, 300, 6, Eigen::Vector3d::Zero());
  const auto posed = [&](const CullerOptions& options) {
    Workers workers(1);
    Culler culler(world.types, options, workers);
    culler.step(world.view(), world);
    return culler.counters().posed_bodies;
  };
  CullerOptions options;
  const uint64_t all = posed(options);
  options.filter.sides_of_body.assign(world.ids.back() + 1, PairFilter::right_of(0));
  options.filter.sides_of_body[world.ids[60]] = PairFilter::left_of(0);
  const uint64_t filtered = posed(options);
  EXPECT_GT(all, 100u);
  EXPECT_GT(filtered, 0u);
  EXPECT_LT(filtered, all / 2);
}

TEST(PairFilter, RejectsOtherTypesAndStrategies) {
  const RandomBodies world(3, 20, 2.5, Eigen::Vector3d::Zero());
  Workers workers(1);
  CullerOptions options;
  options.filter.sides_of_part = {{PairFilter::left_of(0)}};
  EXPECT_THROW(Culler(world.types, options, workers), InputError);
  options.filter = {};
  options.filter.sides_of_body = {PairFilter::left_of(0)};
  EXPECT_THROW(PaperCuller(world.types, Strategy::kTwoPass, options), InputError);
}

}  // namespace
}  // namespace throng::pair_filter_test
