// A model: a URDF and the meshes of its links, ready to be posed, culled and published.
// One rule: immutable and shared by all avatars of that model; part frames are link frames.
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
  std::string source;  ///< "head.tri", "box", ...: what the shape came from, never an absolute path
  int link = -1;       ///< index into Model::robot.links
  Mesh mesh;
};

struct Model {
  std::string name;  ///< the URDF's robot name
  Robot robot;
  std::vector<Part> parts;  ///< in link order; links without geometry carry no part
  FlatModel kinematics;     ///< output i is the pose of parts[i]
  /// In start_box_m: of a person the top above the root, which lies on the ground; of a robot from
  /// its lowest point to its highest.
  float height_m = 0;
  uint64_t content_hash =
      0;  ///< of the URDF text and every mesh: names the model in a run's identity

  /// A person: has the joints of human legs, so that a gait moves them. Anything else is a robot.
  bool is_person = false;
  /// Around all parts with every joint at zero, or as near as its limits let it (root's frame).
  Eigen::AlignedBox3f start_box_m{};
  /// What its files leave open or state in vain, and how they are read, a line each: runs show
  /// these.
  std::vector<std::string> assumptions{};

  int part_count() const { return static_cast<int>(parts.size()); }
  /// How high the root is over the ground it stands on, at scale 1: a person's lies on it, a robot
  /// stands on the lowest point of its start_box_m.
  float root_height_m() const {
    return is_person || start_box_m.isEmpty() ? 0 : 0 - start_box_m.min().z();
  }
  /// Of the circle around the root's z axis that holds start_box_m.
  float footprint_radius_m() const {
    return start_box_m.isEmpty() ? 0
                                 : start_box_m.min()
                                       .head<2>()
                                       .cwiseAbs()
                                       .cwiseMax(start_box_m.max().head<2>().cwiseAbs())
                                       .norm();
  }
};

/// Radius of the sphere about the root's origin that holds every part in every posture within the
/// joints' limits (metres, unscaled).
float reach_of(const Model& model);

/// Reads a URDF and every mesh it names. Collision geometry is preferred, visual is used where a
/// link has no collision geometry. Throws InputError.
std::shared_ptr<const Model> load_model(const std::filesystem::path& urdf_file);

/// The same for looking at a model whose meshes are not all at hand: links whose shapes cannot be
/// read carry no part, and `unreadable` gets a line for each. Throws InputError for a bad URDF.
std::shared_ptr<const Model> load_readable_model(const std::filesystem::path& urdf_file,
                                                 std::vector<std::string>& unreadable);

/// Where the bundled models and scenes lie: $THRONG_DATA, else share/throng in a folder above the
/// program or module, else in the package that it was built with, else throng in one of
/// $XDG_DATA_DIRS. Throws EnvironmentError if they are nowhere.
std::filesystem::path data_directory();

/// A file that was made when Throng was built: NAME in lib/throng beside the share/throng of a data
/// directory. Empty if there is none.
std::filesystem::path generated_file(const std::filesystem::path& name);

/// The bundled adult: avatars/models/adult/adult.urdf.
std::filesystem::path adult_urdf();

}  // namespace throng
