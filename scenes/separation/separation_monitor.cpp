#include "scenes/separation/separation_monitor.h"

#include <algorithm>
#include <tuple>

#include "scenes/run/sink.h"
#include "scenes/separation/separation_rule.h"

namespace throng {
namespace {

constexpr double kUnknownSpeed = std::numeric_limits<double>::quiet_NaN();

auto key_of(const Shortfall& shortfall) {
  return std::tuple(shortfall.robot, shortfall.person, shortfall.region);
}

/// Previous position of the material point of a part that is now at `point_m` (relative to the
/// root).
Eigen::Vector3d carried_back(const PartPose& now, const PartPose& then,
                             const Eigen::Vector3d& point_m) {
  const Eigen::Isometry3d then_from_now = to_isometry(then) * to_isometry(now).inverse();
  return then_from_now * point_m;
}

}  // namespace

SeparationMonitor::SeparationMonitor(const RunInfo& run)
    : rule_(*run.scene->separation),
      step_s_(run.step_s),
      margin_m_(run.culler.proximity.margin_m),
      model_of_avatar_(run.model_of_avatar) {
  for (const std::shared_ptr<const Model>& model : run.models) {
    std::vector<BodyRegion>& regions = regions_.emplace_back();
    for (const Part& part : model->parts) regions.push_back(body_region(part.name));
  }
  for (uint32_t id = 0; id < model_of_avatar_.size(); ++id) {
    const uint16_t model = model_of_avatar_[id];
    const bool is_robot = !run.models[model]->is_person;
    robot_index_.push_back(is_robot ? static_cast<int32_t>(robots_.size()) : -1);
    if (is_robot) robots_.push_back(id);
    if (is_robot) continue;
    for (const BodyRegion region : regions_[model])
      totals_.regions[static_cast<size_t>(region)].is_there = true;
  }
  totals_.robots = static_cast<uint32_t>(robots_.size());
  if (!rule_.is_measured()) return;
  for (const uint32_t robot : robots_) {
    const auto parts = static_cast<size_t>(run.models[model_of_avatar_[robot]]->part_count());
    robot_parts_.push_back({false, {}, std::vector<PartPose>(parts), std::vector<PartPose>(parts)});
  }
}

void SeparationMonitor::pose_robots(const RunInfo& run, const Frame& frame) {
  for (size_t i = 0; i < robot_parts_.size(); ++i)
    part_poses(run, frame, robots_[i], robot_parts_[i].current);
}

void SeparationMonitor::store_robot_poses(const Frame& frame) {
  for (size_t i = 0; i < robot_parts_.size(); ++i) {
    RobotParts& robot_parts = robot_parts_[i];
    robot_parts.is_known = frame.present.empty() || frame.present[robots_[i]] != 0;
    robot_parts.root = frame.roots[robots_[i]];
    robot_parts.previous.swap(robot_parts.current);
  }
}

/// Speed towards the person of the robot's material point that is nearest to it.
double SeparationMonitor::robot_speed_mps(const ProximityPair& pair, bool robot_is_a) const {
  const uint32_t robot = robot_is_a ? pair.pair.a() : pair.pair.b();
  const uint32_t part = robot_is_a ? pair.pair.part_a() : pair.pair.part_b();
  const RobotParts& robot_parts = robot_parts_[static_cast<size_t>(robot_index_[robot])];
  if (pair.level != PairLevel::kTriangles || !robot_parts.is_known ||
      part >= robot_parts.current.size())
    return kUnknownSpeed;
  const auto& point = robot_is_a ? pair.point_a_m : pair.point_b_m;
  const Eigen::Vector3d root = roots_[robot].position_m;
  const Eigen::Vector3d from_root = Eigen::Vector3d(point.data()) - root;
  const Eigen::Vector3d then =
      carried_back(robot_parts.current[part], robot_parts.previous[part], from_root);
  const Eigen::Vector3d moved = (root - robot_parts.root.position_m) + (from_root - then);
  const Eigen::Vector3d a_to_b = Eigen::Vector3f(pair.normal.data()).cast<double>();
  return moved.dot(a_to_b) * (robot_is_a ? 1 : -1) / step_s_;
}

void SeparationMonitor::add(const ProximityPair& pair) {
  const uint32_t a = pair.pair.a(), b = pair.pair.b();
  const bool robot_is_a = is_robot(a) && is_person(b);
  if (!robot_is_a && !(is_person(a) && is_robot(b))) return;
  const uint32_t person = robot_is_a ? b : a;
  const uint32_t part = robot_is_a ? pair.pair.part_b() : pair.pair.part_a();
  const std::vector<BodyRegion>& regions = regions_[model_of_avatar_[person]];
  EvaluatedPair evaluated;
  evaluated.robot_index = static_cast<uint32_t>(robot_index_[robot_is_a ? a : b]);
  evaluated.person = person;
  evaluated.region = part < regions.size() ? regions[part] : BodyRegion::kOther;
  RegionSeparation& row = evaluated.row;
  row.robot = robot_is_a ? a : b;
  row.region = evaluated.region;
  row.lo_m = pair.lo_m;
  row.hi_m = pair.hi_m;
  row.pair = pair.pair;
  row.closing_speed_mps = pair.closing_speed_mps;
  const double measured = rule_.is_measured() ? robot_speed_mps(pair, robot_is_a) : kUnknownSpeed;
  const double robot = rule_.robot_speed_mps.value_or(measured);
  const double human =
      rule_.human_speed_mps.value_or(static_cast<double>(pair.closing_speed_mps) - measured);
  row.robot_speed_mps = static_cast<float>(robot);
  row.human_speed_mps = static_cast<float>(human);
  row.required_m = static_cast<float>(protective_distance(rule_, human, robot).total_m());
  if (evaluated.is_determined()) row.min_slack_m = row.lo_m - row.required_m;
  ++totals_.pairs;
  totals_.undetermined += !evaluated.is_determined();
  totals_.beyond_margin += row.required_m > margin_m_;
  evaluated_.push_back(evaluated);
}

void SeparationMonitor::fill_rows(const Frame& frame) {
  rows_.clear();
  size_t next = 0;
  std::array<RegionSeparation, kBodyRegions> of_robot;
  for (size_t i = 0; i < robots_.size(); ++i) {
    of_robot.fill({});
    uint32_t last_person = UINT32_MAX;
    std::array<bool, kBodyRegions> counted{};
    for (; next < evaluated_.size() && evaluated_[next].robot_index == i; ++next) {
      const EvaluatedPair& evaluated = evaluated_[next];
      if (evaluated.person != last_person) counted = {};
      last_person = evaluated.person;
      const auto region = static_cast<size_t>(evaluated.region);
      RegionSeparation& row = of_robot[region];
      const float min_slack_m = row.min_slack_m;
      const uint32_t people_too_close = row.people_too_close;
      if (row.is_far() || std::tuple(evaluated.row.lo_m, evaluated.row.hi_m, evaluated.row.pair) <
                              std::tuple(row.lo_m, row.hi_m, row.pair))
        row = evaluated.row;
      row.min_slack_m = evaluated.is_determined() && !(evaluated.row.min_slack_m >= min_slack_m)
                            ? evaluated.row.min_slack_m
                            : min_slack_m;
      row.people_too_close =
          people_too_close + (evaluated.is_too_close() && !counted[region] ? 1 : 0);
      counted[region] |= evaluated.is_too_close();
    }
    if (!frame.present.empty() && frame.present[robots_[i]] == 0) continue;
    for (size_t region = 0; region < kBodyRegions; ++region) {
      RegionTotals& totals = totals_.regions[region];
      if (!totals.is_there) continue;
      RegionSeparation& row = of_robot[region];
      if (row.is_far()) {
        row.robot = robots_[i];
        row.region = static_cast<BodyRegion>(region);
        row.lo_m = margin_m_;
      }
      if (std::tuple(row.lo_m, row.hi_m) <
              std::tuple(totals.min_distance_lo_m, totals.min_distance_hi_m) &&
          !row.is_far()) {
        totals.min_distance_lo_m = row.lo_m;
        totals.min_distance_hi_m = row.hi_m;
      }
      if (row.people_too_close > 0) totals.shortfall_s += step_s_;
      rows_.push_back(row);
    }
  }
}

void SeparationMonitor::close(Shortfall shortfall, bool truncated) {
  shortfall.end_frame = frame_;
  shortfall.is_truncated |= truncated;
  ended_.push_back(shortfall);
}

/// Begins, continues or ends the shortfall of one robot, person and region. `open`: index into
/// open_ after all preceding ones.
void SeparationMonitor::update_shortfall(std::span<const EvaluatedPair> pairs, size_t& open) {
  const EvaluatedPair& first = pairs.front();
  const auto key = std::tuple(first.row.robot, first.person, first.region);
  for (; open < open_.size() && key_of(open_[open]) < key; ++open) close(open_[open], false);
  const bool was_open = open < open_.size() && key_of(open_[open]) == key;
  bool is_too_close = false, is_undetermined = false;
  for (const EvaluatedPair& evaluated : pairs) {
    is_too_close |= evaluated.is_too_close();
    is_undetermined |= !evaluated.is_determined();
  }
  // Undetermined pairs neither begin nor end a shortfall.
  const bool continues = is_too_close || (was_open && is_undetermined);
  if (was_open && !continues) close(open_[open], false);
  if (was_open && continues) next_open_.push_back(open_[open]);
  if (was_open) ++open;
  if (!continues) return;
  if (!was_open)
    next_open_.push_back({.robot = first.row.robot,
                          .person = first.person,
                          .region = first.region,
                          .begin_frame = frame_,
                          .is_truncated = frames_seen_ <= (rule_.is_measured() ? 2 : 1)});
  Shortfall& shortfall = next_open_.back();
  for (const EvaluatedPair& evaluated : pairs) {
    if (std::tuple(evaluated.row.lo_m, evaluated.row.hi_m) <
        std::tuple(shortfall.min_distance_lo_m, shortfall.min_distance_hi_m)) {
      shortfall.min_distance_lo_m = evaluated.row.lo_m;
      shortfall.min_distance_hi_m = evaluated.row.hi_m;
    }
    if (evaluated.is_determined())
      shortfall.max_shortfall_m =
          std::max(shortfall.max_shortfall_m, 0 - evaluated.row.min_slack_m);
    shortfall.is_beyond_margin |= evaluated.row.required_m > margin_m_;
  }
  RegionTotals& totals = totals_.regions[static_cast<size_t>(first.region)];
  totals.max_shortfall_m = std::max(totals.max_shortfall_m, shortfall.max_shortfall_m);
  if (was_open) return;
  ++totals.shortfalls;
  ++totals_.shortfalls;
  begun_.push_back(shortfall);
}

void SeparationMonitor::frame(const RunInfo& run, const Frame& frame) {
  frame_ = frame.number;
  ++frames_seen_;
  roots_ = frame.roots;
  evaluated_.clear();
  begun_.clear();
  ended_.clear();
  next_open_.clear();
  pose_robots(run, frame);
  for (const ProximityPair& pair : frame.proximity_pairs) add(pair);
  store_robot_poses(frame);
  std::sort(evaluated_.begin(), evaluated_.end(),
            [](const EvaluatedPair& p, const EvaluatedPair& q) {
              return std::tuple(p.key(), p.row.pair) < std::tuple(q.key(), q.row.pair);
            });
  fill_rows(frame);
  size_t open = 0;
  for (size_t i = 0; i < evaluated_.size();) {
    size_t end = i + 1;
    while (end < evaluated_.size() && evaluated_[end].key() == evaluated_[i].key()) ++end;
    update_shortfall({evaluated_.data() + i, end - i}, open);
    i = end;
  }
  for (; open < open_.size(); ++open) close(open_[open], false);
  open_.swap(next_open_);
}

void SeparationMonitor::end() {
  begun_.clear();
  ended_.clear();
  ++frame_;
  for (const Shortfall& shortfall : open_) close(shortfall, true);
  open_.clear();
}

}  // namespace throng
