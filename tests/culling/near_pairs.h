// Part pairs by the million, held against triangles in double precision: whatever touches must be
// reported by the whole culling pass.
// One rule: only near pairs count, those whose axis-aligned boxes, widened by a centimetre,
// overlap; of the others the boxes prove that they are apart.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace throng::test {

enum class Family {
  kBlobs,     ///< bumpy ellipsoids and boxes
  kAdult,     ///< the parts of the bundled adult
  kFlat,      ///< plates without thickness, tilted and axis-parallel
  kNeedle,    ///< a metre long, some micrometres thick
  kPoint,     ///< all corners in one place, and segments
  kNested,    ///< small parts inside large closed ones
  kFar,       ///< blobs and plates at 10 km and 100 km from the world's origin
  kTouching,  ///< boxes and plates that share a corner, an edge or a face, to the rounding
  kMixed      ///< solids and loose triangles in one part; triangles decide, each piece by itself
};
inline constexpr Family kFamilies[] = {Family::kBlobs,  Family::kAdult,    Family::kFlat,
                                       Family::kNeedle, Family::kPoint,    Family::kNested,
                                       Family::kFar,    Family::kTouching, Family::kMixed};
std::string_view name_of(Family family);

struct NearPairs {
  uint64_t near = 0;
  uint64_t touching = 0;   ///< by their triangles, or one inside the other
  uint64_t reported = 0;   ///< of the near ones
  uint64_t missed = 0;     ///< touching and not reported
  uint64_t differing = 0;  ///< frames in which the scalar reference reports other pairs
  std::string first_miss, first_difference;
};

/// At least `pairs` near pairs, in whole rounds over all part volumes and SIMD targets of this
/// machine, pair searches in turn.
NearPairs check_near_pairs(Family family, uint64_t pairs, uint64_t seed);

}  // namespace throng::test
