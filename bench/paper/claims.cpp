#include "bench/paper/claims.h"

#include <fmt/format.h>

#include <algorithm>

namespace throng::paper {
namespace {

size_t method_of(std::string_view name) {
  return static_cast<size_t>(std::find(kMethods.begin(), kMethods.end(), name) - kMethods.begin());
}

bool compare(double left, double right, const std::string& relation) {
  return relation == ">" ? left > right : left >= right;
}

Claim collision_claim(const PaperResult& result, std::span<const CensusTable> censuses,
                      const std::string& left, const std::string& relation,
                      const std::string& right) {
  const size_t l = method_of(left), r = method_of(right);
  Claim claim{"Table 2", left, right, 0, 0, relation, 0, false};
  claim.left_value = result.volumes[l].collisions.back();
  claim.right_value = result.volumes[r].collisions.back();
  claim.holds = compare(claim.left_value, claim.right_value, relation);
  size_t count = 0;
  for (const CensusTable& table : censuses)
    count += compare(static_cast<double>(table[l].collisions.back()),
                     static_cast<double>(table[r].collisions.back()), relation);
  claim.share = static_cast<double>(count) / static_cast<double>(censuses.size());
  return claim;
}

void judge_table_2(const PaperResult& result, std::span<const CensusTable> censuses,
                   std::vector<Claim>& claims) {
  const auto add = [&](const std::string& left, const char* relation, const std::string& right) {
    claims.push_back(collision_claim(result, censuses, left, relation, right));
  };
  for (const char* aabb : {"aabb", "aabb_turned"}) {
    add("sphere", ">", aabb);
    add(aabb, ">", "obb");
  }
  for (const char* k : {"14", "18", "26"}) {
    const std::string ordop = std::string("ordop") + k;
    for (const char* rule : {"", "_refit"}) {
      const std::string kdop = std::string("kdop") + k + rule;
      add("obb", ">", kdop);
      add(kdop, ">=", ordop);
    }
    add(ordop, ">=", "exact");
  }
}

/// The headline of Part I, Table 3 with Fig. 9 and 10: T of the sphere is the least, that of the
/// or-DOP the next; with what building costs once, and without.
void judge_table_3(const PaperResult& result, std::vector<Claim>& claims) {
  for (const int length : {kRunLengths.front(), kRunLengths.back()})
    for (const bool is_built : {true, false}) {
      const auto total_ms = [&](const std::string& name) {
        const VolumeResult& volume = result.volumes[method_of(name)];
        return volume.total_ms(length) -
               (is_built ? 0 : volume.costs.construction_all.median_ns * 1e-6);
      };
      const auto add = [&](const std::string& more, const std::string& less) {
        Claim claim{fmt::format("Table 3, T in ms {} C_o, {} frames", is_built ? "with" : "without",
                                length * result.options.frames),
                    more,
                    less,
                    total_ms(more),
                    total_ms(less),
                    ">",
                    0,
                    false};
        claim.holds = compare(claim.left_value, claim.right_value, claim.relation);
        claim.share = claim.holds ? 1 : 0;
        claims.push_back(claim);
      };
      add("ordop26", "sphere");
      for (const char* other : {"kdop26", "kdop26_refit", "aabb_turned", "aabb", "obb"}) {
        add(other, "sphere");
        add(other, "ordop26");
      }
    }
}

/// Fig. 13 from the fastest to the slowest.
constexpr std::array<Strategy, 6> kFigure13 = {Strategy::kControl,   Strategy::kHybridOne,
                                               Strategy::kSphere,    Strategy::kTwoPass,
                                               Strategy::kHybridAll, Strategy::kOrdop};

void judge_figure_13(const Scale& scale, std::vector<Claim>& claims) {
  const auto cost = [&](Strategy s) -> const StrategyCost& {
    return scale.strategies[static_cast<size_t>(s)];
  };
  for (size_t i = 0; i + 1 < kFigure13.size(); ++i) {
    const StrategyCost& fast = cost(kFigure13[i]);
    const StrategyCost& slow = cost(kFigure13[i + 1]);
    const std::string objects = std::to_string(scale.objects) + " objects, ";
    const auto a_frame = [](const StrategyCost& each) {
      return each.culling_ms / each.result.frames;
    };
    Claim counted{"Fig. 13, " + objects + "counted ms a frame",
                  slow.name(),
                  fast.name(),
                  0,
                  0,
                  ">=",
                  0,
                  false};
    counted.left_value = a_frame(slow);
    counted.right_value = a_frame(fast);
    Claim measured{"Fig. 13, " + objects + "measured frames/s",
                   fast.name(),
                   slow.name(),
                   0,
                   0,
                   ">=",
                   0,
                   false};
    measured.left_value = fast.result.fps();
    measured.right_value = slow.result.fps();
    for (Claim* claim : {&counted, &measured}) {
      claim->holds = claim->left_value >= claim->right_value;
      claim->share = claim->holds ? 1 : 0;
      claims.push_back(*claim);
    }
  }
}

/// Those that look at all pairs of all objects.
bool answers(Strategy strategy) {
  return strategy != Strategy::kControl && strategy != Strategy::kHybridOne;
}

template <typename Measure>
void add_winners(std::span<const Scale> scales, const char* name, bool with_grid,
                 const Measure& measure, std::vector<Winner>& winners) {
  std::string last;
  for (const Scale& scale : scales) {
    const StrategyCost* best = nullptr;
    for (const StrategyCost& each : scale.strategies) {
      if (!answers(each.strategy)) continue;
      if (!with_grid && each.strategy == Strategy::kTwoPassGrid) continue;
      if (best == nullptr || measure(each) < measure(*best)) best = &each;
    }
    if (best == nullptr || best->name() == last) continue;
    last = best->name();
    winners.push_back({name, scale.objects, last});
  }
}

}  // namespace

std::vector<Claim> judge(const PaperResult& result, std::span<const CensusTable> censuses) {
  std::vector<Claim> claims;
  judge_table_2(result, censuses, claims);
  judge_table_3(result, claims);
  for (const size_t size : {size_t{50}, size_t{350}, size_t{500}})
    judge_figure_13(*result.scale(size), claims);
  return claims;
}

std::vector<Winner> find_winners(std::span<const Scale> scales) {
  const auto frames = [](const StrategyCost& each) { return each.result.frames; };
  const auto counted = [&](const StrategyCost& each) { return each.culling_ms / frames(each); };
  const auto measured = [](const StrategyCost& each) { return each.result.frame_ms; };
  const auto exact = [&](const StrategyCost& each) { return each.exact_ms / frames(each); };
  std::vector<Winner> winners;
  for (const bool with_grid : {false, true}) {
    const auto add = [&](const char* name, const auto& measure) {
      add_winners(scales, name, with_grid, measure, winners);
    };
    add(with_grid ? "culling, counted, grid allowed" : "culling, counted", counted);
    add(with_grid ? "culling, measured, grid allowed" : "culling, measured", measured);
    add(with_grid ? "to the triangles, counted, grid allowed" : "to the triangles, counted",
        [&](const StrategyCost& each) { return counted(each) + exact(each); });
    add(with_grid ? "to the triangles, measured, grid allowed" : "to the triangles, measured",
        [&](const StrategyCost& each) { return measured(each) + exact(each); });
  }
  return winners;
}

}  // namespace throng::paper
