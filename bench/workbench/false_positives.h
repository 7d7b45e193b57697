// How many pairs of parts each volume reports for one that truly touches.
// One rule: the truth is exact triangles, over all parts of all avatars whose spheres overlap, with
// no other volume in between.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "bench/crowd.h"
#include "bench/workbench/tested_volume.h"

namespace throng::bench {

using Progress = std::function<void(const std::string&)>;

/// A volume alone, or "pipeline": all that a Culler does before or-DOP 26.
struct VolumeReport {
  std::string name;  ///< the volume's
  uint64_t reported = 0;
  uint64_t missed = 0;  ///< true pairs that it did not report; any is an error
};

struct PartCell {
  uint64_t tests = 0, passed = 0, touching = 0;
};

struct FalsePositives {
  std::vector<VolumeReport> volumes;
  uint64_t avatar_pairs = 0, tests = 0, touching = 0;
  std::vector<std::string> parts;  ///< names
  /// parts x parts, symmetric pairs counted once, in the upper triangle; for `matrix_volume`.
  std::vector<PartCell> matrix;
  std::string matrix_volume;

  const PartCell& cell(size_t a, size_t b) const { return matrix[a * parts.size() + b]; }
};

struct CensusOptions {
  int frames = 4;  ///< one every `stride` steps
  int stride = 20;
  std::string matrix_volume = "ordop26";
};

/// Of a crowd that walks on.
FalsePositives count_false_positives(Crowd& crowd, VolumeList volumes, const CensusOptions& options,
                                     const Progress& progress);

}  // namespace throng::bench
