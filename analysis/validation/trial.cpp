#include "analysis/validation/trial.h"

#include <algorithm>
#include <numeric>

namespace throng::validation {
namespace {

SimulationOptions people_only(Trial::Detail detail) {
  SimulationOptions options;
  options.postures = detail == Trial::Detail::kBodies;
  options.culling = false;
  return options;
}

/// True if the segment crosses the inside of the rectangle or ends there.
bool enters(const Rectangle& wall, const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  constexpr double kTouch_m = 1e-9;
  double enter = 0;
  double leave = 1;
  for (int axis = 0; axis < 2; ++axis) {
    const double low = wall.min_m[axis] + kTouch_m;
    const double high = wall.max_m[axis] - kTouch_m;
    const double step_m = to[axis] - from[axis];
    if (step_m == 0) {
      if (from[axis] <= low || from[axis] >= high) return false;
      continue;
    }
    const double first = (low - from[axis]) / step_m;
    const double second = (high - from[axis]) / step_m;
    enter = std::max(enter, std::min(first, second));
    leave = std::min(leave, std::max(first, second));
  }
  return enter <= leave;
}

}  // namespace

Trial::Trial(const Plan& plan, Detail detail)
    : simulation_(plan.scene, people_only(detail)),
      walls_(plan.walls),
      ground_(plan.scene.ground),
      step_s_(plan.scene.step_s) {
  if (detail == Detail::kBodies) heads_.emplace(simulation_.info());
  take(simulation_.step());
  previous_m_ = positions_m_;
  previous_headings_ = headings_;
  was_present_ = present_;
}

void Trial::take(const Frame& frame) {
  positions_m_.resize(frame.roots.size());
  headings_.resize(frame.roots.size());
  for (size_t id = 0; id < positions_m_.size(); ++id) {
    const RootPose& root = frame.roots[id];
    positions_m_[id] = root.position_m.head<2>();
    const Eigen::Vector3f ahead = root.world_from_root * Eigen::Vector3f::UnitX();
    headings_[id] = ahead.head<2>().cast<double>().normalized();
  }
  if (heads_) {
    heads_m_.resize(frame.roots.size());
    heads_->find(simulation_.info(), frame, heads_m_);
  }
  if (frame.present.empty())
    present_.assign(positions_m_.size(), 1);
  else
    present_.assign(frame.present.begin(), frame.present.end());
}

bool Trial::crosses_wall(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const {
  return !ground_.contains(to) || std::any_of(walls_.begin(), walls_.end(), [&](const auto& wall) {
    return enters(wall, from, to);
  });
}

bool Trial::step(double until_s) {
  const bool all_came = simulation_.population().entered >= size();
  if (now_s_ >= until_s || (present() == 0 && all_came)) return false;
  previous_m_ = positions_m_;
  previous_headings_ = headings_;
  was_present_ = present_;
  take(simulation_.step());
  now_s_ += step_s_;
  for (size_t id = 0; id < size(); ++id)
    if (was_present_[id] != 0 && present_[id] != 0)
      wall_crossings_ += crosses_wall(previous_m_[id], positions_m_[id]);
  max_overlap_m_ = std::max(max_overlap_m_, simulation_.steering().max_overlap_m);
  return true;
}

size_t Trial::present() const {
  return static_cast<size_t>(std::accumulate(present_.begin(), present_.end(), 0));
}

void Gate::watch(const Trial& trial) {
  passed_.resize(trial.size(), 0);
  for (size_t id = 0; id < trial.size(); ++id) {
    if (passed_[id] != 0) continue;
    const double sign = upwards_ ? 1 : -1;
    const double before = sign * (trial.previous_m(id)[axis_] - at_);
    const double after = sign * (trial.position_m(id)[axis_] - at_);
    if (before >= 0 || after < 0) continue;
    const double across = trial.position_m(id)[1 - axis_];
    if (across < low_ || across > high_) continue;
    passed_[id] = 1;
    const double share = before / (before - after);
    passages_.push_back({trial.now_s() - (1 - share) * trial.step_s(), id});
  }
}

std::vector<double> Gate::times_s() const {
  std::vector<double> times;
  for (const Passage& passage : passages_) times.push_back(passage.time_s);
  std::sort(times.begin(), times.end());
  return times;
}

void note(Outcome& outcome, const Trial& trial) {
  outcome.wall_crossings += trial.wall_crossings();
  outcome.unplaced += trial.unplaced();
  outcome.max_overlap_m = std::max(outcome.max_overlap_m, trial.max_overlap_m());
}

double flow_per_s(const std::vector<double>& times_s) {
  if (times_s.size() < 2 || times_s.back() <= times_s.front()) return 0;
  return static_cast<double>(times_s.size() - 1) / (times_s.back() - times_s.front());
}

}  // namespace throng::validation
