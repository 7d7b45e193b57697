// A picture of a recorded frame: people and obstacles, what touches in another colour.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "viewer/picture/raster.h"
#include "viewer/picture/recorded_frame.h"

namespace throng {

struct PictureOptions {
  int width = 1280;
  int height = 720;
  /// Where to look at; the middle of the crowd if empty.
  std::optional<Eigen::Vector3f> target_m;
  /// Where the eye is; empty: south-east and above, so far that the crowd fills the picture.
  std::optional<Eigen::Vector3f> eye_m;
  /// Drawn around people, those of volume_layers().
  std::vector<std::string> volumes = {};
  /// Around these alone; empty: around everybody.
  std::vector<uint32_t> volumes_of = {};
};

/// What PictureOptions::volumes may name, stage by stage: "body-sphere" and "body-box" are around
/// whole bodies; the others, as --part-volume has them, around each part.
std::vector<std::string> volume_layers();

Image picture_of(RecordedFrame& frame, const PictureOptions& options);

/// The options with eye and target filled in where they were empty, as this frame wants them: for
/// pictures that follow each other.
PictureOptions with_fixed_camera(const CrowdState& crowd, const PictureOptions& options);

}  // namespace throng
