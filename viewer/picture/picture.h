// Pictures of recorded frames: people and obstacles, what touches in another colour; one after the
// other in one file where a page shows no video.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "viewer/picture/raster.h"
#include "viewer/picture/recorded_frame.h"

namespace throng {

/// A picture of a recorded frame: people and obstacles, what touches in another colour.
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

// Pictures one after the other in one file, for pages that show no video.
// The same pictures give the same bytes.

/// An animated WebP that repeats for ever.
class Animation {
 public:
  /// All pictures have this size. `quality` 0 to 100: what is kept of fine differences.
  Animation(int width, int height, float quality);
  ~Animation();

  void add(const Image& image, int shown_ms);
  /// Throws EnvironmentError if it cannot be written; returns how many bytes it has.
  size_t write(const std::filesystem::path& file);

 private:
  struct Encoder;
  std::unique_ptr<Encoder> encoder_;
};

}  // namespace throng
