// recorded_setups builds the setups of recorded experiments as scenes, and measures them.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "analysis/measures/speed_and_spacing.h"
#include "analysis/validation/setups.h"
#include "analysis/validation/trial.h"
#include "analysis/validation/verdicts.h"

namespace throng::validation {

// Density and speed of an area at a moment, measured as in recordings: 1 over the mean area of the
// Voronoi cells, cut at walls; and displacements over 1 s, weighted by cell.

/// Returns the cell of a person at a moment in m2 or m; 0 for none.
using CellOf = std::function<double(const Moment&, size_t)>;
CellOf voronoi_cells(const Scene& scene);

/// Density and speed of the people in an area; none without people.
std::optional<DensitySpeed> density_and_speed(const Moment& moment, const Velocities& velocities,
                                              const Rectangle& area, const CellOf& cell);

class AreaSpeeds {
 public:
  /// Half a second: the displacement over 1 s is centred on the middle moment.
  static constexpr double kSample_s = 0.5;

  AreaSpeeds(const Trial& trial, CellOf cell, std::vector<Rectangle> areas);

  /// Call once per step; `counts`: whether its moments become samples.
  void watch(const Trial& trial, bool counts = true);

  /// One sample per moment and area with people.
  const std::vector<DensitySpeed>& samples() const { return samples_; }

 private:
  CellOf cell_;
  std::vector<Rectangle> areas_;
  RecentCrowd crowd_;
  Velocities velocities_;
  PeriodTimer clock_{kSample_s};
  std::vector<DensitySpeed> samples_;
};

// Further situations: doors, overtaking, wide paths. Only geometry, people and, if the criterion
// names them, desired speeds are set.

/// A room of 6 m x 16 m and a neck of 2.8 m behind it.
Plan door_plan(double width_m, int people, SteeringKind model, uint64_t seed);
DoorFlow measure_door_flow(double width_m, int people, SteeringKind model, uint64_t seed,
                           Outcome& outcome);

/// Corridors of 3 m, each with a person of 1.5 m/s behind a person of 0.6 m/s.
Plan overtaking_plan(int lanes, SteeringKind model, uint64_t seed);
std::vector<Overtaking> measure_overtaking(int lanes, SteeringKind model, uint64_t seed,
                                           Outcome& outcome);

/// A corridor 3 m wide that closes in an oval, with 2 people per m2, half of them in each
/// direction.
Plan two_way_plan(SteeringKind model, uint64_t seed);
/// Flow per m and s, both directions together, by minute.
std::vector<double> measure_counterflow(int minutes, SteeringKind model, uint64_t seed,
                                        Outcome& outcome);

/// A ring 3 m wide around a radius of 7 m, with 80 people.
Plan ring_plan(SteeringKind model, uint64_t seed);
/// A corridor 4 m wide that turns after 30 m, with 200 people.
Plan corner_plan(SteeringKind model, uint64_t seed);
/// A hall of 30 m x 20 m with two exits in a long side, 600 people in the half with one of them.
Plan two_exits_plan(SteeringKind model, uint64_t seed);

// The six setups of recorded speed against density. Geometry and desired speeds are the
// experiments', steering parameters the defaults.

/// One run of a setup, with a number of people or widths of entrances and exit.
struct RecordedRun {
  Plan plan;
  std::vector<Rectangle> areas;    ///< areas that are measured separately
  std::vector<Rectangle> waiting;  ///< measured while people stand here
  std::optional<Oval> oval;        ///< set if people walk in a loop; then no people wait
  double end_s = 0;
};

/// Number of runs of `single_file`, `ug`, `uo`, `eo`, `ko` or `bot`: approximately from the
/// emptiest to the fullest, repeated with other seeds if single runs yield few samples.
int recorded_runs(const std::string& id);
RecordedRun recorded_run(const std::string& id, int run, const Conditions& conditions);

/// Samples of the run's areas, twice per second, after people have spread.
std::vector<DensitySpeed> speeds_of(const RecordedRun& run, const std::string& id,
                                    Outcome& outcome);

}  // namespace throng::validation
