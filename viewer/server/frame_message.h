// FrameMessages packs a frame for the graphics card; SphereOverlaps finds overlapping spheres.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "viewer/server/pair_history.h"
#include "viewer/server/run_message.h"

namespace throng {

/// The bounding sphere of an avatar, for display only; culling has its own search.
struct PlacedSphere {
  float x = 0, y = 0, z = 0;
  float radius = 0;  ///< 0: avatar not present
};

/// SphereOverlaps marks the avatars that pass the first culling stage.
class SphereOverlaps {
 public:
  /// Sets flags[i] to 1 if sphere i overlaps another, else to 0; returns the number of ones.
  /// Allocates nothing once it has seen as many spheres.
  size_t mark(std::span<const PlacedSphere> spheres, std::span<uint8_t> flags);

 private:
  struct Grid;
  void sort_by_cell(std::span<const PlacedSphere> spheres, const Grid& grid);

  std::vector<uint32_t> start_, order_;
};

// A frame takes 16 bytes per person and 16 bytes per body part.
// Invariant: the page copies a frame into two textures without conversion.

/// Start of a frame message. `seq` counts the frames that the server built. A gap is the number of
/// frames that were dropped for a client.
struct FrameHead {
  uint32_t kind = kFrameMessage;
  uint32_t avatars = 0;
  uint32_t parts = 0;
  uint32_t pairs = 0;
  double frame = 0;
  double time_s = 0;
  double seq = 0;
  float frame_ms = 0;    ///< simulation time per frame; 0 if not measured
  float build_ms = 0;    ///< time to build this message
  uint32_t crowded = 0;  ///< avatars whose sphere overlaps another sphere
  uint32_t present = 0;  ///< avatars in the scene
  float lost = 0;        ///< LCM messages known to be lost, by their numbers
  uint32_t reserved = 0;
};
static_assert(sizeof(FrameHead) == 64);

/// Marks of a part or person: 0 none, else 1 + the level at which a pair was decided.
/// Levels: 0 spheres, 1 boxes, 2 part volumes, 3 triangles.
inline constexpr int kMarks = 5;

class FrameMessages {
 public:
  /// Keeps references. `run` must have a description.
  FrameMessages(RunReader& run, const RunGeometry& geometry) : run_(run), geometry_(geometry) {}

  /// head | avatars: f32 x, y, z; u8 flags (1 there, 2 crowded), u8 mark, u16 speed in mm/s |
  /// parts: i16 x, y, z relative to the root, u16 mark, i16 quaternion x, y, z, w |
  /// pairs: u32 a, u32 b, u8 part_a, u8 part_b, u8 level, u8 0, i32 BeginFrame
  /// `frame`: its number; the states may be older. `begins`: begin frames of the pairs in
  /// `touching`. `lost`: number of lost messages.
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
