// GeoJSON (RFC 7946): polygons and lines by their properties.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "base/errors.h"
#include "base/text.h"
#include "recordings/readers/text_lines.h"
#include "scenes/import/plan_json.h"
#include "scenes/import/plan_layers.h"
#include "scenes/import/plan_readers.h"

namespace throng {
namespace {

using json = PlanJson;

constexpr int kMaxGeometryDepth = 8;
constexpr double kMaxGeoNumber = 1e12;

const SandboxedParser kGeoJsonParser{.library = "the reader of GeoJSON",
                                     .expected = "a plan in GeoJSON",
                                     .remedy = "export it again, for example as WKT"};

/// Properties that name the layer of a feature, the first one that is there.
constexpr std::string_view kLayerKeys[] = {"layer", "use", "type", "class", "kind", "category"};

bool is_degrees(std::string_view reference) {
  const std::string name = lower(reference);
  return name.find("crs84") != std::string::npos || name.ends_with("4326");
}

class GeoJsonPlan {
 public:
  GeoJsonPlan(const ImportOptions& options, const std::string& file)
      : options_(options), choice_(options), file_(file) {}

  ImportedPlan read(const std::string& text);

 private:
  /// Shapes of features with one layer, or with one name.
  struct Layer {
    std::string layer;  ///< "" for features without one
    std::string name;
    std::optional<PlanUse> use;
    LayerShapes shapes;
    size_t features = 0;
  };

  [[noreturn]] void reject(std::string_view expected, const json& found) const {
    throw InputError(file_, fmt::format("{} in {}", expected, place_), described_json(found));
  }
  void require_lengths(const json& root) const;
  void feature(const json& feature);
  void geometry(const json& geometry, Layer& layer, int depth);
  void polygon(const json& rings, Layer& layer);
  void line(const json& points, Layer& layer);
  std::vector<Eigen::Vector2d> positions(const json& points);
  const json& member(const json& object, const char* key) const;
  Layer& layer_of(const json& properties);
  static std::string text_of(const json& properties, std::string_view key);
  void use(Layer& layer, ImportedPlan& plan, UseTally& tally) const;

  const ImportOptions& options_;
  LayerChoice choice_;
  const std::string& file_;
  std::string place_ = "the file";
  std::map<std::string, Layer> layers_;
  std::vector<std::string> names_;        ///< layers and names of the features
  size_t shapeless_ = 0;                  ///< features without geometry
  std::map<std::string, size_t> points_;  ///< geometries that are no shapes, by their type
  size_t vertices_ = 0;
};

/// RFC 7946 has degrees only; programs nevertheless write projected coordinates.
void GeoJsonPlan::require_lengths(const json& root) const {
  constexpr const char* kProject =
      "project the plan to metres, for example to UTM, and give --unit m";
  std::string reference;
  if (const auto crs = root.find("crs"); crs != root.end() && crs->is_object())
    if (const auto properties = crs->find("properties");
        properties != crs->end() && properties->is_object())
      reference = text_of(*properties, "name");
  if (is_degrees(reference))
    throw InputError(file_, "coordinates with a unit of length",
                     fmt::format("degrees ({}); {}", in_quotes(reference), kProject));
  if (!options_.unit_m)
    throw InputError(file_, "a unit of length, as in --unit m",
                     fmt::format("GeoJSON, whose coordinates are degrees by its standard "
                                 "(RFC 7946); {}",
                                 kProject));
}

const json& GeoJsonPlan::member(const json& object, const char* key) const {
  if (!object.is_object()) reject("an object", object);
  const auto found = object.find(key);
  if (found == object.end())
    throw InputError(file_, fmt::format("'{}' in {}", key, place_), "none");
  return *found;
}

std::string GeoJsonPlan::text_of(const json& properties, std::string_view key) {
  if (!properties.is_object()) return "";
  for (const auto& [name, value] : properties.items())
    if (lower(name) == key && (value.is_string() || value.is_number())) {
      // Layers may have numbers for names.
      const std::string text = value.is_string()         ? value.get<std::string>()
                               : value.is_number_float() ? fmt::format("{}", value.get<double>())
                                                         : value.dump();
      return trimmed(text).empty() ? "" : escaped(trimmed(text));
    }
  return "";
}

GeoJsonPlan::Layer& GeoJsonPlan::layer_of(const json& properties) {
  const std::string name = text_of(properties, "name");
  std::string layer;
  for (const std::string_view key : kLayerKeys) {
    const std::string text = text_of(properties, key);
    if (text.empty()) continue;
    if (layer.empty()) layer = text;
    names_.push_back(text);
    if (choice_.use_of(text)) {
      layer = text;
      break;
    }
  }
  if (!name.empty()) names_.push_back(name);
  // A chosen name stands before the layer: it selects single features.
  const bool is_chosen_name = !name.empty() && choice_.use_of(name).has_value();
  const std::string& selected = is_chosen_name ? name : layer;
  const std::string object = name.empty() ? layer : name;
  Layer& out = layers_[lower(selected) + '\n' + object];
  out.layer = selected;
  out.name = object;
  out.use = choice_.is_empty() ? stated_use(selected) : choice_.use_of(selected);
  return out;
}

std::vector<Eigen::Vector2d> GeoJsonPlan::positions(const json& points) {
  if (!points.is_array()) reject("a list of positions", points);
  vertices_ += points.size();
  if (vertices_ > kMaxPlanVertices)
    throw InputError(file_, fmt::format("at most {} vertices", kMaxPlanVertices),
                     "more; simplify the plan");
  std::vector<Eigen::Vector2d> out;
  for (const json& point : points) {
    if (!point.is_array() || point.size() < 2 || !point[0].is_number() || !point[1].is_number())
      reject("positions of two numbers", point);
    out.emplace_back(point[0].get<double>(), point[1].get<double>());
    if (!(out.back().cwiseAbs().maxCoeff() <= kMaxGeoNumber))
      reject("coordinates within 1e12", point);
  }
  return out;
}

void GeoJsonPlan::polygon(const json& rings, Layer& layer) {
  if (!rings.is_array()) reject("a list of rings", rings);
  if (rings.empty()) return;  // an empty geometry
  Polygon out;
  for (size_t i = 0; i < rings.size(); ++i) {
    Polygon::Ring ring = positions(rings[i]);
    if (ring.size() < 4 || ring.front() != ring.back())
      throw InputError(file_,
                       fmt::format("rings of four positions or more in {}, the last equal "
                                   "to the first",
                                   place_),
                       ring.size() < 4 ? counted(ring.size(), "position") : "another last one");
    ring.pop_back();
    if (i == 0)
      out.outline = std::move(ring);
    else
      out.holes.push_back(std::move(ring));
  }
  layer.shapes.areas.push_back(std::move(out));
}

void GeoJsonPlan::line(const json& points, Layer& layer) {
  std::vector<Eigen::Vector2d> out = positions(points);
  if (out.empty()) return;
  if (out.size() < 2) reject("lines of two positions or more", points);
  layer.shapes.lines.push_back(std::move(out));
}

void GeoJsonPlan::geometry(const json& geometry, Layer& layer, int depth) {
  if (depth > kMaxGeometryDepth)
    throw InputError(file_, "collections at most 8 deep", "a deeper one");
  const json& type = member(geometry, "type");
  const std::string kind = type.is_string() ? type.get<std::string>() : "";
  if (kind == "GeometryCollection") {
    const json& parts = member(geometry, "geometries");
    if (!parts.is_array()) reject("a list of geometries", parts);
    for (const json& part : parts) this->geometry(part, layer, depth + 1);
    return;
  }
  if (kind == "Point" || kind == "MultiPoint") {
    ++points_[kind];
    return;
  }
  const bool is_area = kind == "Polygon" || kind == "MultiPolygon";
  if (!is_area && kind != "LineString" && kind != "MultiLineString")
    reject("a type of geometry (Polygon, LineString, ...)", type);
  const json& coordinates = member(geometry, "coordinates");
  if (!kind.starts_with("Multi"))
    return is_area ? polygon(coordinates, layer) : line(coordinates, layer);
  if (!coordinates.is_array()) reject("a list of coordinates", coordinates);
  for (const json& each : coordinates) is_area ? polygon(each, layer) : line(each, layer);
}

void GeoJsonPlan::feature(const json& feature) {
  const auto properties = feature.find("properties");
  Layer& layer = layer_of(properties != feature.end() ? *properties : json());
  const json& shape = member(feature, "geometry");
  if (shape.is_null()) {
    ++shapeless_;
    return;
  }
  ++layer.features;
  geometry(shape, layer, 0);
}

void GeoJsonPlan::use(Layer& layer, ImportedPlan& plan, UseTally& tally) const {
  const auto add = [&](PlanUse use, LayerShapes shapes) {
    if (shapes.is_empty()) return;
    const std::string name =
        layer.name.empty() ? std::string(kPlanUses[static_cast<size_t>(use)]) : layer.name;
    add_shapes(plan, use, std::move(shapes), name, tally.of(layer.layer, use));
  };
  join_lines(layer.shapes, 0.001 / options_.unit_m.value_or(1));
  if (layer.use) return add(*layer.use, std::move(layer.shapes));
  add(PlanUse::kWalkable, {.areas = std::move(layer.shapes.areas), .rings = {}, .lines = {}});
  add(PlanUse::kWalls, {.areas = {},
                        .rings = std::move(layer.shapes.rings),
                        .lines = std::move(layer.shapes.lines)});
}

ImportedPlan GeoJsonPlan::read(const std::string& text) {
  const json root = parse_plan_json(text, file_);
  const json& type = member(root, "type");
  require_lengths(root);
  if (type == "FeatureCollection") {
    const json& features = member(root, "features");
    if (!features.is_array()) reject("a list of features", features);
    size_t number = 0;
    for (const json& each : features) {
      place_ = fmt::format("feature {}", ++number);
      if (!each.is_object()) reject("an object", each);
      feature(each);
    }
  } else if (type == "Feature") {
    place_ = "the feature";
    feature(root);
  } else {
    Layer& layer = layer_of(json());
    ++layer.features;
    geometry(root, layer, 0);
  }
  std::sort(names_.begin(), names_.end());
  names_.erase(std::unique(names_.begin(), names_.end()), names_.end());
  choice_.require(names_, "a layer, type or name of the features");
  ImportedPlan out;
  out.kind = "GeoJSON";
  UseTally tally;
  size_t unused = 0;
  for (auto& [key, layer] : layers_) {
    if (choice_.is_empty() || layer.use)
      use(layer, out, tally);
    else
      unused += layer.features;
  }
  tally.add_to(out, file_);
  if (unused > 0)
    out.left_out.push_back(counted(unused, "feature") + " that --layer does not name");
  if (shapeless_ > 0)
    out.left_out.push_back(
        counted(shapeless_, "feature without geometry", "features without geometry"));
  for (const auto& [what, count] : points_) out.left_out.push_back(counted(count, what));
  return out;
}

}  // namespace

bool is_geojson(std::string_view head) {
  if (head.starts_with("\xef\xbb\xbf")) head.remove_prefix(3);
  const size_t begin = head.find_first_not_of(" \t\r\n");
  if (begin == std::string_view::npos || head[begin] != '{') return false;
  constexpr std::string_view kKinds[] = {
      "FeatureCollection", "Feature", "Polygon",         "MultiPolygon",
      "LineString",        "Point",   "MultiLineString", "GeometryCollection",
      "MultiPoint"};
  for (size_t at = head.find("\"type\""); at != std::string_view::npos;
       at = head.find("\"type\"", at + 1)) {
    std::string_view rest = head.substr(at + 6);
    const size_t value = rest.find_first_not_of(" \t\r\n:");
    if (value == std::string_view::npos || rest[value] != '"') continue;
    rest.remove_prefix(value + 1);
    const std::string_view word = rest.substr(0, rest.find('"'));
    if (std::find(std::begin(kKinds), std::end(kKinds), word) != std::end(kKinds)) return true;
  }
  return false;
}

ImportedPlan read_geojson(const ImportOptions& options) {
  const RegularFile file(options.file, kGeoJsonParser.expected, kMaxPlanBytes);
  return read_plan_sandboxed(file, kGeoJsonParser, [&](const RegularFile& opened) {
    return GeoJsonPlan(options, options.file.string())
        .read(plan_text(opened, kGeoJsonParser.expected));
  });
}

}  // namespace throng
