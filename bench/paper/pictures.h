// Pictures of the boxes: Figures 4, 5, 11 and 12.
// One rule: what collides is red, whatever else it is.
#pragma once

#include <string>
#include <vector>

#include "bench/paper/parts.h"
#include "viewer/picture/raster.h"

namespace throng::paper {

struct Picture {
  std::string id;  ///< "figure_04"
  std::string title;
  Image image;
};

/// 15 objects of Part I, then 50, 350 and 500 of Part II, a second into the run; or-DOP 26 tells
/// which collide.
std::vector<Picture> pictures_of(const std::vector<Object>& objects, uint64_t seed);

}  // namespace throng::paper
