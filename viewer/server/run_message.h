// run_message() describes a run to the page before its first frame.
// Invariant: it depends on the run's description only; live runs, logs and files look the same.
#pragma once

#include <string>

#include "lcm_io/codec/run_reader.h"
#include "viewer/server/little_endian.h"

namespace throng {

/// First four bytes of the binary messages.
inline constexpr uint32_t kRunMessage = 0x31525454;        // "TTR1"
inline constexpr uint32_t kFrameMessage = 0x31465454;      // "TTF1"
inline constexpr uint32_t kContactsMessage = 0x31435454;   // "TTC1"
inline constexpr uint32_t kProximityMessage = 0x31445454;  // "TTD1"
inline constexpr uint32_t kPositionsMessage = 0x31505454;  // "TTP1"

/// A sphere in the root frame that encloses all postures of a model's gait, metres at scale 1.
struct AvatarSphere {
  float centre_z_m = 0;
  float radius_m = 0;
};

/// RunGeometry is computed once from the description; it tabulates the gaits.
struct RunGeometry {
  std::vector<AvatarSphere> spheres;  ///< one per model
  /// Step of part positions (int16) in a frame message, in metres; one per model.
  std::vector<float> part_step_m;
  std::vector<uint32_t> first_part;  ///< avatar_count + 1 entries: first part of each avatar

  /// `run` must have a description. Throws InputError if the kinematics reject a model or the run
  /// is too large for a page.
  explicit RunGeometry(RunReader& run);
};

enum class ViewMode { kLive, kLog, kFile };

/// u32 kRunMessage | u32 bytes of JSON | JSON, blanks to a multiple of 4 | binary section.
/// Vertices are int16 in steps of `vertex_step_m`; triangles and lines of the or-DOPs are u32.
/// Offsets count bytes from the start of the binary section.
Bytes run_message(RunReader& run, const RunGeometry& geometry, ViewMode mode);

}  // namespace throng
