// Verdicts on what a crowd did beside what recorded people did, and by the standards' criteria.
// Numbers go in, readings and a verdict come out; nothing is simulated here, so that made-up
// numbers can show that each criterion fails where it should.
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "analysis/validation/empirical_tables.h"
#include "analysis/validation/validation.h"

namespace throng::validation {

/// Verdicts on what a crowd did beside what recorded people did.
/// Numbers in, readings and a verdict out; nothing is simulated here, so that made-up
/// numbers can show that each criterion fails where it should.
struct Judgement {
  bool passed = false;
  bool differs = false;  ///< as in Outcome
  std::string summary;
  std::vector<Reading> readings;
};
/// The outcome of a test with its verdict.
Outcome judged(Outcome outcome, Judgement judgement);

/// Of a door: people who came through, of so many, and how many a second.
struct DoorFlow {
  double width_m = 0;
  double flow_per_s = 0;
  int through = 0;
  int people = 0;
};
/// Each within 15 % of the experiments' mean at its width, never less through a wider one,
/// everybody through in the end. In ascending order of widths; each in the table.
Judgement judge_doors(std::span<const DoorFlow> flows);

/// What an area is like at a moment.
struct DensitySpeed {
  double density = 0;  ///< per m2, or per m of a single file
  double speed_mps = 0;
};
/// Fewer say nothing about a bin.
inline constexpr size_t kMinSamples = 20;
/// Bins of the recording with enough of our samples count: their means are on average at most 15 %
/// of the free speed off, 70 % of them lie between the 10 and 90 % of the recording. At least half
/// of the recording's bins must be there: a crowd that never gets dense has shown nothing.
Judgement judge_speeds(const RecordedCurve& curve, std::span<const DensitySpeed> samples);

/// Time that people spent in each lane, in any unit: at most a share in the fullest.
Judgement judge_fullest_lane(std::span<const double> lanes, double max_share);
/// ... at least so many lanes with at least a share each.
Judgement judge_used_lanes(std::span<const double> lanes, int min_lanes, double min_share);

/// Somebody fast behind somebody slow.
struct Overtaking {
  bool passed = false;
  double lost_share = 0;  ///< of the time that the way takes alone
};
/// 95 % pass and lose at most 10 %.
Judgement judge_overtaking(std::span<const Overtaking> starts);

/// Flow both ways together, people per m and s, of crowds of their own, minute by minute: at least
/// 1.0 on average and in none of them ever below a tenth of that.
Judgement judge_counterflow(std::span<const std::vector<double>> crowds_per_m_s);

/// Where people of two streams walk in a corridor along x, moment by moment.
struct CounterflowUse {
  static constexpr double kAtWall_m = 0.4, kCentral_m = 1, kAbreast_m = 0.5;

  double width_m = 0;
  std::vector<double> from_right_wall_m;
  /// Of those within kAbreast_m to either side: the square of the share that goes the same way less
  /// the share that comes.
  std::vector<double> lane_orders;
  std::vector<DensitySpeed> speeds;

  void add(CounterflowUse more);
};
/// Within kAtWall_m of a wall at most twice the recorded share of the time, in the central metre at
/// least three quarters of it, lane order at most 0.9, speeds within 10 % of the recorded at each
/// density with enough samples of both.
Judgement judge_counterflow_use(const CounterflowUse& simulated, const CounterflowUse& recorded);

/// Of so many people, those by the far exit: at least a third, and nobody left behind.
Judgement judge_far_exit(int near, int far, int people);

// Judgements of the standards' tests that need more than a glance at a number: speed by density and
// jams before openings. As in judging.h numbers go in, readings and a verdict come out.

/// Mean density and speed of people in a corridor who walk one way.
struct UnidirectionalSpeed {
  double target_per_m2 = 0;
  double density_per_m2 = 0;
  double speed_mps = 0;
};
/// Greatest density that RiMEA 4 is judged at; denser ones are readings alone.
inline constexpr double kMaxJudged_per_m2 = 3;
/// Each between the slowest and the fastest tenth recorded at its density (recorded_one_way_at());
/// a density at which nobody was recorded is not met. The summary names what marginal_readings()
/// finds.
Judgement judge_unidirectional(std::span<const UnidirectionalSpeed> points);

/// Names every judged reading that is outside its bounds, or within 10 % of a bound, with that
/// bound: "0.46 m/s at 2 per m2 (at least 0.43)". Empty if there is none.
std::string marginal_readings(std::span<const Reading> readings);

/// People in the 2 m x 2 m before an opening, as means over 10 s.
struct Crowding {
  double max_per_m2 = 0;
  double queued = 0;  ///< share of the time with more than kQueue_per_m2
  double jammed = 0;  ///< share of the time with more than kJam_per_m2
};
/// Weidmann's flow is greatest at this density (Weidmann 1993): where people are denser, more
/// arrive than get on.
inline constexpr double kQueue_per_m2 = 1.75;
/// Congestion as IMO MSC.1/Circ.1533 (annex 3, paragraph 3) defines it for simulations: more people
/// than this, and significant if it lasts for more than this share of the time.
inline constexpr double kJam_per_m2 = 4;
inline constexpr double kJamLasts = 0.1;

/// People who pass a neck from one room into another and leave that by an exit.
struct NeckPassage {
  double width_m = 0;
  double flow_per_s = 0;  ///< into the neck
  bool all_through = false;
  Crowding before_neck;
  Crowding before_exit;
};
/// By ascending width; the neck as wide as the exit is judged by where people crowd. Fails if a
/// wider neck does not carry more, if anybody is left behind, if there is no jam before the neck or
/// if there is one before the exit. Differs if people only queue before the exit: RiMEA 12 expects
/// no congestion there, but excludes no model for it as long as nobody has measured whether one
/// arises.
Judgement judge_necks(std::span<const NeckPassage> necks, double exit_m);

}  // namespace throng::validation
