// Robot is a robot or person as described by its URDF, checked.
// Invariant: one root, every link reachable, unit axes, lower <= upper.
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace throng {

/// One <visual> or <collision> shape of a link. Lengths in metres.
struct Geometry {
  enum class Kind { kMesh, kBox, kCylinder, kSphere, kCapsule };
  Kind kind = Kind::kBox;
  Eigen::Isometry3d link_from_geometry = Eigen::Isometry3d::Identity();
  std::filesystem::path mesh_file;  ///< kMesh: resolved, package:// and relative
  Eigen::Vector3d mesh_scale = Eigen::Vector3d::Ones();  ///< kMesh
  Eigen::Vector3d box_size_m = Eigen::Vector3d::Zero();  ///< kBox: full edge lengths
  double radius_m = 0;                                   ///< kCylinder, kCapsule, kSphere
  /// kCylinder, kCapsule (without its two half spheres): along z, centred.
  double length_m = 0;
};

struct Link {
  std::string name;
  std::vector<Geometry> visual;
  std::vector<Geometry> collision;
  std::optional<double> mass_kg;
};

struct Joint {
  enum class Kind { kFixed, kRevolute, kContinuous, kPrismatic };
  struct Mimic {
    int joint = -1;  ///< index into Robot::joints
    double multiplier = 1;
    double offset = 0;
  };
  std::string name;
  Kind kind = Kind::kFixed;
  int parent_link = -1;  ///< index into Robot::links
  int child_link = -1;
  Eigen::Isometry3d parent_from_joint = Eigen::Isometry3d::Identity();
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();  ///< unit, in the joint frame
  double lower = 0;                                 ///< rad or m; -pi..pi for continuous
  double upper = 0;
  std::optional<Mimic> mimic;
};

struct Robot {
  std::string name;           ///< the file name without extension if the URDF has no name
  std::vector<Link> links;    ///< parents before children; links[0] is the root
  std::vector<Joint> joints;  ///< joints[i].child_link == i + 1
  /// One line for each statement of the URDF that is skipped or not used.
  std::vector<std::string> notes;
};

/// Reads and checks a URDF file: size, depth, two parents, loops, zero axes, lower > upper and
/// more. urdfdom gets only the parts that are read. Throws InputError naming file, line where
/// known, expected and found.
Robot read_urdf(const std::filesystem::path& file);

/// Returns whether a regular file, of any name, is an XML text with the root element <robot>.
bool is_urdf(const std::filesystem::path& file);

/// Returns the text of a URDF file after checking its size. Throws InputError.
std::string read_urdf_text(const std::filesystem::path& file);

/// Same as read_urdf(), from text; `file` names it in errors and anchors relative mesh paths.
/// Appends to `assumptions` one line for each gap in the URDF and its interpretation.
Robot parse_urdf(const std::string& text, const std::filesystem::path& file,
                 std::vector<std::string>* assumptions = nullptr);

}  // namespace throng
