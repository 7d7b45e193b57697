// How people stand who wait for their turn at a goal.
#include <algorithm>
#include <cmath>

#include "base/errors.h"
#include "base/limits.h"
#include "crowd/navigation/footprints.h"
#include "crowd/plan_limits.h"
#include "scenes/file/key_tables.h"
#include "scenes/file/scene_values.h"

namespace throng {
namespace {

/// From body to body, and so far that it is still a queue.
constexpr Range kSpacingRange{0.4, 10};
/// Each corner has a flow field.
constexpr int64_t kMostCorners = 100;
/// Nearer corners have no direction from one to the next.
constexpr double kApart_m = 0.1;
/// Half the depth of a body, which has to stand there.
constexpr double kBody_m = 0.15;
constexpr double kSample_m = 0.05;

Key<QueueRule> line_key() {
  Key<QueueRule> line =
      own_key<QueueRule>(
          "line",
          "where they stand: corners `[x, y]` from the first of them to the last; "
          "whoever does not find room on it stands in its direction beyond the end",
          "straight back from the nearest wall",
          {.kind = Rule::Kind::kPoints, .range = kPlaceRange, .least = 2, .most = kMostCorners})
          .reading([](Reading&, Fields& fields, QueueRule& rule) {
            if (fields.find("line") != nullptr) rule.line_m = fields.points("line", 2, kPlaceRange);
          })
          .hashing([](Hasher& hash, const QueueRule& rule) {
            hash.add(uint64_t{rule.line_m.size()});
            for (const Eigen::Vector2d& corner : rule.line_m) hash.add(corner.x()).add(corner.y());
          });
  line.is_default = [](const QueueRule& rule) { return rule.line_m.empty(); };
  return line;
}

std::string show(const Eigen::Vector2d& point) {
  return fmt::format("[{:.6g}, {:.6g}]", point.x(), point.y());
}

void complete_queue(Reading&, const Fields& fields, QueueRule& rule) {
  if (static_cast<int64_t>(rule.line_m.size()) > kMostCorners)
    throw InputError(fields.where(), fmt::format("a line of at most {} corners", kMostCorners),
                     fmt::format("{}", rule.line_m.size()));
  for (size_t i = 1; i < rule.line_m.size(); ++i)
    if (!((rule.line_m[i] - rule.line_m[i - 1]).norm() >= kApart_m))
      throw InputError(fields.where(),
                       fmt::format("corners of a line at least {} m apart", kApart_m),
                       fmt::format("{} and {}", show(rule.line_m[i - 1]), show(rule.line_m[i])));
}

/// What stands in people's way.
/// Every point where somebody may have to stand.
void require_free(const Scene& scene, const std::vector<Footprint>& footprints,
                  const std::string& where, const Goal& goal, const Eigen::Vector2d& point) {
  if (!scene.ground.grown(-kBody_m).contains(point))
    throw InputError(where, fmt::format("a line within the ground ({})", show(scene.ground)),
                     show(point));
  if (goal.contains(point))
    throw InputError(where, "a line that ends before the goal",
                     fmt::format("{} in it", show(point)));
  for (const Footprint& each : footprints)
    if (distance_m(each.corners, point) < kBody_m)
      throw InputError(where, "a line with room to stand on",
                       fmt::format("{} at obstacle '{}'", show(point), each.obstacle->name));
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

void require_lines(const Reading& reading) {
  for (size_t i = 0; i < reading.limited.size(); ++i) {
    const auto& [where, goal] = reading.limited[i];
    require_free_line(reading.scene, where, goal);
    for (size_t k = 0; k < i; ++k) {
      const Goal& other = reading.limited[k].second;
      if (other.areas == goal.areas &&
          (other.capacity != goal.capacity || other.has_queue != goal.has_queue ||
           other.queue != goal.queue))
        throw InputError(where,
                         fmt::format("the same 'capacity' and 'queue' as of the goal of the same "
                                     "areas at {}",
                                     reading.limited[k].first),
                         "others");
    }
  }
}

}  // namespace throng
