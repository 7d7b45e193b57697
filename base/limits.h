// Limits on scenes, models and messages, shared by writers and readers.
// Invariant: every scene that loads can be written to a log, and every written log can be read.
#pragma once

#include <cstddef>
#include <cstdint>

namespace throng {

/// Bytes of a name (scene, group, obstacle, robot, link, joint), see defect_of_name().
inline constexpr size_t kMaxNameBytes = 120;

/// The largest humanoids with hands have about 200 links.
inline constexpr int kMaxLinks = 2048;
/// KDL recurses along a chain and overflows the stack at about 10^4 links; snakes have about 100.
inline constexpr int kMaxChainDepth = 256;
/// Parts have 8-bit indices, and one value means the whole body.
inline constexpr int kMaxModelParts = 255;

/// Groups and models have signed 16-bit indices. Kinds of bodies have unsigned ones, of which
/// obstacles take 60 000.
inline constexpr int64_t kMaxGroups = 32'767;
inline constexpr int64_t kMaxModels = 5'000;

/// Metres and radians in a description: vertices, joint origins, limits. Also rejects infinity, NaN
/// and models scaled by 1000 too often.
inline constexpr double kMaxDescribed = 1e6;
/// An avatar's height over its model's: rejects a model with wrong length units.
inline constexpr float kMaxScale = 1e3f;
/// Distance of the ground from the origin: double positions keep 0.1 micrometres.
inline constexpr double kMaxCoordinate_m = 1e5;
/// Distance of parts from the root of their body: beyond, a float does not resolve millimetres.
inline constexpr double kMaxReach_m = 1e4;
/// Edge of a box of parts, in metres: float poses are relative to its centre.
inline constexpr double kMaxEdge_m = 1e3;

/// Chunks of a long message: part poses of 100 000 avatars take 500.
inline constexpr int32_t kMaxChunks = 100'000;

}  // namespace throng
