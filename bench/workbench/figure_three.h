// The paper's Figure 3, measured: what a frame of 15 objects costs with a volume, against how much
// of what it finds is true.
// One rule: every volume is given the same motion, that of Part I, and the same truth.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bench/paper/parts.h"
#include "bench/workbench/tested_volume.h"

namespace throng::bench {

struct SimpleAndAccurate {
  std::string name;
  double fit_ns = 0;      ///< all objects once: C_o
  double update_ns = 0;   ///< C_u
  double test_ns = 0;     ///< C_v
  double frame_ns = 0;    ///< an update of each object, a test of each pair
  uint64_t found = 0;     ///< pairs that the volume finds
  double true_share = 0;  ///< of these, those whose triangles touch
};

/// `frames` frames of Part I under this seed, tested volume by volume.
std::vector<SimpleAndAccurate> place_in_figure_3(const std::vector<paper::Object>& objects,
                                                 VolumeList volumes, int frames, uint64_t seed);

struct LabelledPoint {
  std::string label;
  double frame_ns, true_share;
};
/// The gnuplot script of the figure. `highlighted`: the label of a point that stands out.
std::string figure_3_script(std::span<const LabelledPoint> points, const std::string& what,
                            const std::string& highlighted = {});

}  // namespace throng::bench
