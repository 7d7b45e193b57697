// Trials of one volume: the law of no misses, its false positives, its place in Figure 3.
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

// The law of no misses for one volume: near pairs of parts by the million, odd bodies of every
// family and people who walk, held against triangles.
// The same pairs for any number of threads; the first miss is handed out whole.

/// A pair that touches and that a volume says is apart: all that a debugger needs to see why.
struct Miss {
  std::string where;  ///< family, seed, frame, bodies and parts
  PartShape shape_a, shape_b;
  PartPlace a, b;
  PlacedPair test;
};

struct NoMissResult {
  std::string family;
  uint64_t tested = 0;     ///< pairs tested
  uint64_t touching = 0;   ///< by their triangles, or one inside the other
  uint64_t reported = 0;   ///< that the volume says may overlap
  uint64_t missed = 0;     ///< touching and not reported
  uint64_t differing = 0;  ///< of which the kernel says something else than the test one by one
  std::optional<Miss> first_miss{};

  void add(const NoMissResult& other);
};

/// A row a family, "walking" the last; at least `proximity_pairs` of them together.
std::vector<NoMissResult> check_no_misses(const TestedVolume& volume, uint64_t proximity_pairs,
                                          uint64_t seed, Workers& workers);

/// The shapes, poses and shift of a miss, as text that another program can read.
std::string to_text(const Miss& miss);

// How many pairs of parts each volume reports for one that truly touches.
// The truth is exact triangles, over all parts of all avatars whose spheres overlap, with
// no other volume in between.

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

/// The paper's Figure 3, measured: what a frame of 15 objects costs with a volume, against how much
/// of what it finds is true.
/// Every volume is given the same motion, that of Part I, and the same truth.
struct CostAndAccuracy {
  std::string name;
  double fit_ns = 0;      ///< all objects once: C_o
  double update_ns = 0;   ///< C_u
  double test_ns = 0;     ///< C_v
  double frame_ns = 0;    ///< an update of each object, a test of each pair
  uint64_t found = 0;     ///< pairs that the volume finds
  double true_share = 0;  ///< of these, those whose triangles touch
};

/// `frames` frames of Part I under this seed, tested volume by volume.
std::vector<CostAndAccuracy> measure_figure_3(const std::vector<paper::Object>& objects,
                                              VolumeList volumes, int frames, uint64_t seed);

struct LabelledPoint {
  std::string label;
  double frame_ns, true_share;
};
/// The gnuplot script of the figure. `highlighted`: the label of a point that stands out.
std::string figure_3_script(std::span<const LabelledPoint> points, const std::string& what,
                            const std::string& highlighted = {});

}  // namespace throng::bench
