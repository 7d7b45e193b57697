// scene_text_of() writes an imported plan as a scene file.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>

#include "base/errors.h"
#include "base/text.h"
#include "geometry/polygon_union.h"
#include "recordings/readers/text_lines.h"
#include "scenes/file/key_tables.h"
#include "scenes/file/polygon_values.h"
#include "scenes/file/scene_values.h"
#include "scenes/import/imported_plan.h"

namespace throng {
namespace {

constexpr size_t kMaxColumns = 100;
constexpr double kWallHeight_m = 2.5;
constexpr double kPlanWallThickness_m = 0.1;
/// Margin of the ground around a plan without walkable areas.
constexpr double kGroundMargin_m = 1;
constexpr double kDuration_s = 60;
constexpr double kAreaPerAgent_m2 = 4;
constexpr double kMaxAgentsPerStart = 1000;
/// Less is crowded: agents may find no place at the start.
constexpr double kMinAreaPerAgent_m2 = 1;
/// Pieces of an obstacle get numbers behind its name.
constexpr size_t kMaxStemBytes = 100;

/// A length to 0.1 mm, the grid of polygons.
std::string number_text(double value) { return decimal_text(value, 4); }

std::string point_text(const Eigen::Vector2d& point) {
  return fmt::format("[{}, {}]", number_text(point.x()), number_text(point.y()));
}

std::string ring_text(const std::vector<Eigen::Vector2d>& ring) {
  std::string out = "[";
  for (const Eigen::Vector2d& point : ring) out += (out.size() > 1 ? ", " : "") + point_text(point);
  return out + "]";
}

std::string rectangle_keys(const Rectangle& rectangle) {
  return fmt::format("min_m: {}, max_m: {}", point_text(rectangle.min_m),
                     point_text(rectangle.max_m));
}

/// "min_m: ..., max_m: ..." or "polygon: ..., holes: ...".
std::string shape_keys(const Polygon& polygon, bool allows_rectangle = true) {
  const std::optional<Rectangle> rectangle = rectangle_of(polygon);
  if (rectangle && allows_rectangle) return rectangle_keys(*rectangle);
  std::string out = "polygon: " + ring_text(polygon.outline);
  if (polygon.holes.empty()) return out;
  out += ", holes: [";
  for (size_t i = 0; i < polygon.holes.size(); ++i)
    out += (i > 0 ? ", " : "") + ring_text(polygon.holes[i]);
  return out + "]";
}

std::string area_text(const Polygon& polygon) { return "{" + shape_keys(polygon) + "}"; }

/// Breaks a line of YAML after commas between points, maps and keys; inside quotes only for
/// `breaks_quotes` (WKT, where a line break is a blank).
std::string wrapped(std::string_view text, bool breaks_quotes = false) {
  constexpr std::string_view kIndent = "      ";
  std::string out;
  size_t line_begin = 0, last_break = 0;  // in `out`
  bool is_quoted = false;
  for (size_t i = 0; i < text.size(); ++i) {
    out += text[i];
    if (text[i] == '"' && (i == 0 || text[i - 1] != '\\')) is_quoted = !is_quoted;
    if (out.size() - line_begin > kMaxColumns && last_break > line_begin) {
      out.replace(last_break, 1, "\n" + std::string(kIndent));
      line_begin = last_break + 1;
    }
    const bool is_comma = i > 0 && text[i - 1] == ',' && text[i] == ' ';
    if (!is_comma || i + 1 >= text.size()) continue;
    const char before = i > 1 ? text[i - 2] : ' ', after = text[i + 1];
    const bool is_between = before == ']' || before == '}' || before == '"' || after == '{' ||
                            after == '[' || std::isalpha(static_cast<unsigned char>(after)) != 0;
    if (is_quoted ? breaks_quotes : is_between) last_break = out.size() - 1;
  }
  return out + "\n";
}

/// A name as YAML reads it back.
std::string yaml_text(const std::string& name) {
  constexpr std::string_view kWords[] = {"true", "false", "yes", "no", "on",
                                         "off",  "null",  "y",   "n"};
  const auto is_plain = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == ' ' || c == '_' || c == '-' ||
           c == '.';
  };
  const std::string lowered = lower(name);
  const bool is_word = std::find(std::begin(kWords), std::end(kWords), lowered) != std::end(kWords);
  if (std::isalpha(static_cast<unsigned char>(name.front())) != 0 && !is_word &&
      name.back() != ' ' && std::all_of(name.begin(), name.end(), is_plain))
    return name;
  std::string out = "\"";
  for (const char c : name) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

/// UniqueNames makes names that differ, also from the numbered pieces of an obstacle: "column-2",
/// where "column 2" could be the second piece of "column".
class UniqueNames {
 public:
  std::string of(std::string name) {
    name = cut(name);
    const size_t digits = name.find_last_not_of("0123456789");
    if (digits != std::string::npos && digits + 1 < name.size() && name[digits] == ' ')
      name[digits] = '-';
    std::string out = name;
    for (size_t number = 2; !used_.insert(out).second; ++number)
      out = fmt::format("{}-{}", name, number);
    return out;
  }

 private:
  static std::string cut(std::string_view name) {
    size_t end = 0;
    for (size_t bytes;
         (bytes = printable_character(name.substr(end))) > 0 && end + bytes <= kMaxStemBytes;)
      end += bytes;
    return std::string(name.substr(0, end));
  }

  std::set<std::string> used_;
};

Rectangle ground_rectangle(const ImportedPlan& plan) {
  return plan_bounds(plan).value_or(Rectangle{}).grown(kGroundMargin_m);
}

/// Area for starts or goals that the plan lacks: the largest walkable one once touching ones are
/// joined, as in a scene. Of an outline too long for an area, the rectangle around it.
Polygon substitute_area(const ImportedPlan& plan, const std::string& source) {
  if (plan.walkable.empty()) return polygon_of(plan_bounds(plan).value_or(Rectangle{}));
  const std::vector<Polygon> joined =
      plan.walkable.size() > 1 ? join(plan.walkable, source).polygons : plan.walkable;
  const Polygon& largest =
      *std::max_element(joined.begin(), joined.end(),
                        [](const Polygon& a, const Polygon& b) { return area_m2(a) < area_m2(b); });
  return vertex_count({largest}) > kMaxAreaVertices ? polygon_of(bounds_of(largest.outline))
                                                    : largest;
}

std::string ground_text(const ImportedPlan& plan, const std::string& wkt_file) {
  const std::string walls = fmt::format("wall_height_m: {}", number_text(kWallHeight_m));
  if (plan.walkable.empty())
    return wrapped(fmt::format("ground: {{{}}}", rectangle_keys(ground_rectangle(plan))));
  if (!wkt_file.empty())
    return wrapped(fmt::format("ground: {{file: {}, {}}}", yaml_text(wkt_file), walls));
  if (plan.walkable.size() == 1)
    return wrapped(fmt::format("ground: {{{}, {}}}", shape_keys(plan.walkable.front()), walls));
  return wrapped(fmt::format("ground: {{wkt: \"{}\", {}}}", ground_wkt_of(plan), walls), true);
}

std::string distribution_yaml(const Distribution& each) {
  constexpr int kDecimals = 6;
  if (each.std_dev == 0 || each.min == each.max) return decimal_text(each.mean, kDecimals);
  std::string out = fmt::format("{{mean: {}, std_dev: {}", decimal_text(each.mean, kDecimals),
                                decimal_text(each.std_dev, kDecimals));
  if (each.min > kTimeRange.min) out += ", min: " + decimal_text(each.min, kDecimals);
  if (each.max < kTimeRange.max) out += ", max: " + decimal_text(each.max, kDecimals);
  return out + "}";
}

/// ", wait_s: 5" if all alternatives have one waiting time; a goal has no more.
std::string wait_text(const std::vector<const NamedPolygon*>& alternatives) {
  const std::optional<Distribution>& wait_s = alternatives.front()->wait_s;
  const bool is_common =
      std::all_of(alternatives.begin(), alternatives.end(),
                  [&](const NamedPolygon* each) { return each->wait_s == wait_s; });
  return wait_s && is_common ? "wait_s: " + distribution_yaml(*wait_s) : "";
}

std::string goal_text(const NamedPolygon& goal) {
  const std::string wait = wait_text({&goal});
  return "{" + shape_keys(goal.polygon) + (wait.empty() ? "" : ", " + wait) + "}";
}

/// One goal per name that the start states, or one for all goals.
std::string goals_text(const NamedPolygon& start, const std::vector<NamedPolygon>& goals) {
  std::vector<std::vector<const NamedPolygon*>> stops;
  for (const std::string& name : start.goals) {
    std::vector<const NamedPolygon*> alternatives;
    for (const NamedPolygon& goal : goals)
      if (goal.name == name) alternatives.push_back(&goal);
    if (!alternatives.empty()) stops.push_back(std::move(alternatives));
  }
  if (stops.empty()) {
    stops.emplace_back();
    for (const NamedPolygon& goal : goals) stops.back().push_back(&goal);
  }
  if (stops.size() == 1 && stops[0].size() == 1)
    return wrapped("    goals: [" + goal_text(*stops[0][0]) + "]");
  std::string out = "    goals:\n";
  for (const std::vector<const NamedPolygon*>& stop : stops) {
    if (stop.size() == 1) {
      out += wrapped("      - " + goal_text(*stop[0]));
      continue;
    }
    out += "      - any_of:\n";
    for (const NamedPolygon* goal : stop) out += wrapped("          - " + area_text(goal->polygon));
    if (const std::string wait = wait_text(stop); !wait.empty()) out += "        " + wait + "\n";
  }
  return out;
}

/// Agents at the start, or entering. Those who would be crowded enter as space permits.
std::string people_text(const NamedPolygon& start) {
  const double own_m2 = area_m2(start.polygon);
  const double by_area = std::clamp(std::round(own_m2 / kAreaPerAgent_m2), 1.0, kMaxAgentsPerStart);
  const PlanArrivals arrivals =
      start.arrivals.value_or(PlanArrivals{.count = static_cast<int64_t>(by_area)});
  const bool is_at_once = arrivals.rate_per_s == 0 && arrivals.start_s == 0;
  if (!start.arrivals ||
      (is_at_once && static_cast<double>(arrivals.count) * kMinAreaPerAgent_m2 <= own_m2))
    return fmt::format("    count: {}\n", arrivals.count) +
           wrapped("    spawn: " + area_text(start.polygon));
  const double rate_per_s = arrivals.rate_per_s > 0 ? arrivals.rate_per_s : kRateRange.max;
  return wrapped(
      fmt::format("    sources: [{{area: {}, count: {}, rate_per_s: {:.6g}, start_s: {:.9g}{}}}]",
                  area_text(start.polygon), arrivals.count, rate_per_s, arrivals.start_s,
                  arrivals.is_poisson ? ", arrivals: poisson" : ""));
}

std::string groups_text(const ImportedPlan& plan, const std::string& source) {
  std::vector<NamedPolygon> starts = plan.starts;
  std::vector<NamedPolygon> goals = plan.goals;
  if (starts.empty() || goals.empty()) {
    const Polygon substitute = substitute_area(plan, source);
    if (starts.empty()) starts.push_back({"visitors", substitute});
    if (goals.empty()) goals.push_back({"", substitute});
  }
  UniqueNames names;
  std::string out = "groups:\n";
  for (const NamedPolygon& start : starts) {
    out += fmt::format("  - name: {}\n", yaml_text(names.of(start.name)));
    out += people_text(start);
    if (const auto& speed_mps = start.speed_mps ? start.speed_mps : plan.speed_mps)
      out += fmt::format("    desired_speed_mps: {}\n", distribution_yaml(*speed_mps));
    out += goals_text(start, goals);
    out +=
        fmt::format("    on_arrival: {}\n", plan.goals.empty() || start.stays ? "stay" : "leave");
  }
  return out;
}

std::string obstacles_text(const ImportedPlan& plan) {
  if (plan.obstacles.empty() && plan.walls.empty()) return "";
  UniqueNames names;
  const std::string top = fmt::format("top_m: {}", number_text(kWallHeight_m));
  std::string out = "\nobstacles:\n";
  for (const NamedPolygon& each : plan.obstacles)
    out +=
        wrapped(fmt::format("  - {{name: {}, kind: polygon, {}, {}}}",
                            yaml_text(names.of(each.name)), shape_keys(each.polygon, false), top));
  for (const PlanWall& each : plan.walls)
    out += wrapped(fmt::format(
        "  - {{name: {}, kind: wall, line: {}, thickness_m: {}, {}}}",
        yaml_text(names.of(each.name)), ring_text(each.line_m),
        number_text(each.thickness_m > 0 ? each.thickness_m : kPlanWallThickness_m), top));
  return out;
}

}  // namespace

std::string added_group_note(const ImportedPlan& plan) {
  if (!plan.starts.empty() && !plan.goals.empty()) return "";
  const char* const where =
      plan.walkable.empty() ? "the area of the plan" : "the largest walkable area";
  const char* const what = plan.starts.empty() && plan.goals.empty() ? "starts and goals"
                           : plan.starts.empty()                     ? "starts"
                                                                     : "goals";
  return fmt::format("The plan has no {}; {} stands for them.", what, where);
}

std::string ground_wkt_of(const ImportedPlan& plan) {
  const auto ring_wkt = [](const Polygon::Ring& ring) {
    std::string out = "(";
    for (size_t i = 0; i <= ring.size(); ++i) {
      const Eigen::Vector2d& point = ring[i % ring.size()];
      out += (i > 0 ? ", " : "") + number_text(point.x()) + " " + number_text(point.y());
    }
    return out + ")";
  };
  std::string out = "MULTIPOLYGON (";
  for (size_t i = 0; i < plan.walkable.size(); ++i) {
    out += (i > 0 ? ", (" : "(") + ring_wkt(plan.walkable[i].outline);
    for (const Polygon::Ring& hole : plan.walkable[i].holes) out += ", " + ring_wkt(hole);
    out += ")";
  }
  return out + ")";
}

std::string scene_text_of(const ImportedPlan& plan, const std::string& source,
                          const std::string& wkt_file) {
  std::string out =
      fmt::format("# Floor plan of {} ({}), imported by Throng.\n", escaped(source), plan.kind);
  if (!plan.shift_m.isZero())
    out +=
        fmt::format("# Coordinates are those of the plan minus {} m.\n", point_text(plan.shift_m));
  if (const std::string note = added_group_note(plan); !note.empty())
    out += fmt::format("# {}\n", note);
  out += fmt::format("duration_s: {:.9g}\n\n", plan.duration_s.value_or(kDuration_s));
  out += ground_text(plan, wkt_file) + "\n";
  out += groups_text(plan, source);
  return out + obstacles_text(plan);
}

}  // namespace throng
