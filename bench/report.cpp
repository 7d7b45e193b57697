#include "bench/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "bench/version_json.h"

namespace throng::bench {
namespace {

using Json = nlohmann::ordered_json;

double ratio(double a, double b) { return b > 0 ? a / b : 0; }

Json crowd_json(const BenchOptions& options) {
  return {{"crowd", options.crowd == CrowdKind::kPlaza ? "plaza" : "square"},
          {"avatars", options.avatars},
          {"density_per_m2", options.per_m2},
          {"frames", options.frames},
          {"threads", options.threads},
          {"seed", options.seed}};
}

void put_engine(std::string& out, const EngineResult& engine) {
  if (engine.agrees)
    append(out, "  {:<22}{:>9.3f}{:>9.3f}{:>9.3f}{:>11}{:>9.2f}{:>9.2f}  {}\n",
           engine.name + " " + engine.version, engine.ms.min, engine.ms.median, engine.ms.p95,
           engine.pairs, engine.ratio, engine.ratio_boxes, engine.what);
  else
    append(out, "  {:<22}no time: its {} pairs differ from the reference\n",
           engine.name + " " + engine.version, engine.pairs);
}

void put_quarters(std::string& out, const BenchResult& r) {
  if (r.quarters.empty()) return;
  append(out, "\n  {:<22}{:>9}{:>11}", "as the crowd mixes", "throng ms", "pairs");
  for (const EngineResult& engine : r.engines) append(out, "{:>9}", engine.name);
  for (const Quarter& quarter : r.quarters) {
    append(out, "\n  {:<22}{:>9.3f}{:>11}",
           fmt::format("frames {} to {}", quarter.first, quarter.last), quarter.ms, quarter.pairs);
    for (size_t i = 0; i < r.engines.size(); ++i)
      append(out, "{:>9}", r.engines[i].agrees ? fmt::format("{:.2f}", quarter.ratios[i]) : "-");
  }
  append(out, "\n");
}

Json quarters_json(const BenchResult& r) {
  Json out = Json::array();
  for (const Quarter& quarter : r.quarters) {
    Json row = {{"first_frame", quarter.first},
                {"last_frame", quarter.last},
                {"pairs", quarter.pairs},
                {"ms", quarter.ms}};
    for (size_t i = 0; i < r.engines.size(); ++i)
      if (r.engines[i].agrees) row["ratio"][r.engines[i].name] = quarter.ratios[i];
    out.push_back(row);
  }
  return out;
}

}  // namespace

std::string to_text(const BenchResult& r, const MachineLine& machine) {
  std::string out;
  append(out, "{}{}: {} avatars, {:.4g} per m2, {} frames, {} thread{}, {} on {}\n\n",
         r.options.crowd == CrowdKind::kPlaza ? "plaza" : "square",
         r.options.model.empty() ? "" : ", " + r.options.model, r.options.avatars, r.options.per_m2,
         r.options.frames, r.options.threads, r.options.threads == 1 ? "" : "s", r.throng.simd,
         machine.cpu);
  append(out, "  {:<22}{:>9}{:>9}{:>9}{:>11}{:>9}{:>9}\n", "", "min ms", "median", "p95", "pairs",
         "/ throng", "/ boxes");
  const ThrongResult& t = r.throng;
  const std::string name = "throng ordop26";
  append(out, "  {:<22}{:>9.3f}{:>9.3f}{:>9.3f}{:>11}{:>9}{:>9}  {}\n", name, t.ms.min, t.ms.median,
         t.ms.p95, t.pairs, "1", "", "kinematics, boxes, or-DOP 26, sorted pairs, begin/end");
  append(out, "  {:<22}{:>9.3f}{:>9.3f}{:>9.3f}{:>11}{:>9}{:>9}  {}\n", "throng boxes",
         t.boxes_ms.min, t.boxes_ms.median, t.boxes_ms.p95, t.box_pairs, "", "1",
         "without or-DOP tests, sorting and events");
  for (const EngineResult& engine : r.engines) put_engine(out, engine);
  for (const Skipped& skipped : r.skipped)
    append(out, "  {:<22}skipped: {}\n", skipped.name, skipped.reason);
  put_quarters(out, r);
  append(out, "\n  {:<22}{:<10}{:>11}{:>12}{:>11}{:>10}\n", "throng stages", "volume", "updates",
         "tests", "passed", "ms");
  for (const StageRow& stage : t.stages)
    append(out, "  {:<22}{:<10}{:>11}{:>12}{:>11}{:>10.3f}\n", stage.stage, stage.volume,
           stage.updates, stage.tests, stage.passed, stage.ms);
  append(out, "\n  {:.2f} kB of memory per avatar, whole process{}; hash {:016x}\n",
         static_cast<double>(machine.peak_rss_bytes) / 1e3 / r.options.avatars,
         r.engines.empty() ? "" : " including the engines", t.hash);
  return out;
}

std::string to_json(const BenchResult& r, const MachineLine& machine) {
  Json json = crowd_json(r.options);
  Json stages = Json::array();
  for (const StageRow& s : r.throng.stages)
    stages.push_back({{"stage", s.stage},
                      {"volume", s.volume},
                      {"updates", s.updates},
                      {"tests", s.tests},
                      {"passed", s.passed},
                      {"ms", s.ms}});
  json["throng"] = version_json();
  json["throng"].update(Json{{"ms", r.throng.ms.median},
                             {"ms_min", r.throng.ms.min},
                             {"ms_p95", r.throng.ms.p95},
                             {"pairs", r.throng.pairs},
                             {"simd", r.throng.simd},
                             {"boxes_ms", r.throng.boxes_ms.median},
                             {"box_pairs", r.throng.box_pairs},
                             {"hash", fmt::format("{:016x}", r.throng.hash)},
                             {"stages", stages}});
  json["quarters"] = quarters_json(r);
  json["engines"] = Json::array();
  for (const EngineResult& e : r.engines) {
    Json row = {{"name", e.name}, {"version", e.version}, {"what", e.what}};
    row["ms"] = e.agrees ? Json(e.ms.median) : Json(nullptr);
    row["pairs"] = e.pairs;
    row["agrees"] = e.agrees;
    if (e.agrees) {
      row["ms_min"] = e.ms.min;
      row["ms_p95"] = e.ms.p95;
      row["ratio"] = e.ratio;
      row["ratio_boxes"] = e.ratio_boxes;
    }
    json["engines"].push_back(row);
  }
  json["skipped"] = Json::array();
  for (const Skipped& s : r.skipped)
    json["skipped"].push_back({{"name", s.name}, {"reason", s.reason}});
  const auto or_null = [](double value) { return value > 0 ? Json(value) : Json(nullptr); };
  json["ratio_fastest"] = or_null(r.ratio_fastest());
  json["ratio_fcl"] = or_null(r.ratio_fcl());
  json["peak_rss_bytes"] = machine.peak_rss_bytes;
  json["cpu"] = machine.cpu;
  return json.dump(2) + "\n";
}

std::string csv_header() {
  return "avatars,per_m2,threads,frames,simd,engine,version,ms_min,ms_median,ms_p95,pairs,ratio,"
         "crowd\n";
}

std::string to_csv(const BenchResult& r) {
  std::string out;
  const auto put = [&](const std::string& name, const std::string& version, const TimeStats& ms,
                       uint64_t pairs, double throng_ratio) {
    append(out, "{},{},{},{},{},{},{},{:.4f},{:.4f},{:.4f},{},{:.3f},{}\n", r.options.avatars,
           r.options.per_m2, r.options.threads, r.options.frames, r.throng.simd, name, version,
           ms.min, ms.median, ms.p95, pairs, throng_ratio,
           r.options.crowd == CrowdKind::kPlaza ? "plaza" : "square");
  };
  const ThrongResult& t = r.throng;
  put("throng", "ordop26", t.ms, t.pairs, 1);
  put("throng_boxes", "boxes", t.boxes_ms, t.box_pairs, ratio(t.boxes_ms.median, t.ms.median));
  for (const EngineResult& e : r.engines)
    if (e.agrees) put(e.name, e.version, e.ms, e.pairs, e.ratio);
  return out;
}

std::string to_text(const AgeingResult& r) {
  std::string out;
  append(out, "After {} frames of walking, ms per frame\n\n  {:<22}{:>12}{:>12}{:>9}{:>12}\n",
         r.walked_frames, "", "fresh", "aged", "ratio", "/ throng");
  append(out, "  {:<22}{:>12.3f}{:>12.3f}{:>9.2f}{:>12}  updates and tests: {} fresh, {} aged\n",
         "throng ordop26", r.fresh_ms, r.aged_ms, ratio(r.aged_ms, r.fresh_ms), 1, r.fresh_work,
         r.aged_work);
  for (const AgedEngine& e : r.engines) {
    const std::string name = e.name + " " + e.version;
    if (e.agrees)
      append(out, "  {:<22}{:>12.3f}{:>12.3f}{:>9.2f}{:>12.1f}\n", name, e.fresh_ms, e.aged_ms,
             ratio(e.aged_ms, e.fresh_ms), ratio(e.aged_ms, r.aged_ms));
    else
      append(out, "  {:<22}no time: its pairs differ from the reference\n", name);
  }
  return out;
}

std::string to_json(const AgeingResult& r, const BenchOptions& options,
                    const MachineLine& machine) {
  Json json = crowd_json(options);
  json["walked_frames"] = r.walked_frames;
  json["throng"] = version_json();
  json["throng"].update(Json{{"fresh_ms", r.fresh_ms},
                             {"aged_ms", r.aged_ms},
                             {"fresh_work", r.fresh_work},
                             {"aged_work", r.aged_work}});
  json["engines"] = Json::array();
  for (const AgedEngine& e : r.engines)
    json["engines"].push_back({{"name", e.name},
                               {"version", e.version},
                               {"fresh_ms", e.fresh_ms},
                               {"aged_ms", e.aged_ms},
                               {"agrees", e.agrees}});
  json["cpu"] = machine.cpu;
  return json.dump(2) + "\n";
}

std::string to_text(const FalsePositives& r) {
  std::string out;
  append(out, "{} pairs of avatars, {} of parts, {} truly touching\n\n", r.avatar_pairs, r.tests,
         r.touching);
  append(out, "  {:<18}{:>12}{:>20}{:>9}\n", "volume", "reported", "reported per true", "missed");
  for (const VolumeReport& v : r.volumes)
    append(out, "  {:<18}{:>12}{:>20.3f}{:>9}\n", v.name, v.reported,
           ratio(static_cast<double>(v.reported), static_cast<double>(r.touching)), v.missed);
  append(out, "\n{}, part by part: tests / passed / false positives\n\n  {:<16}", r.matrix_volume,
         "");
  for (const std::string& part : r.parts) append(out, "{:>22}", part);
  for (size_t a = 0; a < r.parts.size(); ++a) {
    append(out, "\n  {:<16}", r.parts[a]);
    for (size_t b = 0; b < r.parts.size(); ++b) {
      const PartCell& cell = r.cell(std::min(a, b), std::max(a, b));
      append(out, "{:>22}",
             fmt::format("{}/{}/{}", cell.tests, cell.passed, cell.passed - cell.touching));
    }
  }
  return out + "\n";
}

std::string to_json(const FalsePositives& r, const BenchOptions& options) {
  Json json = crowd_json(options);
  json["throng"] = version_json();
  json["tests"] = r.tests;
  json["touching"] = r.touching;
  for (const VolumeReport& v : r.volumes)
    json["volumes"][v.name] = {
        {"reported", v.reported},
        {"per_true", ratio(static_cast<double>(v.reported), static_cast<double>(r.touching))},
        {"missed", v.missed}};
  json["matrix_volume"] = r.matrix_volume;
  json["matrix"] = Json::array();
  for (size_t a = 0; a < r.parts.size(); ++a)
    for (size_t b = a; b < r.parts.size(); ++b) {
      const PartCell& cell = r.cell(a, b);
      json["matrix"].push_back({{"a", r.parts[a]},
                                {"b", r.parts[b]},
                                {"tests", cell.tests},
                                {"passed", cell.passed},
                                {"false_positives", cell.passed - cell.touching}});
    }
  return json.dump(2) + "\n";
}

}  // namespace throng::bench
