// Keys of goals, queues and sources.
#include <algorithm>
#include <cmath>

#include "base/errors.h"
#include "base/limits.h"
#include "crowd/crowd_plan.h"
#include "crowd/navigation/footprints.h"
#include "scenes/file/key_tables.h"
#include "scenes/file/polygon_values.h"
#include "scenes/file/scene_values.h"

namespace throng {
namespace {

/// From touching bodies to the widest distance that still is a queue, in metres.
constexpr Range kSpacingRange{0.4, 10};
/// Each corner needs a flow field.
constexpr int64_t kMaxCorners = 100;
/// Between nearer corners no direction is defined.
constexpr double kMinCornerDistance_m = 0.1;
/// Half the depth of a body that stands in the queue.
constexpr double kHalfBodyDepth_m = 0.15;
constexpr double kSample_m = 0.05;

Key<QueueRule> line_key() {
  Key<QueueRule> line =
      custom_key<QueueRule>(
          "line",
          "corners `[x, y]` of the queue from its first to its last position; if it is full, it "
          "continues straight on beyond the end",
          "straight back from the nearest wall",
          {.kind = Rule::Kind::kPoints, .range = kPositionRange, .min = 2, .max = kMaxCorners})
          .with_reader([](ReadContext&, Fields& fields, QueueRule& rule) {
            if (fields.find("line") != nullptr)
              rule.line_m = fields.points("line", 2, kPositionRange);
          })
          .with_hash([](Hasher& hash, const QueueRule& rule) {
            hash.add(uint64_t{rule.line_m.size()});
            for (const Eigen::Vector2d& corner : rule.line_m) hash.add(corner.x()).add(corner.y());
          });
  line.is_default = [](const QueueRule& rule) { return rule.line_m.empty(); };
  return line;
}

std::string to_text(const Eigen::Vector2d& point) {
  return fmt::format("[{:.6g}, {:.6g}]", point.x(), point.y());
}

void complete_queue(ReadContext&, const Fields& fields, QueueRule& rule) {
  if (static_cast<int64_t>(rule.line_m.size()) > kMaxCorners)
    throw InputError(fields.where(), fmt::format("a line of at most {} corners", kMaxCorners),
                     fmt::format("{}", rule.line_m.size()));
  for (size_t i = 1; i < rule.line_m.size(); ++i)
    if (!((rule.line_m[i] - rule.line_m[i - 1]).norm() >= kMinCornerDistance_m))
      throw InputError(
          fields.where(),
          fmt::format("corners of a line at least {} m apart", kMinCornerDistance_m),
          fmt::format("{} and {}", to_text(rule.line_m[i - 1]), to_text(rule.line_m[i])));
}

void require_free(const Scene& scene, const std::vector<Footprint>& footprints,
                  const std::string& where, const Goal& goal, const Eigen::Vector2d& point) {
  if (!scene.ground.grown(-kHalfBodyDepth_m).contains(point))
    throw InputError(where, fmt::format("a line within the ground ({})", to_text(scene.ground)),
                     to_text(point));
  if (goal.contains(point))
    throw InputError(where, "a line that ends before the goal",
                     fmt::format("{} in it", to_text(point)));
  for (const Footprint& each : footprints)
    if (distance_m(each.corners, point) < kHalfBodyDepth_m)
      throw InputError(where, "a line with free ground to stand on",
                       fmt::format("{} at obstacle '{}'", to_text(point), each.obstacle->name));
}

void require_free_line(const Scene& scene, const std::string& where, const Goal& goal) {
  const std::vector<Footprint> footprints = footprints_of(scene);
  const std::vector<Eigen::Vector2d>& line_m = goal.queue.line_m;
  for (size_t i = 1; i < line_m.size(); ++i) {
    const Eigen::Vector2d segment = line_m[i] - line_m[i - 1];
    const int steps = static_cast<int>(std::ceil(segment.norm() / kSample_m));
    for (int step = 0; step <= steps; ++step)
      require_free(scene, footprints, where, goal, line_m[i - 1] + step / double(steps) * segment);
  }
}

}  // namespace

const KeyTable<QueueRule>& queue_keys() {
  static const KeyTable<QueueRule> table = {
      .text = {.name = "queue", .meaning = "Places of agents that wait for their turn"},
      .title = "a queue",
      .keys = {number("spacing_m", "distance between the centres of neighbours, in metres",
                      &QueueRule::spacing_m, kSpacingRange)},
      .later = {line_key()},
      .complete = complete_queue};
  return table;
}

void require_lines(const ReadContext& context) {
  for (size_t i = 0; i < context.queued_goals.size(); ++i) {
    const auto& [where, goal] = context.queued_goals[i];
    require_free_line(context.scene, where, goal);
    for (size_t k = 0; k < i; ++k) {
      const Goal& other = context.queued_goals[k].second;
      if (other.areas == goal.areas &&
          (other.capacity != goal.capacity || other.has_queue != goal.has_queue ||
           other.queue != goal.queue))
        throw InputError(where,
                         fmt::format("the same 'capacity' and 'queue' as of the goal of the same "
                                     "areas at {}",
                                     context.queued_goals[k].first),
                         "other values");
    }
  }
}

namespace {

constexpr Range kEntersRange{0, kMaxEntrySpeed_mps};

void read_areas(ReadContext& context, Fields& fields, Goal& goal) {
  for (const YamlNode* item : fields.items("any_of", false))
    goal.areas.push_back(read_area(context, fields.file(), *item, "a goal"));
  if (!goal.areas.empty()) {
    expect_keys_without({"min_m", "max_m", "polygon", "holes", "wkt"}, goal_keys(), fields);
    return;
  }
  goal.areas.push_back(read_area(context, fields, "a goal"));
}

void read_queue(ReadContext& context, Fields& fields, Goal& goal) {
  const YamlNode* node = fields.find("queue");
  if (node == nullptr) return;
  Fields inner(fields.file(), *node, queue_keys().title);
  read_keys(queue_keys(), context, inner, goal.queue);
  goal.has_queue = true;
}

void add_areas(Hasher& hash, const Goal& goal) {
  hash.add(uint64_t{goal.areas.size()});
  for (const Area& area : goal.areas) add_value(hash, area);
}

void read_wait(ReadContext&, Fields& fields, Goal& goal) {
  if (const YamlNode* node = fields.find("wait_s"))
    goal.wait_s =
        read_distribution(fields.file(), *node, "wait_s", {0, 0, 0, kTimeRange.max}, kTimeRange);
}

/// A single number adds one value, like a wait without a distribution.
void add_wait(Hasher& hash, const Goal& goal) {
  hash.add(goal.wait_s.mean);
  if (goal.wait_s.std_dev > 0)
    hash.add(goal.wait_s.std_dev).add(goal.wait_s.min).add(goal.wait_s.max);
}

std::vector<Key<Goal>> later_rows_of_goals() {
  Key<Goal> queue =
      custom_key<Goal>("queue",
                       "agents are served one after another in the order of their arrival, see "
                       "docs/scenes.md#queue-at-counters",
                       "none, unless there is a `capacity`", map_rule("queue"))
          .with_reader(read_queue)
          .with_hash(
              [](Hasher& hash, const Goal& goal) { add_keys(queue_keys(), hash, goal.queue); });
  queue.is_default = [](const Goal& goal) { return !goal.has_queue; };
  return {whole("capacity", "maximum number of agents in each area; the others queue outside",
                &Goal::capacity, 1, kMaxBodies)
              .with_fallback("any number; 1 with a `queue`"),
          queue};
}

void complete_goal(ReadContext& context, const Fields& fields, Goal& goal) {
  if (goal.is_limited()) context.queued_goals.emplace_back(fields.where(), goal);
}

KeyTable<Goal> make_goal_keys() {
  KeyTable<Goal> table = {
      .text = {.name = "goal",
               .meaning = "An area to reach, or the fastest of several",
               .choices = {{"min_m", "max_m"}, {"polygon"}, {"wkt"}, {"any_of"}}},
      .title = "a goal",
      .keys =
          {custom_key<Goal>(
               "any_of",
               "alternative areas; each agent chooses the one with the least expected time",
               "required, or one area", list_rule("area", 1))
               .with_reader(read_areas)
               .with_hash(add_areas),
           custom_key<Goal>("wait_s",
                            "time at the goal before going on, in seconds: `{mean, std_dev, min, "
                            "max}`, or one number for all agents",
                            "0", map_rule("distribution"))
               .with_reader(read_wait)
               .with_hash(add_wait),
           flag("waypoint",
                "true: the goal counts as reached on entering its area; false: each agent walks to "
                "its own place inside",
                &Goal::waypoint)},
      .later = later_rows_of_goals(),
      .complete = complete_goal};
  std::vector<Key<Goal>> area;
  for (const KeyText& text : area_key_texts())
    area.push_back(custom_key<Goal>(text.name, text.meaning,
                                    text.fallback == "none" ? "none" : "required, or `any_of`",
                                    text.rule));
  table.keys.insert(table.keys.begin(), area.begin(), area.end());
  return table;
}

Key<Source> entering_speed() {
  Key<Source> speed =
      custom_key<Source>("enters_mps", "speed of entering agents, in m/s",
                         "desired speed, limited by agents ahead",
                         {.kind = Rule::Kind::kNumber, .range = kEntersRange})
          .with_reader([](ReadContext&, Fields& fields, Source& source) {
            if (fields.find("enters_mps") != nullptr)
              source.enters_mps = fields.number_or("enters_mps", kEntersRange, 0);
          })
          .with_hash([](Hasher& hash, const Source& source) { hash.add(*source.enters_mps); });
  speed.is_default = [](const Source& source) { return !source.enters_mps; };
  return speed;
}

KeyTable<Source> make_source_keys() {
  return {
      .text = {.name = "source", .meaning = "Area where agents enter during the run"},
      .title = "a source",
      .keys =
          {custom_key<Source>("area", "area in which agents appear where it is free", "",
                              map_rule("area"))
               .required()
               .with_reader([](ReadContext& context, Fields& fields, Source& source) {
                 source.area = read_area(context, fields.file(), fields.require("area"),
                                         "the area of a source");
               })
               .with_hash(&Source::area),
           whole("count",
                 "total number of agents that enter; their ids are reserved from the start",
                 &Source::count, 0, kMaxBodies)
               .required(),
           number("rate_per_s", "agents per second", &Source::rate_per_s, kRateRange).required(),
           number("start_s", "time of the first arrival, in seconds", &Source::start_s, kTimeRange),
           word<Source, bool>("arrivals",
                              "arrival process: `even` intervals, or `poisson` (random intervals "
                              "with the same mean)",
                              &Source::is_poisson, {{"even", false}, {"poisson", true}})},
      .later = {entering_speed()}};
}

}  // namespace

const KeyTable<Goal>& goal_keys() {
  static const KeyTable<Goal> table = make_goal_keys();
  return table;
}

const KeyTable<Source>& source_keys() {
  static const KeyTable<Source> table = make_source_keys();
  return table;
}

}  // namespace throng
