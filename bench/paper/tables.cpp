#include "bench/paper/tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "bench/paper/published.h"
#include "bench/version_json.h"

namespace throng::paper {
namespace {

std::string number(double value) { return fmt::format("{:.4g}", value); }
std::string plain(uint64_t value) { return fmt::format("{}", value); }

std::string spread(const Cost& cost) {
  return fmt::format("{:.4g} ({:.4g}..{:.4g})", cost.median_ns, cost.low_ns, cost.high_ns);
}

std::string printed_collision(const VolumeResult& volume, size_t mark) {
  const PublishedVolume* published = published_for(volume.name);
  return published == nullptr ? "-" : std::string(published->collisions[mark]);
}

Table table_2(const PaperResult& result) {
  Table table;
  table.title = "Table 2, Fig. 7: accumulated collisions";
  table.note = fmt::format(
      "Overlapping pairs summed over the frames; mean{} of {} seed(s). The paper's number follows "
      "the bar; ? is a digit lost in print. False positives: found pairs that do not touch.",
      result.options.seeds > 1 ? " +- standard deviation" : "", result.options.seeds);
  table.head = {"volume"};
  for (size_t mark = 1; mark <= kMarks; ++mark)
    table.head.push_back(
        fmt::format("{}", mark * static_cast<size_t>(result.options.frames) / kMarks));
  table.head.push_back("false positives");
  table.head.push_back("missed");
  for (const VolumeResult& volume : result.volumes) {
    std::vector<std::string> row = {volume.name};
    for (size_t mark = 0; mark < kMarks; ++mark) {
      std::string cell = fmt::format("{:.5g}", volume.collisions[mark]);
      if (result.options.seeds > 1) cell += fmt::format("+-{:.3g}", volume.deviation[mark]);
      row.push_back(cell + " | " + printed_collision(volume, mark));
    }
    row.push_back(fmt::format("{:.1f} %", 100 * volume.false_positive_rate));
    row.push_back(plain(volume.missed));
    table.rows.push_back(std::move(row));
  }
  return table;
}

Table table_3(const PaperResult& result) {
  Table table;
  table.title = "Table 3, Fig. 9: total cost T = N_u C_u + N_v C_v + C_o";
  table.note =
      "Nanoseconds: median (10th..90th percentile). N_u counts updates where they happen; 'T, "
      "paper's count' counts two updates per test, as in the paper. The paper's T is taken as "
      "milliseconds.";
  table.head = {"volume",      "N_v",    "C_v ns", "N_u",
                "C_u ns",      "C_o ns", "T ms",   "T ms, paper's count",
                "paper's T ms"};
  for (const VolumeResult& volume : result.volumes) {
    const PublishedVolume* published = published_for(volume.name);
    table.rows.push_back({volume.name, plain(volume.census.tests), spread(volume.costs.test),
                          plain(volume.census.updates), spread(volume.costs.update),
                          spread(volume.costs.construction_all), number(volume.total_ms()),
                          number(volume.total_paper_count_ms()),
                          published == nullptr ? "-" : number(published->total_ms)});
  }
  return table;
}

Table formula_check() {
  Table table;
  table.title = "The formula on the paper's own numbers";
  table.note = "N_u C_u + N_v C_v + C_o of Table 3 as printed, and the T printed with them.";
  table.head = {"volume", "printed ms", "computed ms", "error"};
  for (const PublishedVolume& row : kPublished)
    table.rows.push_back({std::string(row.volume), fmt::format("{}", row.total_ms),
                          fmt::format("{:.4f}", row.computed_ms()),
                          fmt::format("{:.4f} %", 100 * row.error())});
  return table;
}

Table table_of_figure_6(const PaperResult& result) {
  Table table;
  table.title = "Fig. 6: construction time by object, microseconds";
  table.note = "Median of 100 repetitions (exact: 10). The paper prints its sums only, as C_o.";
  table.head = {"object"};
  std::vector<const VolumeResult*> shown;
  for (const VolumeResult& volume : result.volumes) {
    if (volume.name.ends_with("_refit") || volume.name.ends_with("_turned"))
      continue;  // constructed in the same way
    shown.push_back(&volume);
    table.head.push_back(volume.name);
  }
  for (size_t i = 0; i < result.objects.size(); ++i) {
    std::vector<std::string> row = {result.objects[i]};
    for (const VolumeResult* volume : shown)
      row.push_back(number(volume->costs.construction[i].median_ns * 1e-3));
    table.rows.push_back(std::move(row));
  }
  std::vector<std::string> paper = {"all, paper (ms)"};
  for (const VolumeResult* volume : shown) {
    const PublishedVolume* published = published_for(volume->name);
    paper.push_back(published == nullptr ? "-" : number(published->construction_ms));
  }
  table.rows.push_back(std::move(paper));
  return table;
}

Table figures_8_to_10(const PaperResult& result) {
  const int frames = result.options.frames;
  Table table;
  table.title = "Fig. 8, 9, 10: frames per second, and longer runs";
  table.note = fmt::format(
      "By the processor time of the thread: motion, updates and tests of {} objects, no "
      "drawing (the paper's frame rates have no number in the text). T by the formula. "
      "Collisions of the first seed.",
      result.objects.size());
  table.head = {"volume", "frames/s"};
  for (const int length : kRunLengths) {
    table.head.push_back(fmt::format("T ms, {} frames", length * frames));
    table.head.push_back(fmt::format("clock ms, {}", length * frames));
  }
  table.head.push_back(fmt::format("collisions, {}", kRunLengths.back() * frames));
  for (const VolumeResult& volume : result.volumes) {
    std::vector<std::string> row = {volume.name,
                                    fmt::format("{:.0f}", frames * 1e3 / volume.costs.run_ms[0])};
    for (size_t i = 0; i < kRunLengths.size(); ++i) {
      row.push_back(number(volume.total_ms(kRunLengths[i])));
      row.push_back(number(volume.costs.run_ms[i]));
    }
    row.push_back(plain(volume.long_collisions.back()));
    table.rows.push_back(std::move(row));
  }
  return table;
}

Table table_of_figure_3(const PaperResult& result) {
  Table table;
  table.title = "Fig. 3: simplicity against accuracy, measured";
  table.note = fmt::format(
      "Simplicity: cost of a frame of {}. Accuracy: fraction of the found pairs that "
      "touch.",
      result.frame_in_words());
  table.head = {"volume", "ns per frame", "touching, of the found pairs"};
  std::vector<std::pair<double, const VolumeResult*>> order;
  for (const VolumeResult& volume : result.volumes)
    order.emplace_back(result.frame_ns(volume), &volume);
  std::sort(order.begin(), order.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [ns, volume] : order)
    table.rows.push_back({volume->name, fmt::format("{:.0f}", ns),
                          fmt::format("{:.1f} %", 100 * (1 - volume->false_positive_rate))});
  return table;
}

Table part_two(const Scale& scale) {
  Table table;
  table.title = fmt::format("Part II, Fig. 13: {} objects", scale.objects);
  table.note =
      "One thread. frames/s of the fastest run; 'ms' is the median over the runs (10th..90th "
      "percentile): a wide range means a busy machine. 'counted' weights updates and tests with "
      "Part I's C_u and C_v; N_p C_p is the cost of the exact test of the reported pairs; all per "
      "frame.";
  table.head = {"strategy", "frames", "frames/s",   "ms",         "updates",
                "tests",    "pairs",  "counted ms", "N_p C_p ms", "C_o ms"};
  for (const StrategyCost& each : scale.strategies) {
    const double frames = each.result.frames;
    const auto by_frame = [&](double total) { return number(total / frames); };
    const Work& work = each.result.work;
    table.rows.push_back(
        {each.name(), fmt::format("{}", each.result.frames), number(each.result.fps()),
         fmt::format("{:.4g} ({:.4g}..{:.4g})", each.result.median_ms, each.result.low_ms,
                     each.result.high_ms),
         by_frame(static_cast<double>(work.updates())), by_frame(static_cast<double>(work.tests())),
         by_frame(static_cast<double>(work.passed)), by_frame(each.culling_ms),
         by_frame(each.exact_ms), number(each.built_ms)});
  }
  return table;
}

Table claims_table(const PaperResult& result) {
  Table table;
  table.title = "Does the paper's order hold?";
  table.note = "In the mean over the seeds; 'seeds' is the fraction of seeds in which it holds.";
  table.head = {"about", "claim", "left", "right", "seeds", "holds"};
  for (const Claim& claim : result.claims)
    table.rows.push_back({claim.about,
                          fmt::format("{} {} {}", claim.left, claim.relation, claim.right),
                          number(claim.left_value), number(claim.right_value),
                          fmt::format("{:.0f} %", 100 * claim.share), claim.holds ? "yes" : "NO"});
  return table;
}

Table winners_table(const PaperResult& result) {
  Table table;
  table.title = "Crossing points: the cheapest strategy that looks at all pairs";
  table.note = "Sizes tried: 15, 50, 150, 350, 500, 1000, 2000, 5000, 10000 objects.";
  table.head = {"measure", "from objects", "cheapest"};
  for (const Winner& winner : result.winners)
    table.rows.push_back({winner.measure, fmt::format("{}", winner.objects), winner.strategy});
  return table;
}

/// The two columns on the right agree if shapes alone order the volumes.
Table overlap_table(const PaperResult& result) {
  Table table;
  table.title = "The reason for Table 2's order: overlap volumes";
  table.note =
      "Litres in which the second object's origin makes two volumes overlap (for convex ones their "
      "Minkowski sum), mean over all pairs of objects in random attitudes, without any box or "
      "motion; +- standard error. Right: both as multiples of the triangles' values.";
  table.head = {"volume", "litres", "litres / triangles' litres",
                "collisions / triangles' collisions"};
  const VolumeResult& exact = result.volumes[kExactMethod];
  for (const VolumeResult& volume : result.volumes)
    table.rows.push_back(
        {volume.name, fmt::format("{:.2f}+-{:.2f}", volume.overlap.litres, volume.overlap.error_l),
         fmt::format("{:.2f}", volume.overlap.litres / exact.overlap.litres),
         fmt::format("{:.2f}", volume.collisions.back() / exact.collisions.back())});
  return table;
}

Table overlap_by_object(const PaperResult& result) {
  Table table;
  table.title = "Objects that change the order of sphere and turned AABB";
  table.note =
      "The same litres, mean over the partners of one object, the most compact first. Elongation: "
      "longest over shortest side of the box in the object's own frame.";
  table.head = {"object", "elongation"};
  std::vector<const VolumeResult*> shown;
  for (const VolumeResult& volume : result.volumes)
    for (const char* name : {"sphere", "aabb", "aabb_turned", "obb", "kdop14", "ordop14", "exact"})
      if (volume.name == name) shown.push_back(&volume);
  for (const VolumeResult* volume : shown) table.head.push_back(volume->name);
  std::vector<size_t> order(result.objects.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(),
            [&](size_t a, size_t b) { return result.elongations[a] < result.elongations[b]; });
  for (const size_t i : order) {
    std::vector<std::string> row = {result.objects[i],
                                    fmt::format("{:.2f}", result.elongations[i])};
    for (const VolumeResult* volume : shown)
      row.push_back(fmt::format("{:.1f}", volume->overlap.by_object_l[i]));
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::string joined(const std::vector<std::string>& cells, const std::string& before,
                   const std::string& between, const std::string& after) {
  std::string line = before;
  for (size_t i = 0; i < cells.size(); ++i) line += (i == 0 ? "" : between) + cells[i];
  return line + after;
}

std::string markdown_cell(std::string cell) {
  for (size_t at = cell.find('|'); at != std::string::npos; at = cell.find('|', at + 2))
    cell.replace(at, 1, "\\|");
  return cell;
}

}  // namespace

std::vector<Table> tables_of(const PaperResult& result) {
  std::vector<Table> tables;
  const bool has_costs = result.done >= CompletedStage::kCosts;
  if (result.done >= CompletedStage::kCollisions) tables.push_back(table_2(result));
  if (has_costs) tables.push_back(table_3(result));
  tables.push_back(formula_check());
  if (has_costs)
    for (const auto table_of : {table_of_figure_6, table_of_figure_3, figures_8_to_10})
      tables.push_back(table_of(result));
  for (const Scale& scale : result.scales) tables.push_back(part_two(scale));
  if (result.done == CompletedStage::kAll) {
    tables.push_back(winners_table(result));
    tables.push_back(claims_table(result));
  }
  if (result.done >= CompletedStage::kOverlapVolumes) {
    tables.push_back(overlap_table(result));
    tables.push_back(overlap_by_object(result));
  }
  return tables;
}

std::string to_text(const Table& table) {
  std::vector<size_t> widths(table.head.size());
  const auto widen = [&](const std::vector<std::string>& cells) {
    for (size_t i = 0; i < cells.size(); ++i) widths[i] = std::max(widths[i], cells[i].size());
  };
  widen(table.head);
  for (const auto& row : table.rows) widen(row);
  std::string text = table.title + "\n";
  const auto add = [&](const std::vector<std::string>& cells) {
    for (size_t i = 0; i < cells.size(); ++i)
      text += i == 0 ? fmt::format("{:<{}}", cells[i], widths[i])
                     : fmt::format("  {:>{}}", cells[i], widths[i]);
    text += '\n';
  };
  add(table.head);
  for (const auto& row : table.rows) add(row);
  return text;
}

std::string to_markdown(const Table& table) {
  std::string text = "### " + table.title + "\n\n" + table.note + "\n\n";
  text += joined(table.head, "| ", " | ", " |\n") + "|";
  for (size_t i = 0; i < table.head.size(); ++i) text += i == 0 ? "---|" : "---:|";
  text += '\n';
  for (std::vector<std::string> row : table.rows) {
    for (std::string& cell : row) cell = markdown_cell(cell);
    text += joined(row, "| ", " | ", " |\n");
  }
  return text + "\n";
}

std::string to_html(const Table& table) {
  std::string text = "<h3>" + html_escaped(table.title) + "</h3>\n<p>" + html_escaped(table.note) +
                     "</p>\n<table>\n";
  const auto add = [&](std::vector<std::string> cells, const std::string& tag) {
    for (std::string& cell : cells) cell = html_escaped(cell);
    text +=
        joined(cells, "<tr><" + tag + ">", "</" + tag + "><" + tag + ">", "</" + tag + "></tr>\n");
  };
  add(table.head, "th");
  for (const auto& row : table.rows) add(row, "td");
  return text + "</table>\n";
}

std::string html_escaped(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    if (c == '&')
      safe += "&amp;";
    else if (c == '<')
      safe += "&lt;";
    else if (c == '>')
      safe += "&gt;";
    else if (c == '"')
      safe += "&quot;";
    else
      safe += c;
  }
  return safe;
}

namespace {

using Json = nlohmann::ordered_json;

Json spread_of(const Cost& cost) {
  return {{"median_ns", cost.median_ns},
          {"p10_ns", cost.low_ns},
          {"p90_ns", cost.high_ns},
          {"repetitions", cost.repetitions}};
}

/// The part of the JSON that is known before any time is measured.
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
  json["total_paper_way_ms"] = volume.total_paper_count_ms();
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
  json["stopped_early"] = result.done < CompletedStage::kAll;
  json["frames"] = result.options.frames;
  json["seed"] = result.options.seed;
  json["seeds"] = result.options.seeds;
  json["objects"] = result.objects;
  json["elongations"] = result.elongations;
  json["box_edge_m"] = result.edge_m;
  if (result.done >= CompletedStage::kCosts)
    for (const VolumeResult& volume : result.volumes)
      json["volumes"][volume.name] = to_json(volume);
  else if (result.done >= CompletedStage::kCollisions)
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
