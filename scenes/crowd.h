// People who walk: ORCA ten times a second, smooth motion at every step in between.
// One rule: each pass reads the old state and writes the new, so that the same crowd walks the same
// way for any number of threads.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "base/workers.h"
#include "scenes/journeys.h"
#include "scenes/neighbour_grid.h"
#include "scenes/orca.h"
#include "scenes/spawn.h"
#include "scenes/traffic.h"
#include "scenes/ways.h"

namespace throng {

struct CrowdOptions {
  uint64_t seed = 1;
  double step_s = 1.0 / 60.0;
};

/// What steering went through in its latest decision.
struct SteeringCounters {
  uint64_t decisions = 0;        ///< so far, of all people together
  int sweeps = 0;                ///< of disc relaxation
  double deepest_overlap_m = 0;  ///< of two discs, where people stand now
  double longest_stall_s = 0;    ///< how long the most stuck walker has not moved kStall_m, the
                                 ///< time of queuing taken off
  uint64_t queuing = 0;          ///< people held up by others ahead who go the same way
};

class Crowd {
 public:
  /// Keeps references to `ways` and `workers`.
  Crowd(const Ways& ways, std::span<const Person> people, const CrowdOptions& options,
        Workers& workers);

  /// Advances by step_s. Allocates nothing.
  void step();

  /// Everybody there may ever be; who is in the scene now says present().
  size_t size() const { return positions_m_.size(); }
  const Journeys& journeys() const { return journeys_; }
  const Traffic& traffic() const { return traffic_; }
  std::span<const Eigen::Vector2d> positions_m() const { return positions_m_; }
  /// Unit vectors: the way the body faces.
  std::span<const Eigen::Vector2d> headings() const { return headings_; }
  std::span<const Eigen::Vector2d> velocities_mps() const { return velocities_mps_; }
  /// The way of the latest step.
  std::span<const double> walked_m() const { return walked_m_; }
  const SteeringCounters& counters() const { return counters_; }

  static constexpr size_t kMaxNeighbours = 10;
  /// Whoever has moved less than this is making no progress.
  static constexpr double kStall_m = 0.3;

 private:
  struct Plan;  // the planes of one person's decision

  template <typename Body>
  void for_people(const Body& body);  // body(id), in blocks, neighbours in space together
  template <typename Body>
  double largest(const Body& body);  // of body(id) over all people

  void decide();
  void decide_for(uint32_t id);
  void change_people();
  void start_walking(uint32_t id, const Eigen::Vector2d& heading);
  bool is_queuing(uint32_t id) const;
  Eigen::Vector2d wanted_mps(uint32_t id);
  void add_walls(uint32_t id, Plan& plan);
  void add_people(uint32_t id, Plan& plan) const;
  void relax_discs();
  double relax_disc(uint32_t id);
  void move(uint32_t id);
  void turn(uint32_t id);
  double stalled_s_of(uint32_t id) const;
  void measure();

  const Ways& ways_;
  Workers& workers_;
  CrowdOptions options_;
  int steps_a_decision_ = 6;
  double period_s_ = 0.1;
  double turn_cos_ = 1;  ///< the largest turn in a step
  double turn_sin_ = 0;
  int64_t steps_ = 0;

  // What never changes, by person.
  std::vector<double> radii_m_;
  std::vector<double> free_speeds_mps_;

  // What moves, by person.
  std::vector<Eigen::Vector2d> positions_m_;
  std::vector<Eigen::Vector2d> velocities_mps_;
  std::vector<Eigen::Vector2d> headings_;
  std::vector<Eigen::Vector2d> smooth_velocities_mps_;  ///< what the heading follows
  std::vector<double> walked_m_;

  // Decisions, by person: the velocity goes from old to next within a period.
  std::vector<Eigen::Vector2d> old_velocities_mps_;
  std::vector<Eigen::Vector2d> next_velocities_mps_;
  std::vector<Eigen::Vector2d> drifts_mps_;   ///< what disc relaxation adds
  std::vector<Eigen::Vector2d> intents_mps_;  ///< the wanted velocity, smoothed
  std::vector<double> clearances_m_;

  Journeys journeys_;
  Traffic traffic_;

  // Stalls, by person.
  std::vector<Eigen::Vector2d> anchors_m_;
  std::vector<int64_t> anchor_steps_;
  std::vector<int64_t> queued_steps_;  ///< since the anchor
  std::vector<uint8_t> queuing_;

  NeighbourGrid grid_;
  std::vector<Neighbour> neighbours_;  ///< kMaxNeighbours a person
  std::vector<uint32_t> neighbour_counts_;
  std::vector<Eigen::Vector2d> expected_m_;  ///< where people will stand after the period
  std::vector<Eigen::Vector2d> relaxed_m_;
  std::vector<double> block_values_;  ///< one a block, reduced in order
  SteeringCounters counters_;
};

}  // namespace throng
