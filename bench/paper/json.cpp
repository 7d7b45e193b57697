#include "bench/paper/json.h"

#include <nlohmann/json.hpp>

#include "bench/paper/published.h"
#include "bench/version_json.h"

namespace throng::paper {
namespace {

using Json = nlohmann::ordered_json;

Json spread_of(const Cost& cost) {
  return {{"median_ns", cost.median_ns},
          {"p10_ns", cost.low_ns},
          {"p90_ns", cost.high_ns},
          {"repetitions", cost.repetitions}};
}

/// What is known before anything was timed.
Json counts_json(const VolumeResult& volume) {
  Json json;
  json["collisions"] = volume.collisions;
  json["collisions_deviation"] = volume.deviation;
  json["n_v"] = volume.census.tests;
  json["n_u"] = volume.census.updates;
  json["n_u_paper_way"] = volume.census.updates_paper();
  return json;
}

Json to_json(const VolumeResult& volume) {
  Json json = counts_json(volume);
  json["c_v_ns"] = volume.costs.test.median_ns;
  json["c_u_ns"] = volume.costs.update.median_ns;
  json["c_o_ns"] = volume.costs.construction_all.median_ns;
  json["total_ms"] = volume.total_ms();
  json["total_paper_way_ms"] = volume.total_paper_way_ms();
  json["false_positive_rate"] = volume.false_positive_rate;
  json["overlap_volume_l"] = volume.overlap.litres;
  json["overlap_volume_error_l"] = volume.overlap.error_l;
  json["overlap_volume_by_object_l"] = volume.overlap.by_object_l;
  json["missed"] = volume.missed;
  json["fps"] = volume.frames * 1e3 / volume.costs.run_ms[0];
  json["long_collisions"] = volume.long_collisions;
  for (size_t i = 0; i < kRunLengths.size(); ++i)
    json["runs"].push_back({{"frames", kRunLengths[i] * volume.frames},
                            {"total_ms", volume.total_ms(kRunLengths[i])},
                            {"clock_ms", volume.costs.run_ms[i]}});
  json["c_v"] = spread_of(volume.costs.test);
  json["c_u"] = spread_of(volume.costs.update);
  json["c_o"] = spread_of(volume.costs.construction_all);
  for (const Cost& cost : volume.costs.construction)
    json["c_o_by_object_ns"].push_back(cost.median_ns);
  if (volume.census.primitives > 0) {
    json["n_p"] = volume.census.primitives;
    json["c_p_ns"] = volume.costs.primitive_ns;
  }
  return json;
}

Json to_json(const StrategyCost& cost) {
  const Work& work = cost.result.work;
  return {{"frames", cost.result.frames},
          {"fps", cost.result.fps()},
          {"frame_ms", cost.result.frame_ms},
          {"frame_ms_median", cost.result.median_ms},
          {"frame_ms_p10", cost.result.low_ms},
          {"frame_ms_p90", cost.result.high_ms},
          {"tests", work.tests()},
          {"updates", work.updates()},
          {"sphere_tests", work.sphere_tests},
          {"sphere_updates", work.sphere_updates},
          {"ordop_tests", work.ordop_tests},
          {"ordop_updates", work.ordop_updates},
          {"pairs", work.passed},
          {"n_p", work.primitives},
          {"culling_ms", cost.culling_ms},
          {"c_o_ms", cost.built_ms},
          {"n_p_c_p_ms", cost.exact_ms},
          {"total_ms", cost.total_ms()}};
}

Json to_json(const Scale& scale) {
  Json json;
  for (const StrategyCost& cost : scale.strategies) json[cost.name()] = to_json(cost);
  return json;
}

}  // namespace

std::string to_json(const PaperResult& result, const std::string& cpu) {
  Json json;
  json["throng"] = version_json();
  json["stopped_early"] = result.done < Done::kAll;
  json["frames"] = result.options.frames;
  json["seed"] = result.options.seed;
  json["seeds"] = result.options.seeds;
  json["objects"] = result.objects;
  json["elongations"] = result.elongations;
  json["box_edge_m"] = result.edge_m;
  if (result.done >= Done::kCosts)
    for (const VolumeResult& volume : result.volumes)
      json["volumes"][volume.name] = to_json(volume);
  else if (result.done >= Done::kCollisions)
    for (const VolumeResult& volume : result.volumes)
      json["volumes"][volume.name] = counts_json(volume);
  if (const Scale* shown = result.scale(500)) json["strategies"] = to_json(*shown);
  for (const PublishedVolume& row : kPublished)
    json["paper_totals"].push_back({{"volume", row.volume},
                                    {"printed", row.total_ms},
                                    {"computed", row.computed_ms()},
                                    {"error", row.error()}});
  for (const Scale& scale : result.scales)
    json["scaling"].push_back({{"objects", scale.objects}, {"strategies", to_json(scale)}});
  for (const Winner& winner : result.winners)
    json["crossings"].push_back({{"measure", winner.measure},
                                 {"from_objects", winner.objects},
                                 {"cheapest", winner.strategy}});
  for (const Claim& claim : result.claims)
    json["claims"].push_back({{"about", claim.about},
                              {"left", claim.left},
                              {"relation", claim.relation},
                              {"right", claim.right},
                              {"left_value", claim.left_value},
                              {"right_value", claim.right_value},
                              {"share_of_seeds", claim.share},
                              {"holds", claim.holds}});
  json["noise"] = result.noise();
  json["machine"] = {{"cpu", cpu}, {"simd", name_of(resolved(SimdTarget::kBest))}};
  return json.dump(2) + "\n";
}

}  // namespace throng::paper
