// What the page has to know of a run before it can draw a frame of it.
// One rule: made from the described run alone, so that a live run, a log and a file to send show
// the same page.
#pragma once

#include <string>

#include "lcm_io/codec/run_reader.h"
#include "viewer/server/little_endian.h"

namespace throng {

/// First four bytes of the binary messages.
inline constexpr uint32_t kRunMessage = 0x31525454;    // "TTR1"
inline constexpr uint32_t kFrameMessage = 0x31465454;  // "TTF1"

/// A sphere of the root frame around every posture of a model's gait, metres at scale 1.
struct AvatarSphere {
  float centre_z_m = 0;
  float radius_m = 0;
};

/// What is derived from the description once: gaits are tabulated for it.
struct RunGeometry {
  std::vector<AvatarSphere> spheres;  ///< one a model
  /// One a model: what a step of a part's position (int16) in a frame message is, metres.
  std::vector<float> part_step_m;
  std::vector<uint32_t> first_part;  ///< avatar_count + 1 entries: parts of avatars before

  /// `run` has a description. Throws InputError where kinematics refuse a model, and where a run is
  /// larger than any page could show.
  explicit RunGeometry(RunReader& run);
};

/// Where the frames come from: "live", "log" or "file".
enum class ViewMode { kLive, kLog, kFile };

/// u32 kRunMessage | u32 bytes of JSON | JSON, blanks to a multiple of 4 | binary section.
/// Positions of vertices are int16 in steps of `vertex_step_m`, triangles u32, lines of the or-DOPs
/// too; offsets count bytes from the beginning of the binary section.
Bytes run_message(RunReader& run, const RunGeometry& geometry, ViewMode mode);

}  // namespace throng
