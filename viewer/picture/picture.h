// CrowdPainter draws recorded frames.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "viewer/picture/raster.h"
#include "viewer/picture/recorded_frame.h"
#include "viewer/picture/volume_outline.h"

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

/// CrowdPainter draws pictures of a recorded run. Touching parts are coloured by level; people far
/// away have fewer triangles.
class CrowdPainter {
 public:
  /// `frame` must outlive it. threads >= 1; their number changes no picture.
  CrowdPainter(RecordedFrame& frame, PictureOptions options, int threads);
  ~CrowdPainter();

  /// Draws the state that the frame has reached.
  Image paint();

  /// Replaces an empty eye and target by those that show the whole crowd of this state, for a
  /// sequence of pictures with one camera.
  void fix_camera();

 private:
  struct DrawnModel;
  DrawnModel& model(size_t index);
  void add_people(const Camera& camera, std::vector<RenderItem>& items);
  void add_obstacles(std::vector<RenderItem>& items) const;
  void add_volumes(const Camera& camera, VolumeItems& out);

  RecordedFrame& frame_;
  PictureOptions options_;
  Workers workers_;
  std::vector<std::unique_ptr<DrawnModel>>
      models_;  ///< one per model of the run, loaded on first use
  std::vector<Shape> obstacles_;
};

}  // namespace throng
