#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "base/console.h"
#include "base/limits.h"
#include "scenes/file/scene.h"
#include "scenes/file/scene_keys.h"

namespace throng {
namespace {

using Json = nlohmann::ordered_json;

Json reference(const std::string& map) { return {{"$ref", "#/$defs/" + map}}; }

Json any_of(std::initializer_list<Json> choices) { return {{"anyOf", Json(choices)}}; }

/// Prints integer limits without a decimal point.
Json limit(double value) {
  const auto whole = static_cast<int64_t>(value);
  if (static_cast<double>(whole) == value) return whole;
  return value;
}

Json number(const Range& range) {
  const Json decimal = {{"type", "number"},
                        {range.above_min ? "exclusiveMinimum" : "minimum", limit(range.min)},
                        {"maximum", limit(range.max)}};
  return any_of({decimal, reference("fraction")});
}

/// A name may look like a number or a Boolean in YAML.
Json text(const std::string& pattern) {
  if (!pattern.empty()) return {{"type", "string"}, {"pattern", pattern}};
  return any_of(
      {{{"type", "string"}, {"minLength", 1}}, {{"type", "number"}}, {{"type", "boolean"}}});
}

Json list(const Json& items, const Rule& rule) {
  Json json = {{"type", "array"}};
  if (rule.min > 0) json["minItems"] = rule.min;
  if (rule.max > 0) json["maxItems"] = rule.max;
  json["items"] = items;
  return json;
}

Json schema_of(const Rule& rule) {
  switch (rule.kind) {
    case Rule::Kind::kText:
      return text(rule.pattern);
    case Rule::Kind::kWhole:
      return {{"type", "integer"}, {"minimum", rule.min}, {"maximum", rule.max}};
    case Rule::Kind::kNumber:
      return number(rule.range);
    case Rule::Kind::kFlag:
      return {{"type", "boolean"}};
    case Rule::Kind::kWord:
      return {{"enum", rule.words}};
    case Rule::Kind::kNumbers:
      return list(number(rule.range), rule);
    case Rule::Kind::kPoints:
      return list(list(number(rule.range), {.min = 2, .max = 2}), rule);
    case Rule::Kind::kRings:
      return list(list(list(number(rule.range), {.min = 2, .max = 2}), rule), {});
    case Rule::Kind::kVertices:
      return list(list(number(rule.range), {.min = 3, .max = 3}), rule);
    case Rule::Kind::kTriangles:
      return list(list({{"type", "integer"}, {"minimum", 0}}, {.min = 3, .max = 3}), rule);
    case Rule::Kind::kMap:
      return reference(rule.map);
    case Rule::Kind::kList:
      return list(reference(rule.map), rule);
  }
  return {};
}

Json schema_of(const KeyText& key) {
  std::string description = key.meaning;
  description += key.required ? "; required" : "; without it: " + key.fallback;
  Json json = {{"description", description}};
  json.update(schema_of(key.rule));
  return json;
}

Json object_of(const MapText& map) {
  Json json = {{"type", "object"}, {"properties", Json::object()}, {"required", Json::array()}};
  for (const KeyText& key : map.keys) {
    json["properties"][key.name] = schema_of(key);
    if (key.required) json["required"].push_back(key.name);
  }
  json["additionalProperties"] = map.any_key.empty() ? Json(false) : Json{{"enum", map.any_key}};
  if (map.at_least_one) json["minProperties"] = 1;
  for (const std::vector<std::string>& choice : map.choices)
    json["anyOf"].push_back({{"required", choice}});
  return json;
}

Json schema_of(const MapText& map) {
  Json json = {{"description", map.meaning}};
  if (map.or_number)
    json.update(any_of({number(map.keys.front().rule.range), object_of(map)}));
  else if (map.or_points)
    json.update(
        any_of({list(list(number({-kMaxCoordinate_m, kMaxCoordinate_m}), {.min = 2, .max = 2}),
                     {.min = 1}),
                object_of(map)}));
  else if (!map.or_words.empty())
    json.update(any_of({{{"enum", map.or_words}}, object_of(map)}));
  else
    json.update(object_of(map));
  return json;
}

/// JSON Schema (2020-12) of a scene file, generated from the tables of the scene reader.
Json scene_schema() {
  const std::vector<MapText> maps = scene_maps();
  Json json = {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
               {"title", "Throng scene"}};
  json.update(schema_of(maps.front()));
  json["$defs"]["fraction"] = {{"description", "A number may be written as a fraction: 1/60"},
                               {"type", "string"},
                               {"pattern", "^[+-]?[0-9.]+/[0-9.]+$"}};
  for (size_t i = 1; i < maps.size(); ++i) json["$defs"][maps[i].name] = schema_of(maps[i]);
  return json;
}

}  // namespace

Command add_scenes_command(CommandLine& parent) {
  CommandOptions* app = parent.add_subcommand("scenes", "List the bundled scenes");
  const auto schema = std::make_shared<bool>(false);
  app->add_flag("--schema", *schema, "Print the JSON Schema of scene files, for editors");
  const auto action = [schema] {
    if (*schema) {
      print_result("{}\n", scene_schema().dump(2));
      return kExitSuccess;
    }
    const std::vector<SceneEntry> scenes = bundled_scenes();
    size_t width = 0;
    for (const SceneEntry& scene : scenes) width = std::max(width, scene.name.size());
    for (const SceneEntry& scene : scenes)
      print_result("{:<{}}  {}\n", scene.name, width, scene.description);
    return kExitSuccess;
  };
  return {app, action};
}

}  // namespace throng
