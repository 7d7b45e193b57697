// Model is a body model: a URDF and the meshes of its links, ready for posing, culling and
// publishing.
// Invariant: immutable and shared by all avatars of that model; part frames are link frames.
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "avatars/mesh/mesh.h"
#include "kinematics/kinematics.h"

namespace throng {

/// A body part: a link with geometry, its shapes merged into one mesh in the link's frame.
struct Part {
  std::string name;    ///< the link's name
  std::string source;  ///< origin of the shape, such as "head.tri" or "box"; never an absolute path
  int link = -1;       ///< index into Model::robot.links
  Mesh mesh;
};

struct Model {
  std::string name;  ///< the URDF's robot name
  Robot robot;
  std::vector<Part> parts;  ///< in link order; links without geometry carry no part
  FlatModel kinematics;     ///< output i is the pose of parts[i]
  /// Height within start_box_m. Person: from the root, which lies on the ground, to the top. Robot:
  /// from its lowest point to its highest.
  float height_m = 0;
  uint64_t content_hash =
      0;  ///< hash of the URDF text and all meshes; identifies the model in a run id

  /// Whether the model has human legs. All others are robots.
  bool is_person = false;
  /// Box around all parts in the root frame, with every joint at zero, clamped to its limits.
  Eigen::AlignedBox3f start_box_m{};
  /// Gaps and ignored statements in the model's files, one per line, with their interpretation.
  std::vector<std::string> assumptions{};

  int part_count() const { return static_cast<int>(parts.size()); }
  /// Returns the height of the root above the ground at scale 1. A person's root lies on it; a
  /// robot stands on the lowest point of start_box_m.
  float root_height_m() const {
    return is_person || start_box_m.isEmpty() ? 0 : 0 - start_box_m.min().z();
  }
  /// Returns the radius of the circle around the root's z axis that contains start_box_m.
  float footprint_radius_m() const {
    return start_box_m.isEmpty() ? 0
                                 : start_box_m.min()
                                       .head<2>()
                                       .cwiseAbs()
                                       .cwiseMax(start_box_m.max().head<2>().cwiseAbs())
                                       .norm();
  }
};

/// Whether the model has the joints of human legs, which a gait can move.
bool has_human_legs(const Model& model);

/// Radius of the sphere about the root's origin that contains every posture (metres, unscaled).
float reach_of(const Model& model);

/// Reads a URDF and its meshes. Visual geometry is used where there is no collision geometry.
/// Throws InputError.
std::shared_ptr<const Model> load_model(const std::filesystem::path& urdf_file);

/// Same for a model with missing meshes: links with unreadable shapes have no part, and
/// `unreadable` gets a line for each. Throws InputError for a bad URDF.
std::shared_ptr<const Model> load_readable_model(const std::filesystem::path& urdf_file,
                                                 std::vector<std::string>& unreadable);

/// Returns the directory of the bundled models and scenes. Search order: $THRONG_DATA; share/throng
/// in a folder above the program or module; the package it was built with; throng in
/// $XDG_DATA_DIRS. Throws EnvironmentError if none exists.
std::filesystem::path data_directory();

/// Returns lib/throng/NAME next to share/throng, a file generated at build time; empty if missing.
std::filesystem::path generated_file(const std::filesystem::path& name);

std::filesystem::path adult_urdf();

}  // namespace throng
