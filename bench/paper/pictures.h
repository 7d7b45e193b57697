// The paper's pictures, drawn with the volumes that are tested: Figures 1, 2, 4, 5, 11 and 12.
// One rule: what collides is red, whatever else it is; a picture shows what the paper's shows.
#pragma once

#include <string>
#include <vector>

#include "bench/paper/parts.h"
#include "viewer/picture/raster.h"

namespace throng::paper {

struct Picture {
  std::string id;  ///< "figure_04", "figure_05a"
  std::string title;
  std::string caption;  ///< what the paper's figure shows
  Image image;
};

/// A second into the runs; or-DOP 26 tells which collide.
std::vector<Picture> pictures_of(const std::vector<Object>& objects, uint64_t seed);

}  // namespace throng::paper
