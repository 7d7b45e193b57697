// check_no_misses(), count_false_positives() and measure_figure_3() try bounding volumes.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/workers.h"
#include "bench/crowd.h"
#include "bench/paper/parts.h"
#include "bench/workbench/tested_volume.h"

namespace throng::bench {

// The no-miss check: millions of near pairs of parts, difficult bodies of every family and walking
// people, compared with triangles. The pairs are equal for any number of threads.

/// A touching pair that a volume reports as apart, with all data to reproduce it.
struct Miss {
  std::string where;  ///< family, seed, frame, bodies and parts
  PartShape shape_a, shape_b;
  PartPlace a, b;
  PlacedPair test;
};

struct NoMissResult {
  std::string family;
  uint64_t tested = 0;     ///< number of tested pairs
  uint64_t touching = 0;   ///< triangles touch, or one part lies inside the other
  uint64_t reported = 0;   ///< the volume may overlap
  uint64_t missed = 0;     ///< touching and not reported
  uint64_t differing = 0;  ///< pairs for which the kernel differs from the scalar test
  std::optional<Miss> first_miss{};

  void add(const NoMissResult& other);
};

/// Returns a row per family, "walking" last, with at least `no_miss_pairs` pairs together.
std::vector<NoMissResult> check_no_misses(const TestedVolume& volume, uint64_t no_miss_pairs,
                                          uint64_t seed, Workers& workers);

/// Formats shapes, poses and shift of a miss as text for other programs.
std::string to_text(const Miss& miss);

// False positives: pairs of parts reported per touching pair. The oracle tests triangles of all
// parts of all avatars whose spheres overlap, with no other volume in between.

using Progress = std::function<void(const std::string&)>;

/// A volume alone, or "pipeline": all stages of a Culler before or-DOP 26.
struct VolumeReport {
  std::string name;
  uint64_t reported = 0;
  uint64_t missed = 0;  ///< touching pairs that were not reported; must be 0
};

struct PartCell {
  uint64_t tests = 0, passed = 0, touching = 0;
};

struct FalsePositives {
  std::vector<VolumeReport> volumes;
  uint64_t avatar_pairs = 0, tests = 0, touching = 0;
  std::vector<std::string> parts;
  /// parts x parts, unordered pairs in the upper triangle; for `matrix_volume`.
  std::vector<PartCell> matrix;
  std::string matrix_volume;

  const PartCell& cell(size_t a, size_t b) const { return matrix[a * parts.size() + b]; }
};

struct CensusOptions {
  int frames = 4;  ///< one per `stride` steps
  int stride = 20;
  std::string matrix_volume = "ordop26";
};

/// Counts false positives of a walking crowd.
FalsePositives count_false_positives(Crowd& crowd, VolumeList volumes, const CensusOptions& options,
                                     const Progress& progress);

/// A point of the paper's Figure 3: cost of a frame of 15 objects, and accuracy.
/// Every volume gets the motion of Part I and the same oracle.
struct CostAndAccuracy {
  std::string name;
  double fit_ns = 0;      ///< fitting all objects once: C_o
  double update_ns = 0;   ///< C_u
  double test_ns = 0;     ///< C_v
  double frame_ns = 0;    ///< an update per object, a test per pair
  uint64_t found = 0;     ///< number of pairs that the volume finds
  double true_share = 0;  ///< fraction of found pairs whose triangles touch
};

/// Measures `frames` frames of Part I with this seed, volume by volume.
std::vector<CostAndAccuracy> measure_figure_3(const std::vector<paper::Object>& objects,
                                              VolumeList volumes, int frames, uint64_t seed);

struct LabelledPoint {
  std::string label;
  double frame_ns, true_share;
};
/// Returns the gnuplot script of the figure. `highlighted`: label of the highlighted point.
std::string figure_3_script(std::span<const LabelledPoint> points, const std::string& what,
                            const std::string& highlighted = {});

}  // namespace throng::bench
