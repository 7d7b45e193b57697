// Set-ups in which people were recorded, as scenes: those of speed against density, and others.
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

// Density and speed of an area, moment by moment: one over the mean cell of its people, and their
// speed, weighted by cell.
// Measured as recordings are: Voronoi cells cut at the walls, and how far somebody gets
// in a second.

/// The cell of a person at a moment, m2 or m; 0 for none.
using CellOf = std::function<double(const Moment&, size_t)>;
CellOf voronoi_cells(const Scene& scene);

/// Of the people of an area at a moment; none without anybody.
std::optional<DensitySpeed> density_and_speed(const Moment& moment, const Velocities& velocities,
                                              const Rectangle& area, const CellOf& cell);

class AreaSpeeds {
 public:
  /// Moments are half a second apart, so that a second's displacement has one in its middle.
  static constexpr double kSample_s = 0.5;

  AreaSpeeds(const Trial& trial, CellOf cell, std::vector<Rectangle> areas);

  /// Once a step; `counts`: whether its moments become samples.
  void watch(const Trial& trial, bool counts = true);

  /// One an area and moment with somebody in it.
  const std::vector<DensitySpeed>& samples() const { return samples_; }

 private:
  CellOf cell_;
  std::vector<Rectangle> areas_;
  RecentCrowd crowd_;
  Velocities velocities_;
  PeriodTimer clock_{kSample_s};
  std::vector<DensitySpeed> samples_;
};

// Situations beside the set-ups of speed and density: doors, overtaking, ways that are wide.
// Nothing is set for one of them but its geometry, its people and, where the criterion
// names them, their free speeds.

/// A room of 6 m x 16 m, a neck of 2.8 m behind it.
Plan door_plan(double width_m, int people, SteeringKind model, uint64_t seed);
DoorFlow measure_door_flow(double width_m, int people, SteeringKind model, uint64_t seed,
                           Outcome& outcome);

/// Corridors of 3 m side by side, in each somebody with 1.5 m/s behind somebody with 0.6 m/s.
Plan overtaking_plan(int lanes, SteeringKind model, uint64_t seed);
std::vector<Overtaking> measure_overtaking(int lanes, SteeringKind model, uint64_t seed,
                                           Outcome& outcome);

/// A way 3 m wide that closes in an oval, with 2 people per m2, half of them each way.
Plan two_way_plan(SteeringKind model, uint64_t seed);
/// Flow per m and s, both ways together, minute by minute.
std::vector<double> measure_counterflow(int minutes, SteeringKind model, uint64_t seed,
                                        Outcome& outcome);

/// A ring 3 m wide around 7 m, 80 people.
Plan ring_plan(SteeringKind model, uint64_t seed);
/// A corridor 4 m wide that turns after 30 m, 200 people.
Plan corner_plan(SteeringKind model, uint64_t seed);
/// A hall of 30 m x 20 m with two exits in a long side, 600 people in the half with one of them.
Plan two_exits_plan(SteeringKind model, uint64_t seed);

// The six set-ups in which people's speed against density was recorded, as scenes.
// Geometry and free speeds are the experiments'; how people steer is what everybody gets.

/// One run of a set-up: so many people, or entrances and an exit so wide.
struct RecordedRun {
  Plan plan;
  std::vector<Rectangle> areas;    ///< measured, each for itself
  std::vector<Rectangle> waiting;  ///< measured as long as somebody stands here
  std::optional<Oval> oval;        ///< of people who go round; nobody waits
  double end_s = 0;
};

/// Runs of `single_file`, `ug`, `uo`, `eo`, `ko` or `bot`, from the emptiest to the fullest or so,
/// and where one says little all of them again with other people.
int recorded_runs(const std::string& id);
RecordedRun recorded_run(const std::string& id, int run, const Conditions& conditions);

/// What the run's areas are like, twice a second, once people have spread.
std::vector<DensitySpeed> speeds_of(const RecordedRun& run, const std::string& id,
                                    Outcome& outcome);

}  // namespace throng::validation
