// try_volume() is the workbench for a custom bounding volume: no-miss check, false positives by
// pair of parts, costs of fit, update and test, next to the project's volumes.
// examples/custom_volume.cpp is a complete example.
// Invariant: all volumes get the same pairs.
#pragma once

#include <string>
#include <vector>

#include "base/errors.h"
#include "bench/workbench/tested_volume.h"
#include "bench/workbench/volume_trials.h"

namespace throng {

struct WorkbenchOptions {
  uint64_t no_miss_pairs = 1'000'000;  ///< number of pairs of the no-miss check
  uint64_t seed = 1;
  int threads = 1;       ///< for the no-miss check; timed code uses one
  int walkers = 200;     ///< people of the false-positive counts, at 1 and 4 per m2
  int frames = 500;      ///< frames of 15 objects in a box, for Fig. 3
  std::string out = {};  ///< folder for figure_03.svg, part_pairs.csv and miss.txt (if any)
};

struct WorkbenchResult {
  std::string name;
  WorkbenchOptions options;
  std::vector<bench::NoMissResult> no_miss;
  std::vector<bench::FalsePositives> false_positives;  ///< at 1 and 4 per m2
  std::vector<bench::CostAndAccuracy> figure_3;        ///< the project's volumes, then this one

  uint64_t missed() const;
  /// Whether neither check nor crowds found a miss and the kernel, if any, agrees with its test.
  bool has_no_misses() const;
};

WorkbenchResult try_volume(const bench::TestedVolume& volume, const WorkbenchOptions& options);
std::string to_text(const WorkbenchResult& result);

/// Main program: PROGRAM [PAIRS [SEED [FOLDER]]] tries the volume and prints the results; FOLDER
/// gets the files. Exit code 0; 1 if the volume misses; 2 for invalid arguments.
int workbench_main(const bench::TestedVolume& volume, int argc, char** argv);

template <bench::TestableVolume V>
int workbench_main(const std::string& name, int argc, char** argv) {
  return workbench_main(bench::TestedVolumeOf<V>(name), argc, argv);
}

}  // namespace throng
