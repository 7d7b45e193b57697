// picture_of() renders recorded frames; Animation writes pictures into one animated WebP.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "viewer/picture/raster.h"
#include "viewer/picture/recorded_frame.h"

namespace throng {

/// Options of a picture of people and obstacles, in which touching parts are coloured by level.
struct PictureOptions {
  int width = 1280;
  int height = 720;
  /// Point to look at; empty: the middle of the crowd.
  std::optional<Eigen::Vector3f> target_m;
  /// Position of the eye; empty: south-east and above, where the crowd fills the picture.
  std::optional<Eigen::Vector3f> eye_m;
  /// Angle of view from the lower to the upper edge.
  float fov_rad = Camera{}.vertical_fov_rad;
  /// Names from volume_layers(), drawn around people.
  std::vector<std::string> volumes = {};
  /// Avatar ids; empty: all.
  std::vector<uint32_t> volumes_of = {};
};

/// Returns the names that PictureOptions::volumes accepts. "body-sphere" and "body-box" enclose
/// whole bodies; the others are the values of --part-volume and enclose parts.
std::vector<std::string> volume_layers();

/// Renders the state that `frame` has reached. Touching parts are coloured by level.
Image picture_of(RecordedFrame& frame, const PictureOptions& options);

/// Returns the options with empty eye and target replaced by those of this frame, for a sequence of
/// pictures with one camera.
PictureOptions with_fixed_camera(const CrowdState& crowd, const PictureOptions& options);

// Invariant: the same pictures give the same bytes.

/// Animation encodes an animated WebP that repeats for ever, for pages that show no video.
class Animation {
 public:
  /// All pictures have this size in pixels. `quality`: 0 to 100.
  Animation(int width, int height, float quality);
  ~Animation();

  /// Appends a picture that is shown for `shown_ms`.
  void add(const Image& image, int shown_ms);
  /// Returns the number of bytes. Throws EnvironmentError if the file cannot be written.
  size_t write(const std::filesystem::path& file);

 private:
  struct Encoder;
  std::unique_ptr<Encoder> encoder_;
};

}  // namespace throng
