// How much a description of a run may hold: what readers of files and messages believe.
// One rule: whoever writes, loads or reads takes its limits from here, so that whatever loads can
// be written, and whatever is written can be read.
#pragma once

#include <cstddef>
#include <cstdint>

namespace throng {

/// Names of scenes, groups, obstacles, robots, links and joints, see defect_of_name(): they travel
/// in messages and stand in tables.
inline constexpr size_t kMaxNameBytes = 120;

/// The largest humanoids with hands have some 200 links.
inline constexpr int kMaxLinks = 2048;
/// KDL recurses along a chain and overflows the stack at some 10^4 links; snakes have about 100.
inline constexpr int kMaxChainDepth = 256;
/// A pair's parts are numbered in 8 bits, and one number means the whole body.
inline constexpr int kMaxModelParts = 255;

/// Groups and models are named by 16 bits with a sign. Kinds of bodies are 16 bits without, of
/// which obstacles take 60 000.
inline constexpr int64_t kMaxGroups = 32'767;
inline constexpr int64_t kMaxModels = 5'000;

/// Metres and radians in a description: vertices, places of joints, limits. Also keeps out infinity
/// and NaN, and a model that was scaled by 1000 too often.
inline constexpr double kMaxDescribed = 1e6;
/// An avatar's height over its model's, which so cannot be in millimetres of metres twice.
inline constexpr float kMaxScale = 1e3f;
/// Of the ground of a scene, from the origin: positions keep a tenth of a micrometre in double, and
/// no city is larger.
inline constexpr double kMaxCoordinate_m = 1e5;
/// Of the parts of a body, from its root: beyond, a float no longer tells millimetres apart.
inline constexpr double kMaxReach_m = 1e4;
/// The edge of a box of parts: float poses are relative to its middle.
inline constexpr double kMaxEdge_m = 1e3;

/// Pieces of what is too long for one message: a hundred thousand avatars' part poses are 500.
inline constexpr int32_t kMaxChunks = 100'000;

}  // namespace throng
