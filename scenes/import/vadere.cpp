// Vadere's scenarios: bounds, obstacles, sources and targets of a topography.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "base/errors.h"
#include "base/text.h"
#include "scenes/import/plan_json.h"
#include "scenes/import/plan_readers.h"

namespace throng {
namespace {

constexpr size_t kMaxTargetsOfSource = 100;
constexpr const char* kExpectedScenario = "a scenario of Vadere";
constexpr double kMaxScenarioNumber = 1e9;
/// A circle becomes a polygon around it, larger by 0.1 %.
constexpr int kCircleCorners = 64;

/// List of the topography that does not become shapes.
struct VadereList {
  std::string_view key;
  const char* what;  ///< description in `left_out`
};
constexpr VadereList kOtherLists[] = {
    {"stairs", "stairs, which are level ground"},
    {"measurementAreas", "measurement areas"},
    {"targetChangers", "target changers"},
    {"absorbingAreas", "absorbing areas"},
    {"aerosolClouds", "aerosol clouds"},
    {"droplets", "droplets"},
    {"dynamicElements", "agents that are placed singly"},
    {"pedestrians", "agents that are placed singly"},
    {"teleporter", "teleporters"},
};
constexpr std::string_view kUsedKeys[] = {
    "obstacles",    "sources",          "targets", "attributes",
    "bounds",       "boundingBoxWidth", "bounded", "attributesPedestrian",
    "attributesCar"};

class VadereScenario {
 public:
  explicit VadereScenario(const std::string& file) : file_(file) {}

  ImportedPlan read(const std::string& text) {
    const PlanJson root = parse_plan_json(text, file_);
    const PlanJson& topography = find_topography(root);
    plan_.kind = "Vadere scenario";
    plan_.unit_m = 1;  // by definition
    read_ground(topography);
    place_ = "obstacles";
    for_each(topography, "obstacles", [&](const PlanJson& element, size_t number) {
      plan_.obstacles.push_back({name_of(element, "obstacle", number), shape_of(element)});
    });
    size_t spawners = 0;
    for_each(topography, "sources", [&](const PlanJson& element, size_t number) {
      NamedPolygon& start = plan_.starts.emplace_back();
      start = {name_of(element, "source", number), shape_of(element), targets_of(element)};
      for (const char* key : {"spawner", "spawnNumber", "startTime"})
        if (member(element, key) != nullptr) {
          ++spawners;
          break;
        }
    });
    if (spawners > 0)
      plan_.left_out.push_back("numbers and times of " + counted(spawners, "source"));
    for_each(topography, "targets", [&](const PlanJson& element, size_t number) {
      plan_.goals.push_back({name_of(element, "target", number), shape_of(element)});
    });
    for (const auto& [shapes, noun] :
         {std::pair(&plan_.obstacles, "obstacle"), std::pair(&plan_.starts, "source"),
          std::pair(&plan_.goals, "target")})
      if (!shapes->empty()) plan_.used.push_back(counted(shapes->size(), noun));
    if (circles_ > 0)
      plan_.used.push_back(
          fmt::format("{} as polygons of {} corners", counted(circles_, "circle"), kCircleCorners));
    list_others(topography);
    return std::move(plan_);
  }

 private:
  [[noreturn]] void reject(const std::string& expected, const PlanJson* found) const {
    throw InputError(file_, fmt::format("{} in {}", expected, place_),
                     found != nullptr ? described_json(*found) : "no such key");
  }

  static const PlanJson* member(const PlanJson& object, std::string_view key) {
    if (!object.is_object()) return nullptr;
    const auto found = object.find(key);
    return found != object.end() ? &*found : nullptr;
  }

  const PlanJson& find_topography(const PlanJson& root) {
    for (const char* above : {"", "scenario", "vadere"}) {
      const PlanJson* const outer = *above == '\0' ? &root : member(root, above);
      const PlanJson* const found = outer != nullptr ? member(*outer, "topography") : nullptr;
      if (found == nullptr) continue;
      place_ = "topography";
      if (!found->is_object()) reject("an object", found);
      return *found;
    }
    throw InputError(file_, "the key topography, as in a .scenario of Vadere", "no such key");
  }

  double number(const PlanJson& object, const char* key) const {
    const PlanJson* const found = member(object, key);
    if (found == nullptr || !found->is_number() ||
        !(std::abs(found->get<double>()) <= kMaxScenarioNumber))
      reject(fmt::format("a number as '{}'", key), found);
    return found->get<double>();
  }

  Polygon rectangle(double x, double y, double width, double height, const PlanJson& found) const {
    if (!(width > 0 && height > 0)) reject("a width and a height above 0", &found);
    return {{{x, y}, {x + width, y}, {x + width, y + height}, {x, y + height}}, {}};
  }

  /// The wall around a bounded topography lies inside its bounds.
  void read_ground(const PlanJson& topography) {
    const PlanJson* const attributes = member(topography, "attributes");
    const PlanJson& source = attributes != nullptr ? *attributes : topography;
    const PlanJson* const bounds = member(source, "bounds");
    place_ = "the attributes of the topography";
    if (bounds == nullptr || !bounds->is_object()) reject("an object as 'bounds'", bounds);
    const PlanJson* const bounded = member(source, "bounded");
    if (bounded != nullptr && !bounded->is_boolean()) reject("true or false as 'bounded'", bounded);
    const bool has_wall = bounded == nullptr || bounded->get<bool>();
    const double wall = has_wall && member(source, "boundingBoxWidth") != nullptr
                            ? number(source, "boundingBoxWidth")
                            : 0;
    if (!(wall >= 0)) reject("0 or more as 'boundingBoxWidth'", member(source, "boundingBoxWidth"));
    const double width = number(*bounds, "width"), height = number(*bounds, "height");
    if (!(width > 2 * wall && height > 2 * wall))
      reject("bounds wider than two walls of boundingBoxWidth", bounds);
    plan_.walkable.push_back(rectangle(number(*bounds, "x") + wall, number(*bounds, "y") + wall,
                                       width - 2 * wall, height - 2 * wall, *bounds));
    plan_.used.push_back(wall > 0 ? fmt::format("bounds of {} m by {} m without their wall of {} m",
                                                width, height, wall)
                                  : fmt::format("bounds of {} m by {} m", width, height));
  }

  template <typename Each>
  void for_each(const PlanJson& topography, const char* key, const Each& each) {
    const PlanJson* const list = member(topography, key);
    if (list == nullptr || list->is_null()) return;
    place_ = key;
    if (!list->is_array()) reject("a list", list);
    size_t index = 0;
    for (const PlanJson& element : *list) {
      place_ = fmt::format("{} {} of the topography", key, ++index);
      // Before version 0.2 the attributes of an element are an object of their own.
      const PlanJson* const inner = member(element, "attributes");
      each(inner != nullptr && member(element, "shape") == nullptr ? *inner : element, index);
    }
  }

  static std::string name_of(const PlanJson& element, const char* noun, size_t number) {
    const PlanJson* const id = member(element, "id");
    if (id != nullptr && id->is_number_integer() && id->get<int64_t>() >= 0)
      return fmt::format("{} {}", noun, id->get<int64_t>());
    return fmt::format("{} number {}", noun, number);
  }

  /// Targets with one id are alternatives, those of a list are visited in order.
  std::vector<std::string> targets_of(const PlanJson& source) const {
    const PlanJson* const ids = member(source, "targetIds");
    std::vector<std::string> names;
    if (ids == nullptr || ids->is_null()) return names;
    if (!ids->is_array()) reject("a list as 'targetIds'", ids);
    if (ids->size() > kMaxTargetsOfSource)
      reject(fmt::format("at most {} ids in 'targetIds'", kMaxTargetsOfSource), ids);
    for (const PlanJson& id : *ids) {
      if (!id.is_number_integer()) reject("whole numbers in 'targetIds'", &id);
      names.push_back(fmt::format("target {}", id.get<int64_t>()));
    }
    return names;
  }

  Polygon shape_of(const PlanJson& element) {
    const PlanJson* const shape = member(element, "shape");
    if (shape == nullptr || !shape->is_object()) reject("an object as 'shape'", shape);
    const PlanJson* const type = member(*shape, "type");
    const std::string kind =
        type != nullptr && type->is_string() ? type->get<std::string>() : std::string();
    if (kind == "RECTANGLE") {
      count_vertices(4);
      return rectangle(number(*shape, "x"), number(*shape, "y"), number(*shape, "width"),
                       number(*shape, "height"), *shape);
    }
    if (kind == "CIRCLE") return circle(*shape);
    if (kind != "POLYGON") reject("POLYGON, RECTANGLE or CIRCLE as 'type' of the shape", type);
    const PlanJson* const points = member(*shape, "points");
    if (points == nullptr || !points->is_array()) reject("a list as 'points'", points);
    Polygon polygon;
    count_vertices(points->size());
    for (const PlanJson& point : *points)
      polygon.outline.emplace_back(number(point, "x"), number(point, "y"));
    Polygon::Ring& ring = polygon.outline;
    if (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();
    if (ring.size() < 3) reject("three points or more", points);
    return polygon;
  }

  Polygon circle(const PlanJson& shape) {
    const PlanJson* const centre = member(shape, "center");
    if (centre == nullptr || !centre->is_object()) reject("an object as 'center'", centre);
    const double radius = number(shape, "radius");
    if (!(radius > 0)) reject("a number above 0 as 'radius'", member(shape, "radius"));
    count_vertices(kCircleCorners);
    ++circles_;
    const double angle = 2 * M_PI / kCircleCorners, outer = radius / std::cos(angle / 2);
    Polygon polygon;
    for (int i = 0; i < kCircleCorners; ++i)
      polygon.outline.emplace_back(number(*centre, "x") + outer * std::cos(i * angle),
                                   number(*centre, "y") + outer * std::sin(i * angle));
    return polygon;
  }

  void count_vertices(size_t count) {
    vertices_ += count;
    if (vertices_ > kMaxPlanVertices)
      throw InputError(file_, fmt::format("at most {} vertices in a plan", kMaxPlanVertices),
                       "more; simplify the plan");
  }

  void list_others(const PlanJson& topography) {
    for (const auto& [key, value] : topography.items()) {
      if (std::find(std::begin(kUsedKeys), std::end(kUsedKeys), key) != std::end(kUsedKeys))
        continue;
      const size_t count = value.is_array() ? value.size() : value.is_null() ? 0 : 1;
      if (count == 0) continue;
      const auto known =
          std::find_if(std::begin(kOtherLists), std::end(kOtherLists),
                       [&, &key = key](const VadereList& list) { return list.key == key; });
      const std::string what =
          known != std::end(kOtherLists) ? known->what : escaped(key).substr(0, 60);
      plan_.left_out.push_back(fmt::format("{}: {}", what, count));
    }
  }

  const std::string& file_;
  std::string place_ = "the file";
  ImportedPlan plan_;
  size_t vertices_ = 4, circles_ = 0;
};

}  // namespace

bool is_vadere_scenario(std::string_view head) {
  head.remove_prefix(std::min(head.find_first_not_of(" \t\r\n\xef\xbb\xbf"), head.size()));
  if (!head.starts_with('{')) return false;
  if (head.find("\"topography\"") != head.npos) return true;
  // Attributes of models, which may be long, precede the topography.
  return head.find("\"mainModel\"") != head.npos && head.find("\"attributesModel\"") != head.npos;
}

ImportedPlan read_vadere_scenario(const ImportOptions& options) {
  const RegularFile file(options.file, kExpectedScenario, kMaxPlanBytes);
  const SandboxedParser parser{.library = "the reader of scenarios",
                               .expected = kExpectedScenario,
                               .remedy = "save it again with Vadere"};
  const std::string name = options.file.string();
  return read_plan_sandboxed(file, parser, [&](const RegularFile& opened) {
    return VadereScenario(name).read(plan_text(opened, kExpectedScenario));
  });
}

}  // namespace throng
