// Verdicts judge measured numbers by recordings and by the criteria of the standards.
// They simulate nothing: tests show with made-up numbers that each criterion can fail.
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "analysis/validation/empirical_tables.h"
#include "analysis/validation/validation.h"

namespace throng::validation {

struct Judgement {
  bool passed = false;
  bool differs = false;  ///< as in Outcome
  std::string summary;
  std::vector<Reading> readings;
};
/// Adds a verdict to the outcome of a test.
Outcome judged(Outcome outcome, Judgement judgement);

/// Flow through a door, and people who came through of all people.
struct DoorFlow {
  double width_m = 0;
  double flow_per_s = 0;
  int through = 0;
  int people = 0;
};
/// Judges doors in ascending order of width. Passes if each flow is within 15 % of the experiments'
/// mean, none falls from a width to the next, and all people come through.
Judgement judge_doors(std::span<const DoorFlow> flows);

/// Sample of an area at a moment.
struct DensitySpeed {
  double density = 0;  ///< per m2, or per m of a single file
  double speed_mps = 0;
};
/// Minimum number of samples for a bin to count.
inline constexpr size_t kMinSamples = 20;
/// Judges bins of the recording with enough simulated samples. Passes if their means are on average
/// at most 15 % of the desired speed off and 70 % of them lie between the recorded 10 and 90 %
/// quantiles. At least half of the recording's bins must be reached.
Judgement judge_speeds(const RecordedCurve& curve, std::span<const DensitySpeed> samples);

/// `lanes`: time of people in each lane, in any unit. Passes if no share is above `max_share`.
Judgement judge_fullest_lane(std::span<const double> lanes, double max_share);
/// Passes if at least `min_lanes` lanes have a share of at least `min_share`.
Judgement judge_used_lanes(std::span<const double> lanes, int min_lanes, double min_share);

/// A fast person behind a slow one.
struct Overtaking {
  bool passed = false;
  double lost_share = 0;  ///< lost time over the time without the slow person
};
/// Passes if 95 % overtake and lose at most 10 % of their time.
Judgement judge_overtaking(std::span<const Overtaking> starts);

/// `crowds_per_m_s`: flow of both directions together, by crowd and minute. Passes if the mean is
/// at least 1.0 and no minute is below 0.1.
Judgement judge_counterflow(std::span<const std::vector<double>> crowds_per_m_s);

/// Positions in a corridor along x with two streams, collected over moments.
struct CounterflowUse {
  static constexpr double kAtWall_m = 0.4, kCentral_m = 1, kAbreast_m = 0.5;

  double width_m = 0;
  std::vector<double> from_right_wall_m;
  /// Squared difference between the shares of same and opposite direction, among people within
  /// kAbreast_m to either side.
  std::vector<double> lane_orders;
  std::vector<DensitySpeed> speeds;

  void add(CounterflowUse more);
};
/// Passes if the share of time within kAtWall_m of a wall is at most twice the recorded one, that
/// in the central metre at least 0.75 times the recorded one, lane order at most 0.9, and speeds
/// are within 10 % at each density with enough samples of both.
Judgement judge_counterflow_use(const CounterflowUse& simulated, const CounterflowUse& recorded);

/// `near`, `far`: numbers of people by exit. Passes if at least a third take the far one and all
/// leave.
Judgement judge_far_exit(int near, int far, int people);

// Judgements of the standards: speed by density, and jams before openings.

/// Mean density and speed of one-way traffic in a corridor.
struct UnidirectionalSpeed {
  double target_per_m2 = 0;
  double density_per_m2 = 0;
  double speed_mps = 0;
};
/// Maximum density judged by RiMEA 4; higher ones are only reported.
inline constexpr double kMaxJudged_per_m2 = 3;
/// Passes if each speed is between the slowest and the fastest recorded tenth at its density (see
/// recorded_one_way_at()); densities without recordings are not met. The summary includes
/// marginal_readings().
Judgement judge_unidirectional(std::span<const UnidirectionalSpeed> points);

/// Lists judged readings that are outside of their bounds or within 10 % of one, with that bound:
/// "0.46 m/s at 2 per m2 (at least 0.43)". Empty if there are none.
std::string marginal_readings(std::span<const Reading> readings);

/// Crowding in the 2 m x 2 m before an opening, as means over 10 s.
struct Crowding {
  double max_per_m2 = 0;
  double queued = 0;  ///< share of the time with more than kQueue_per_m2
  double jammed = 0;  ///< share of the time with more than kJam_per_m2
};
/// Density of Weidmann's maximum flow (Weidmann 1993): at higher densities more people arrive than
/// leave.
inline constexpr double kQueue_per_m2 = 1.75;
/// Congestion in simulations by IMO MSC.1/Circ.1533, annex 3, paragraph 3: a higher density than
/// this, significant if it lasts for more than this share of the time.
inline constexpr double kJam_per_m2 = 4;
inline constexpr double kJamLasts = 0.1;

/// Passage of people through a neck into a second room and out of its exit.
struct NeckPassage {
  double width_m = 0;
  double flow_per_s = 0;  ///< flow into the neck
  bool all_through = false;
  Crowding before_neck;
  Crowding before_exit;
};
/// Judges necks in ascending order of width; crowding is judged for the neck as wide as the exit.
/// Fails if the flow does not grow with the width, if people are left behind, without a jam before
/// the neck, or with a jam before the exit. Differs if people only queue before the exit: RiMEA 12
/// expects no congestion there, but excludes no model for it without measurements.
Judgement judge_necks(std::span<const NeckPassage> necks, double exit_m);

}  // namespace throng::validation
