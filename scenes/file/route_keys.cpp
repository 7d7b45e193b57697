// Where people come from and go to.
#include <algorithm>
#include <cmath>

#include "base/errors.h"
#include "base/limits.h"
#include "crowd/crowd_plan.h"
#include "crowd/navigation/footprints.h"
#include "scenes/file/key_tables.h"
#include "scenes/file/scene_values.h"

namespace throng {
namespace {

/// From body to body, and so far that it is still a queue.
constexpr Range kSpacingRange{0.4, 10};
/// Each corner has a flow field.
constexpr int64_t kMaxCorners = 100;
/// Nearer corners have no direction from one to the next.
constexpr double kApart_m = 0.1;
/// Half the depth of a body, which has to stand there.
constexpr double kBody_m = 0.15;
constexpr double kSample_m = 0.05;

Key<QueueRule> line_key() {
  Key<QueueRule> line =
      custom_key<QueueRule>(
          "line",
          "where they stand: corners `[x, y]` from the first of them to the last; "
          "whoever does not find room on it stands in its direction beyond the end",
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
    if (!((rule.line_m[i] - rule.line_m[i - 1]).norm() >= kApart_m))
      throw InputError(
          fields.where(), fmt::format("corners of a line at least {} m apart", kApart_m),
          fmt::format("{} and {}", to_text(rule.line_m[i - 1]), to_text(rule.line_m[i])));
}

/// What stands in people's way.
/// Every point where somebody may have to stand.
void require_free(const Scene& scene, const std::vector<Footprint>& footprints,
                  const std::string& where, const Goal& goal, const Eigen::Vector2d& point) {
  if (!scene.ground.grown(-kBody_m).contains(point))
    throw InputError(where, fmt::format("a line within the ground ({})", to_text(scene.ground)),
                     to_text(point));
  if (goal.contains(point))
    throw InputError(where, "a line that ends before the goal",
                     fmt::format("{} in it", to_text(point)));
  for (const Footprint& each : footprints)
    if (distance_m(each.corners, point) < kBody_m)
      throw InputError(where, "a line with room to stand on",
                       fmt::format("{} at obstacle '{}'", to_text(point), each.obstacle->name));
}

void require_free_line(const Scene& scene, const std::string& where, const Goal& goal) {
  const std::vector<Footprint> footprints = footprints_of(scene);
  const std::vector<Eigen::Vector2d>& line_m = goal.queue.line_m;
  for (size_t i = 1; i < line_m.size(); ++i) {
    const Eigen::Vector2d way = line_m[i] - line_m[i - 1];
    const int steps = static_cast<int>(std::ceil(way.norm() / kSample_m));
    for (int step = 0; step <= steps; ++step)
      require_free(scene, footprints, where, goal, line_m[i - 1] + step / double(steps) * way);
  }
}

}  // namespace

const KeyTable<QueueRule>& queue_keys() {
  static const KeyTable<QueueRule> table = {
      .text = {.name = "queue", .meaning = "How people stand who wait for their turn"},
      .title = "a queue",
      .keys = {number("spacing_m", "from one to the next, middle to middle", &QueueRule::spacing_m,
                      kSpacingRange)},
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
                         "others");
    }
  }
}

namespace {

/// A thousand a second fill any entrance; more is a mistake in the unit.
constexpr Range kRateRange{0, 1000, true};
constexpr Range kEntersRange{0, 4};

/// A goal is one area, its corners among its keys, or several in a list.
void read_areas(ReadContext& context, Fields& fields, Goal& goal) {
  const Rectangle& ground = context.scene.ground;
  for (const YamlNode* item : fields.items("any_of", false))
    goal.areas.push_back(read_area(fields.file(), *item, "a goal", ground));
  if (!goal.areas.empty()) {
    expect_keys_without({"min_m", "max_m"}, goal_keys(), fields);
    return;
  }
  goal.areas.push_back(read_rectangle(fields, "a goal"));
  require_on_ground(fields.where(), "a goal", goal.areas.back(), ground);
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
  for (const Rectangle& area : goal.areas) add_value(hash, area);
}

void read_wait(ReadContext&, Fields& fields, Goal& goal) {
  if (const YamlNode* node = fields.find("wait_s"))
    goal.wait_s =
        read_distribution(fields.file(), *node, "wait_s", {0, 0, 0, kTimeRange.max}, kTimeRange);
}

/// One number adds what it added before there were others.
void add_wait(Hasher& hash, const Goal& goal) {
  hash.add(goal.wait_s.mean);
  if (goal.wait_s.std_dev > 0)
    hash.add(goal.wait_s.std_dev).add(goal.wait_s.min).add(goal.wait_s.max);
}

std::vector<Key<Goal>> later_rows_of_goals() {
  Key<Goal> queue =
      custom_key<Goal>("queue",
                       "people come in one after another, in the order in which they came, see "
                       "[Queues](#queues)",
                       "none, unless there is a `capacity`", map_rule("queue"))
          .with_reader(read_queue)
          .with_hash(
              [](Hasher& hash, const Goal& goal) { add_keys(queue_keys(), hash, goal.queue); });
  queue.is_default = [](const Goal& goal) { return !goal.has_queue; };
  return {whole("capacity",
                "how many are in each of its areas at once; the others [queue](#queues) outside",
                &Goal::capacity, 1, kMaxBodies)
              .with_fallback("any number; 1 with a `queue`"),
          queue};
}

void complete_goal(ReadContext& context, const Fields& fields, Goal& goal) {
  if (goal.is_limited()) context.queued_goals.emplace_back(fields.where(), goal);
}

KeyTable<Goal> make_goal_keys() {
  const std::vector<KeyText> corners = area_text().keys;
  return {
      .text = {.name = "goal",
               .meaning = "A rectangle to go to, or one of several",
               .choices = {{"min_m", "max_m"}, {"any_of"}}},
      .title = "a goal",
      .keys =
          {custom_key<Goal>("min_m", corners[0].meaning, "required, or `any_of`", corners[0].rule),
           custom_key<Goal>("max_m", corners[1].meaning, "required, or `any_of`", corners[1].rule),
           custom_key<Goal>(
               "any_of",
               "any one of these areas, for everybody the one that they expect to be through first",
               "required, or one area", list_rule("area", 1))
               .with_reader(read_areas)
               .with_hash(add_areas),
           custom_key<Goal>("wait_s",
                            "how long they stand there before going on: `{mean, deviation, min, "
                            "max}`, or one number for everybody",
                            "0", map_rule("distribution"))
               .with_reader(read_wait)
               .with_hash(add_wait),
           flag("waypoint",
                "a point on the way: reached on entering it. Otherwise people walk to a place of "
                "their own inside",
                &Goal::waypoint)},
      .later = later_rows_of_goals(),
      .complete = complete_goal};
}

Key<Source> entering_speed() {
  Key<Source> speed =
      custom_key<Source>("enters_mps", "how fast they are when they enter",
                         "as fast as those ahead let them",
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
      .text = {.name = "source", .meaning = "Where people enter while the scene runs"},
      .title = "a source",
      .keys =
          {custom_key<Source>("area", "the rectangle they appear in, wherever there is room", "",
                              map_rule("area"))
               .required()
               .with_reader([](ReadContext& context, Fields& fields, Source& source) {
                 source.area = read_area(fields.file(), fields.require("area"),
                                         "the area of a source", context.scene.ground);
               })
               .with_hash(&Source::area),
           whole("count", "how many in all; they belong to the group and have ids from the start",
                 &Source::count, 0, kMaxBodies)
               .required(),
           number("rate_per_s", "how many a second", &Source::rate_per_s, kRateRange).required(),
           number("start_s", "when the first one comes", &Source::start_s, kTimeRange),
           flag("random", "at random (a Poisson process), not evenly spaced", &Source::is_poisson)},
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
