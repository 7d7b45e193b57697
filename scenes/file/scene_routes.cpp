#include "scenes/file/scene_routes.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/errors.h"
#include "scenes/file/scene_keys.h"
#include "scenes/file/scene_limits.h"

namespace throng {
namespace {

/// Of waiting, starting late and arriving: from at once to the end of the longest run.
constexpr Range kTimeRange{0, 1e7};
/// A thousand a second fill any entrance; more is a mistake in the unit.
constexpr Range kRateRange{0, 1000, true};

constexpr std::pair<const char*, OnArrival> kArrivals[] = {
    {"loop", OnArrival::kLoop}, {"stay", OnArrival::kStay}, {"leave", OnArrival::kLeave}};

std::string show(const Rectangle& r) {
  return fmt::format("[{}, {}] to [{}, {}]", r.min_m.x(), r.min_m.y(), r.max_m.x(), r.max_m.y());
}

void require_on_ground(const std::string& where, const std::string& what, const Rectangle& area,
                       const Rectangle& ground) {
  if (!ground.contains(area.min_m) || !ground.contains(area.max_m))
    throw InputError(where, fmt::format("{} within the ground ({})", what, show(ground)),
                     show(area));
}

Goal read_goal(const std::string& file, const YamlNode& node, const Rectangle& ground) {
  Fields fields(file, node, "a goal");
  fields.expect_keys(keys_of("goal"));
  Goal goal;
  for (const YamlNode* item : items_of(fields, "nearest_of", false))
    goal.areas.push_back(read_area(file, *item, "a goal", ground));
  if (goal.areas.empty()) {
    goal.areas.push_back(read_rectangle(fields, "a goal"));
    require_on_ground(fields.where(node), "a goal", goal.areas.back(), ground);
  }
  goal.wait_s = fields.number_or("wait_s", kTimeRange, 0);
  goal.pass = fields.boolean_or("pass", false);
  fields.done();
  return goal;
}

Source read_source(const std::string& file, const YamlNode& node, const Rectangle& ground) {
  Fields fields(file, node, "a source");
  fields.expect_keys(keys_of("source"));
  Source source;
  source.area = read_area(file, fields.require("area"), "the area of a source", ground);
  source.count = static_cast<int>(fields.integer_or("count", 0, kMaxBodies, std::nullopt));
  source.rate_per_s = fields.number("rate_per_s", kRateRange);
  source.start_s = fields.number_or("start_s", kTimeRange, 0);
  source.random = fields.boolean_or("random", false);
  fields.done();
  return source;
}

OnArrival read_on_arrival(Fields& fields) {
  const std::string name = fields.text_or("on_arrival", "loop");
  std::vector<std::string> names;
  for (const auto& [known, value] : kArrivals) {
    if (name == known) return value;
    names.emplace_back(known);
  }
  throw InputError(fields.where(fields.require("on_arrival")), "on_arrival: loop, stay or leave",
                   fmt::format("'{}'{}", name, did_you_mean(name, names)));
}

}  // namespace

Rectangle read_area(const std::string& file, const YamlNode& node, const std::string& what,
                    const Rectangle& ground) {
  const Rectangle area = read_rectangle(file, node, what);
  require_on_ground(at_line(file, node.line), what, area, ground);
  return area;
}

std::vector<const YamlNode*> items_of(Fields& fields, const std::string& key, bool required) {
  std::vector<const YamlNode*> items;
  const YamlNode* node = required ? &fields.require(key) : fields.find(key);
  if (node == nullptr) return items;
  if (node->kind != YamlNode::Kind::kList || (required && node->items.empty()))
    throw InputError(fields.where(*node), fmt::format("a list for '{}'", key), describe(*node));
  for (const YamlNode& item : node->items) items.push_back(&item);
  return items;
}

void read_routes(Fields& fields, const Rectangle& ground, Group& group) {
  if (!group.driven.empty()) {
    for (const char* key : {"goals", "on_arrival", "sources", "delay_s"})
      if (const YamlNode* node = fields.find(key))
        throw InputError(fields.where(*node), "no goals and no sources for a driven group",
                         fmt::format("'{}'", key));
    group.goals.emplace_back().areas.push_back(group.spawn);
    return;
  }
  for (const YamlNode* goal : items_of(fields, "goals", true))
    group.goals.push_back(read_goal(fields.file(), *goal, ground));
  group.on_arrival = read_on_arrival(fields);
  for (const YamlNode* source : items_of(fields, "sources", false))
    group.sources.push_back(read_source(fields.file(), *source, ground));
  if (const YamlNode* node = fields.find("delay_s"))
    group.delay_s =
        read_distribution(fields.file(), *node, "delay_s", {0, 0, 0, kTimeRange.max}, kTimeRange);
}

}  // namespace throng
