// How far a pair was refined before it was reported: everything is decided without a deadline.
// One rule: a pair that touches is reported at some level, whatever the deadline.
#pragma once

#include <cstddef>
#include <cstdint>

namespace throng {

/// What said last that the two may touch. Without a deadline every pair gets to the last stage
/// there is.
enum class PairLevel : uint8_t {
  kSphere = 0,      ///< the spheres of the two bodies
  kBox = 1,         ///< boxes: of the bodies in their poses, or of the parts
  kPartVolume = 2,  ///< the part volume
  kExact = 3        ///< triangles
};
inline constexpr size_t kPairLevels = 4;

/// The part index, on both sides, of a pair of bodies that was not refined to parts.
inline constexpr uint32_t kWholeBody = 255;

}  // namespace throng
