// The workbench for a bounding volume of your own: one call runs the law of no misses over odd
// bodies and walking people, counts false positives by pair of parts, and measures fit, update and
// test, beside the volumes of the project. examples/custom_volume.cpp is all that it takes.
// One rule: every volume goes through the same door, and gets the same pairs.
#pragma once

#include <string>
#include <vector>

#include "bench/workbench/tested_volume.h"
#include "bench/workbench/volume_trials.h"

namespace throng {

struct WorkbenchOptions {
  uint64_t proximity_pairs = 1'000'000;  ///< that the law is tried on
  uint64_t seed = 1;
  int threads = 1;       ///< for the law; what is timed runs on one
  int walkers = 200;     ///< whose parts are counted for false positives, 1 and 4 per m2
  int frames = 500;      ///< of 15 objects in a box, for Fig. 3
  std::string out = {};  ///< a folder for figure_03.svg, by_part.csv and, if there is one, miss.txt
};

/// What the workbench found out about a volume.
struct WorkbenchResult {
  std::string name;
  WorkbenchOptions options;
  std::vector<bench::NoMissResult> no_miss;
  std::vector<bench::FalsePositives> false_positives;  ///< at 1 and at 4 per m2
  std::vector<bench::CostAndAccuracy> figure_3;        ///< the project's volumes, then this one

  uint64_t missed() const;
  /// By the law and by the walking crowds; and its kernel, if it has one, agrees with its test.
  bool has_no_misses() const;
};

WorkbenchResult try_volume(const bench::TestedVolume& volume, const WorkbenchOptions& options);
std::string to_text(const WorkbenchResult& result);

/// A whole program: PROGRAM [PAIRS [SEED [FOLDER]]] tries the volume, prints what was found and,
/// with a folder, fills it. Exit code 0; 1 if the volume misses; 2 for arguments that are none.
int workbench_main(const bench::TestedVolume& volume, int argc, char** argv);

template <bench::TestableVolume V>
int workbench_main(const std::string& name, int argc, char** argv) {
  return workbench_main(bench::TestedVolumeOf<V>(name), argc, argv);
}

}  // namespace throng
