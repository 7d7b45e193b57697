#include "apps/commands/comparison_report.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "apps/output/text_file.h"
#include "bench/version_json.h"

namespace throng {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) { return std::isnan(value) ? Json() : Json(value); }

Json row_json(const MeasureTable& table, const ComparedRow& each) {
  Json json;
  if (each.row.from) {
    json[table.key == "part" ? "density" : table.key] = *each.row.from;
    if (each.row.to) json[(table.key == "part" ? "density" : table.key) + "_to"] = *each.row.to;
  } else {
    json["part"] = each.row.at;
  }
  if (!each.row.which.empty()) json["which"] = each.row.which;
  json["what"] = each.row.what;
  json["a"] = number(each.a);
  json["b"] = number(each.b);
  json["unit"] = each.row.unit;
  return json;
}

Json run_json(const MeasuredRun& run) {
  return {{"name", run.name},
          {"people", run.facts.people},
          {"seconds", run.facts.seconds},
          {"person_s", run.facts.person_s},
          {"sample_s", run.facts.sample_s},
          {"off_area", run.facts.off_area}};
}

}  // namespace

std::string comparison_json(const MeasuredRun& a, const MeasuredRun& b) {
  Json json = {{"throng", version_json()}, {"a", run_json(a)}, {"b", run_json(b)}};
  for (size_t i = 0; i < a.tables.size(); ++i) {
    Json rows = Json::array();
    for (const ComparedRow& each : compared_rows(a.tables[i], b.tables[i]))
      rows.push_back(row_json(a.tables[i], each));
    json[a.tables[i].id] = rows;
  }
  return json.dump(2) + "\n";
}

void write_comparison_report(const MeasuredRun& a, const MeasuredRun& b,
                             const std::filesystem::path& folder) {
  std::string text =
      fmt::format("# {} and {}\n\nWritten by `throng compare --out`.\n\n", a.name, b.name);
  for (const Figure& figure : comparison_figures(a, b)) {
    text +=
        fmt::format("![{0}]({1}.svg)\n\n*{0}.* {2}\n\n", figure.title, figure.id, figure.caption);
    draw(figure, folder);
  }
  text += "```text\n" + comparison_text(a, b) + "```\n";
  write_text(folder / "report.md", text);
}

}  // namespace throng
