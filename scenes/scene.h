// A scene as its YAML file describes it, checked.
// One rule: a Scene that exists can be run; every complaint names file:line and the way out.
#pragma once

#include <Eigen/Core>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "avatars/mesh.h"
#include "culling/culler.h"

namespace throng {

struct Rectangle {
  Eigen::Vector2d min_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d max_m = Eigen::Vector2d::Zero();
};

/// A normal distribution cut off at both ends.
struct Distribution {
  double mean = 0;
  double deviation = 0;
  double min = 0;
  double max = 0;
};

/// People of one model who start in one area and walk to goals.
struct Group {
  std::string name;
  std::filesystem::path model;  ///< a URDF, absolute; "adult" in the file means the bundled one
  int count = 0;
  Rectangle spawn;
  std::vector<Rectangle> goals;  ///< visited in order, then over again
  Distribution speed_mps{1.34, 0.26, 0.5, 2.2};   // Weidmann 1993
  Distribution height_m{1.70, 0.09, 1.45, 2.00};  // ANSUR II, men and women mixed
};

/// Something solid that stands still.
struct Obstacle {
  enum class Kind { kBox, kCylinder, kMesh };
  std::string name;
  Kind kind = Kind::kBox;
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();
  double heading_rad = 0;
  Eigen::Vector3d size_m = Eigen::Vector3d::Ones();  ///< box edges; cylinder: diameter, diameter, height
  std::filesystem::path mesh_file;
  Mesh mesh;  ///< the solid in the obstacle's own frame, whatever its kind
};

struct Scene {
  std::string name;
  std::string description;
  std::filesystem::path file;
  uint64_t seed = 1;
  double step_s = 1.0 / 60.0;
  double duration_s = 10;
  Rectangle ground;
  std::vector<Group> groups;
  std::vector<Obstacle> obstacles;
  VolumeKind part_volume = VolumeKind::kOrdop26;
  bool exact = false;
  uint64_t content_hash = 0;  ///< of what the file says and of what it refers to, not of where it lies
};

/// A path, or the name of a bundled scene. Throws InputError with file:line or a did-you-mean.
Scene load_scene(const std::string& path_or_name);

/// The bundled scenes (name and one-line description), sorted by name.
struct SceneEntry {
  std::string name;
  std::string description;
};
std::vector<SceneEntry> bundled_scenes();

/// Scales the groups in proportion to `total` people; spawn areas that become too full grow with the
/// ground. Says on `notes` what it changed.
void scale_to(Scene& scene, int total, std::vector<std::string>& notes);

}  // namespace throng
