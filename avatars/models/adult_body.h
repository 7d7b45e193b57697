// The bundled adult: 15 body parts lofted from anthropometric tables, and the URDF that joins them.
// Invariant: parts are drawn standing upright in the root frame, then moved into their joint's
// frame. The root frame is x forward, y left, z up, soles at z = 0. Right parts mirror left ones.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "avatars/mesh/mesh.h"

namespace throng {

/// Stature of the bundled adult, metres; segment lengths are fractions of it.
inline constexpr double kAdultHeight_m = 1.75;
/// Body mass, kg: the mean stature at a body mass index of 24.
inline constexpr double kAdultMass_kg = 73.5;

/// Joint centres of the standing adult in the root frame, left side, in metres.
struct AdultJoints {
  Eigen::Vector3d pelvis, thorax, head, shoulder, elbow, wrist, hip, knee, ankle;
};
const AdultJoints& adult_joints();

struct AdultPart {
  std::string file;        ///< "head.tri": a name of Table 1 of Suaib et al. 2013
  Mesh mesh;               ///< in the frame of its joint
  Eigen::Vector3d origin;  ///< origin of that frame when standing, in the root frame
};

std::vector<AdultPart> adult_parts();

std::string adult_urdf_text();

/// Writes adult.urdf and the 15 .tri files. Throws EnvironmentError.
void write_adult(const std::filesystem::path& directory);

// The shapes, left side, in the root frame.
Mesh head_shape();
Mesh torso_shape();
Mesh pelvis_shape();
Mesh upper_leg_shape();
Mesh lower_leg_shape();
Mesh foot_shape();
Mesh upper_arm_shape();
Mesh lower_arm_shape();
Mesh hand_shape();

}  // namespace throng
