// One run of a test's scene, watched: where everybody is, who passed which line when.
// It only looks; walls are checked here with its own arithmetic, for every move of everybody.
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

/// One run of a test's scene, watched: where everybody is, who passed which line when.
/// It only looks; walls are checked here with its own arithmetic, for every move of
/// everybody.
class Trial {
 public:
  /// With bodies, everybody has a head; without, which is faster, only a place.
  enum class Detail { kPositions, kBodies };
  explicit Trial(const Plan& plan, Detail detail = Detail::kPositions);

  /// Advances by a step; false once the time is over or everybody has come and left.
  bool step(double until_s);

  double now_s() const { return now_s_; }
  double step_s() const { return step_s_; }
  size_t size() const { return positions_m_.size(); }
  bool is_present(size_t id) const { return present_[id] != 0; }
  size_t present() const;
  int unplaced() const { return simulation_.unplaced(); }
  uint16_t group(size_t id) const { return simulation_.info().group_of_avatar[id]; }
  const Eigen::Vector2d& position_m(size_t id) const { return positions_m_[id]; }
  /// Seen from above; without bodies the same as the place.
  const Eigen::Vector2d& head_m(size_t id) const {
    return heads_ ? heads_m_[id] : positions_m_[id];
  }
  /// A step earlier.
  const Eigen::Vector2d& previous_m(size_t id) const { return previous_m_[id]; }
  /// Of the latest step.
  Eigen::Vector2d velocity_mps(size_t id) const {
    return (positions_m_[id] - previous_m_[id]) / step_s_;
  }
  /// The way that somebody's body faces; unit.
  const Eigen::Vector2d& heading(size_t id) const { return headings_[id]; }
  const Eigen::Vector2d& previous_heading(size_t id) const { return previous_headings_[id]; }
  const RunInfo& info() const { return simulation_.info(); }
  /// Moves so far that ended in a wall, went through one or left the ground.
  int wall_crossings() const { return wall_crossings_; }
  /// Of two discs, so far.
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
  std::vector<Eigen::Vector2d> heads_m_;  ///< empty without bodies
  std::vector<Eigen::Vector2d> previous_m_;
  std::vector<Eigen::Vector2d> headings_;
  std::vector<Eigen::Vector2d> previous_headings_;
  std::vector<uint8_t> present_;
  std::vector<uint8_t> was_present_;
  int wall_crossings_ = 0;
  double max_overlap_m_ = 0;
};

/// A line across x or y, and who passed it upwards (or downwards) when, each person once.
class Gate {
 public:
  enum class Along { kX, kY };  ///< the coordinate that grows through the gate
  Gate(Along along, double at, double low, double high, bool upwards = true)
      : axis_(along == Along::kX ? 0 : 1), at_(at), low_(low), high_(high), upwards_(upwards) {}

  void watch(const Trial& trial);

  struct Passage {
    double time_s = 0;
    size_t id = 0;
  };
  const std::vector<Passage>& passages() const { return passages_; }
  /// Times in order, of everybody or of a group.
  std::vector<double> times_s() const;

 private:
  int axis_;
  double at_, low_, high_;
  bool upwards_;
  std::vector<Passage> passages_;
  std::vector<uint8_t> passed_;
};

/// Adds to the outcome what every test watches: walls, overlaps, people who found no room.
void note(Outcome& outcome, const Trial& trial);

/// Persons per second from the first to the last of the times; 0 for fewer than two.
double flow_per_s(const std::vector<double>& times_s);

// Moments of a trial at even times, for the measures that recordings are measured by.
// Heads are where bodies have them; in a trial without bodies, where the roots are.

/// True at the first instant, and then at the first step at or after each multiple of a period.
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

/// Where everybody is now; `moment` has room for them.
inline void take(const Trial& trial, Moment& moment) {
  moment.time_s = trial.now_s();
  for (size_t id = 0; id < trial.size(); ++id) {
    moment.roots_m[id] = trial.position_m(id);
    moment.heads_m[id] = trial.head_m(id);
    moment.present[id] = trial.is_present(id);
  }
}

}  // namespace throng::validation
