// Trial runs the scene of a test step by step, checks walls and records positions.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "analysis/measures/recent_crowd.h"
#include "analysis/validation/plan.h"
#include "analysis/validation/validation.h"
#include "scenes/run/simulation.h"

namespace throng::validation {

/// Walls are checked for every move with arithmetic that is independent of steering.
class Trial {
 public:
  /// kBodies provides heads; kPositions is faster and only provides roots.
  enum class Detail { kPositions, kBodies };
  explicit Trial(const Plan& plan, Detail detail = Detail::kPositions);

  /// Advances by a step; false at `until_s` or when all people have entered and left.
  bool step(double until_s);

  double now_s() const { return now_s_; }
  double step_s() const { return step_s_; }
  size_t size() const { return positions_m_.size(); }
  bool is_present(size_t id) const { return present_[id] != 0; }
  size_t present() const;
  int unplaced() const { return simulation_.unplaced(); }
  uint16_t group(size_t id) const { return simulation_.info().group_of_avatar[id]; }
  const Eigen::Vector2d& position_m(size_t id) const { return positions_m_[id]; }
  /// Position seen from above; that of the root without bodies.
  const Eigen::Vector2d& head_m(size_t id) const {
    return heads_ ? heads_m_[id] : positions_m_[id];
  }
  const Eigen::Vector2d& previous_m(size_t id) const { return previous_m_[id]; }
  /// Mean velocity during the latest step.
  Eigen::Vector2d velocity_mps(size_t id) const {
    return (positions_m_[id] - previous_m_[id]) / step_s_;
  }
  /// Unit vector of the body's heading.
  const Eigen::Vector2d& heading(size_t id) const { return headings_[id]; }
  const Eigen::Vector2d& previous_heading(size_t id) const { return previous_headings_[id]; }
  const RunInfo& info() const { return simulation_.info(); }
  /// Number of moves so far that ended in a wall, crossed one or left the ground.
  int wall_crossings() const { return wall_crossings_; }
  /// Maximum overlap of two discs so far.
  double max_overlap_m() const { return max_overlap_m_; }

 private:
  void take(const Frame& frame);
  bool crosses_wall(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const;

  Simulation simulation_;
  std::vector<Rectangle> walls_;
  Rectangle ground_;
  double step_s_;
  double now_s_ = 0;
  std::optional<Heads> heads_;
  std::vector<Eigen::Vector2d> positions_m_;
  std::vector<Eigen::Vector2d> heads_m_;  ///< empty for kPositions
  std::vector<Eigen::Vector2d> previous_m_;
  std::vector<Eigen::Vector2d> headings_;
  std::vector<Eigen::Vector2d> previous_headings_;
  std::vector<uint8_t> present_;
  std::vector<uint8_t> was_present_;
  int wall_crossings_ = 0;
  double max_overlap_m_ = 0;
};

/// Line across x or y that records the first passage of each person in one direction.
class Gate {
 public:
  enum class Along { kX, kY };  ///< coordinate that changes through the gate
  Gate(Along along, double at, double low, double high, bool upwards = true)
      : axis_(along == Along::kX ? 0 : 1), at_(at), low_(low), high_(high), upwards_(upwards) {}

  void watch(const Trial& trial);

  struct Passage {
    double time_s = 0;
    size_t id = 0;
  };
  const std::vector<Passage>& passages() const { return passages_; }
  /// Times of all passages, ascending.
  std::vector<double> times_s() const;

 private:
  int axis_;
  double at_, low_, high_;
  bool upwards_;
  std::vector<Passage> passages_;
  std::vector<uint8_t> passed_;
};

/// Adds wall crossings, overlaps and unplaced people to the outcome.
void note(Outcome& outcome, const Trial& trial);

/// Persons per second from the first to the last time; 0 for fewer than two.
double flow_per_s(const std::vector<double>& times_s);

// Moments of a trial at regular times, for the measures that are also applied to recordings.

/// Due at the first instant, and then at the first step at or after each multiple of the period.
class PeriodTimer {
 public:
  explicit PeriodTimer(double period_s) : period_s_(period_s) {}

  bool is_due(double now_s) {
    constexpr double kSlack_s = 1e-9;
    if (now_s < next_s_ - kSlack_s) return false;
    next_s_ += period_s_;
    return true;
  }

 private:
  double period_s_;
  double next_s_ = 0;
};

/// Stores the current positions; `moment` must have the trial's size.
inline void take(const Trial& trial, Moment& moment) {
  moment.time_s = trial.now_s();
  for (size_t id = 0; id < trial.size(); ++id) {
    moment.roots_m[id] = trial.position_m(id);
    moment.heads_m[id] = trial.head_m(id);
    moment.present[id] = trial.is_present(id);
  }
}

}  // namespace throng::validation
