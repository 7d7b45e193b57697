#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "apps/command.h"
#include "apps/output/output_plan.h"
#include "apps/output/text_file.h"
#include "base/console.h"
#include "base/errors.h"
#include "base/text.h"
#include "recordings/readers/text_lines.h"
#include "recordings/units.h"
#include "scenes/file/scene_fields.h"
#include "scenes/file/yaml_tree.h"
#include "scenes/import/imported_plan.h"

namespace throng {
namespace {

constexpr const char* kImportFooter = R"(
PLAN is a DXF drawing, GeoJSON, WKT, the map.yaml of a ROS occupancy grid, a geometry of JuPedSim or a scenario
of Vadere; its content decides. --layer USE=NAME selects layers of a drawing, or features by their layer, type or
name. USE is walkable, obstacles, walls, starts or goals. Without --layer, names that contain such words decide.

Examples:
  throng import station.dxf --out station.yaml
  throng import station.dxf --out station.yaml --layer walkable=A-FLOR --layer walls=A-WALL --unit mm
  throng import campus.geojson --out campus.yaml --unit m
  throng import room.wkt --out room.yaml --unit cm)";

struct ImportCommandOptions {
  std::string plan;
  std::string out;
  std::vector<std::string> layers;
  std::string unit;
  bool overwrite = false;
};

constexpr double kMaxUnit_m = 1e6;

/// Metres per unit: a name, or a number above 0.
double unit_option(const std::string& text) {
  double value = 0;
  if (const std::optional<Unit> unit = unit_named(text);
      unit && unit->quantity == Quantity::kLength && unit->in_si > 0)
    return unit->in_si;
  if (parse_number(trimmed(text), value) && value > 0 && value <= kMaxUnit_m) return value;
  throw InputError(
      "--unit",
      fmt::format("{}, or metres per unit as a number", list_of(unit_names_of(Quantity::kLength))),
      in_quotes(text));
}

ImportOptions import_options(const ImportCommandOptions& options) {
  ImportOptions out{.file = options.plan, .layers = {}, .unit_m = {}};
  if (!options.unit.empty()) out.unit_m = unit_option(options.unit);
  for (const std::string& layer : options.layers) {
    const size_t cut = layer.find('=');
    if (cut == std::string::npos || cut == 0 || cut + 1 == layer.size())
      throw InputError("--layer", "USE=NAME, such as walls=A-WALL", in_quotes(layer));
    out.layers[lower(layer.substr(0, cut))].push_back(layer.substr(cut + 1));
  }
  return out;
}

std::string unit_text(const ImportedPlan& plan, const ImportOptions& options) {
  const double unit_m = options.unit_m ? *options.unit_m : plan.unit_m.value_or(1);
  std::string name = fmt::format("{:g} m", unit_m);
  for (const std::string& each : unit_names_of(Quantity::kLength))
    if (unit_named(each)->in_si == unit_m) name = each;
  return fmt::format("{}, {}", name, options.unit_m ? "by --unit" : "as the file states");
}

std::string summary(const ImportedPlan& plan, const ImportOptions& options,
                    const std::string& out) {
  const Rectangle bounds = *plan_bounds(plan);
  std::string text = fmt::format("{}: {}\n", options.file.string(), plan.kind);
  text += fmt::format("unit: {}\n", unit_text(plan, options));
  text += fmt::format("size: {:.2f} m by {:.2f} m, from [{:.2f}, {:.2f}] to [{:.2f}, {:.2f}]\n",
                      bounds.size_m().x(), bounds.size_m().y(), bounds.min_m.x(), bounds.min_m.y(),
                      bounds.max_m.x(), bounds.max_m.y());
  if (!plan.shift_m.isZero())
    text += fmt::format("moved to the origin: [{:.4f}, {:.4f}] m subtracted\n", plan.shift_m.x(),
                        plan.shift_m.y());
  for (const std::string& line : plan.used) text += fmt::format("used: {}\n", line);
  for (const std::string& line : plan.left_out) text += fmt::format("left out: {}\n", line);
  text +=
      fmt::format("scene: {}, {}, {}, {}, {}\n", counted(plan.walkable.size(), "walkable area"),
                  counted(plan.obstacles.size(), "obstacle"), counted(plan.walls.size(), "wall"),
                  counted(plan.starts.size(), "start"), counted(plan.goals.size(), "goal"));
  if (plan.walkable.empty())
    text += "The plan has no walkable area; the ground is the rectangle around it plus 1 m.\n";
  if (const std::string note = added_group_note(plan); !note.empty()) text += note + "\n";
  text += fmt::format("{} written; next:\n  throng info {} --plan plan.svg\n  throng run {}\n", out,
                      out, out);
  return text;
}

int import_to_scene(const ImportCommandOptions& options) {
  const ImportOptions imported = import_options(options);
  const std::filesystem::path out(options.out);
  const std::filesystem::path wkt = std::filesystem::path(out).replace_extension(".ground.wkt");
  OutputPlan outputs;
  outputs.reads("the plan", options.plan);
  outputs.writes({.option = "--out", .path = out, .side_files = {wkt}});
  outputs.check();
  std::error_code error;
  if (!options.overwrite && std::filesystem::is_regular_file(out, error))
    throw InputError("--out", "a new file, or --overwrite with it",
                     fmt::format("{}, which is there", out.string()));
  const ImportedPlan plan = import_plan(imported);
  const std::string source = imported.file.filename().string();
  std::string text = scene_text_of(plan, source);
  std::string ground;
  if (text.size() > kMaxYamlBytes && !plan.walkable.empty()) {
    text = scene_text_of(plan, source, wkt.filename().string());
    ground = ground_wkt_of(plan);
  }
  if (text.size() > kMaxYamlBytes)
    throw InputError(options.plan, fmt::format("a scene of at most {} bytes", kMaxYamlBytes),
                     fmt::format("{} bytes; simplify the plan", text.size()));
  const OpenOutputs open = outputs.open();
  if (!ground.empty()) write_text(wkt, ground + "\n");
  write_text(out, text);
  print_result_text(summary(plan, imported, options.out));
  return kExitSuccess;
}

}  // namespace

Command add_import_command(CommandLine& parent) {
  CommandOptions* app = parent.add_subcommand(
      "import", "Convert a floor plan of another program to a scene: DXF, GeoJSON, WKT, ...");
  app->footer(kImportFooter);
  const auto options = std::make_shared<ImportCommandOptions>();
  app->add_option("PLAN", options->plan, "Floor plan")->required()->type_name("FILE");
  app->add_option("--out", options->out, "Scene file to write")->required()->type_name("FILE");
  app->add_option("--layer", options->layers,
                  "Use of a layer: walls=A-WALL; may be repeated [by the names of layers]")
      ->expected(1)
      ->take_many()
      ->type_name("USE=NAME");
  app->add_option("--unit", options->unit,
                  "Unit of the plan: m, cm, mm, km, ft, in, or metres per unit [the file's]")
      ->type_name("UNIT");
  app->add_flag("--overwrite", options->overwrite, "Replace an older scene file");
  return {app, [options] { return import_to_scene(*options); }};
}

}  // namespace throng
