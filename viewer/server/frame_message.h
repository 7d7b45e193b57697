// A frame as the graphics card wants it, and who is so near to others that their spheres overlap.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "viewer/server/pair_history.h"
#include "viewer/server/run_message.h"

namespace throng {

/// People so near to somebody else that their spheres overlap: what the first culling stage passes.
/// Only for showing; culling has its own search, made for speed.
struct PlacedSphere {
  float x = 0, y = 0, z = 0;
  float radius = 0;  ///< 0: nobody there
};

class SphereOverlaps {
 public:
  /// flags[i] becomes 1 if sphere i overlaps another one, else 0; returns how many do. Nothing is
  /// allocated once it has seen as many spheres.
  size_t mark(std::span<const PlacedSphere> spheres, std::span<uint8_t> flags);

 private:
  struct Grid;
  void sort_by_cell(std::span<const PlacedSphere> spheres, const Grid& grid);

  std::vector<uint32_t> start_, order_;
};

// A frame as the graphics card wants it: 16 bytes a person and 16 bytes a body part.
// The page copies it into two textures and does nothing else with a part.

/// What a frame message begins with. `seq` counts the frames that the feed made: a client that sees
/// a hole in it knows how many were dropped for it.
struct FrameHead {
  uint32_t kind = kFrameMessage;
  uint32_t avatars = 0;
  uint32_t parts = 0;
  uint32_t pairs = 0;
  double frame = 0;
  double time_s = 0;
  double seq = 0;
  float frame_ms = 0;    ///< what the simulation needed, 0 where nobody measured
  float build_ms = 0;    ///< what making this message took
  uint32_t crowded = 0;  ///< people whose sphere overlaps somebody else's
  uint32_t present = 0;  ///< people who are there
  float lost = 0;        ///< LCM messages that numbering proves lost
  uint32_t reserved = 0;
};
static_assert(sizeof(FrameHead) == 64);

/// How a part or a person is marked: 0 nothing, else 1 + the level that a pair was decided at.
/// Levels: 0 spheres, 1 boxes, 2 part volumes, 3 triangles.
inline constexpr int kMarks = 5;

class FrameMessages {
 public:
  /// Keeps references. `run` has a description.
  FrameMessages(RunReader& run, const RunGeometry& geometry) : run_(run), geometry_(geometry) {}

  /// head | avatars: f32 x, y, z; u8 flags (1 there, 2 crowded), u8 mark, u16 speed in mm/s |
  /// parts: i16 x, y, z relative to the root, u16 mark, i16 quaternion x, y, z, w |
  /// pairs: u32 a, u32 b, u8 part_a, u8 part_b, u8 level, u8 0, i32 BeginFrame
  /// `frame`: its number; the states may be older. `begins`: since when the pairs of `touching`
  /// touch. `lost`: messages that never came.
  std::shared_ptr<const Bytes> build(double seq, int64_t frame, const RunReader::Touching& touching,
                                     const PairBegins::Begins& begins, int64_t lost = 0);

 private:
  void add_people();
  void mark_pairs(const RunReader::Touching& touching, const PairBegins::Begins& begins);
  void add_parts();
  void pose(size_t first, size_t end);

  RunReader& run_;
  const RunGeometry& geometry_;
  FrameHead head_;
  Bytes* out_ = nullptr;
  size_t parts_at_ = 0;
  std::vector<uint8_t> marks_, person_marks_, crowded_flags_;
  std::vector<PlacedSphere> spheres_;
  std::vector<RootFrame> roots_;
  std::vector<PartPose> poses_;
  SphereOverlaps sphere_overlaps_;
};

}  // namespace throng
