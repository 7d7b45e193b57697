// adult_urdf_text() writes adult.urdf: the links and joints of the bundled adult.
#include <fmt/format.h>

#include "avatars/models/adult_body.h"
#include "base/portable_math.h"

namespace throng {
namespace {

struct Range {
  double lower, upper;
};
Range degrees(double lower, double upper) { return {lower * kDegree, upper * kDegree}; }

/// Share of body mass (Winter, Biomechanics and Motor Control of Human Movement, table 4.1).
double mass_share(const std::string& link) {
  if (link == "head") return 0.081;
  if (link == "torso") return 0.216 + 0.139;
  if (link == "pelvis") return 0.142;
  if (link.find("Foot") != std::string::npos) return 0.0145;
  if (link.find("Hand") != std::string::npos) return 0.006;
  const bool leg = link.find("Leg") != std::string::npos;
  const bool upper = link.rfind("upper", 0) == 0;
  if (leg) return upper ? 0.100 : 0.0465;
  return upper ? 0.028 : 0.016;
}

std::string text_of(const Eigen::Vector3d& v) {
  return fmt::format("{:.5f} {:.5f} {:.5f}", v.x(), v.y(), v.z());
}

class Urdf {
 public:
  void helper(const std::string& name) { text_ += fmt::format("  <link name=\"{}\"/>\n", name); }

  /// Adds a link with its mesh; inertia of the ellipsoid inscribed in the mesh's box.
  void body(const AdultPart& part) {
    const std::string name = part.file.substr(0, part.file.find('.'));
    Eigen::Vector3d low = part.mesh.vertices[0].cast<double>();
    Eigen::Vector3d high = low;
    for (const Eigen::Vector3f& v : part.mesh.vertices) {
      low = low.cwiseMin(v.cast<double>());
      high = high.cwiseMax(v.cast<double>());
    }
    const double mass = mass_share(name) * kAdultMass_kg;
    const Eigen::Vector3d s = (0.5 * (high - low)).cwiseAbs2() * (mass / 5);
    text_ += fmt::format(
        "  <link name=\"{0}\">\n"
        "    <inertial>\n"
        "      <origin xyz=\"{1}\"/>\n"
        "      <mass value=\"{2:.4f}\"/>\n"
        "      <inertia ixx=\"{3:.6f}\" ixy=\"0\" ixz=\"0\" iyy=\"{4:.6f}\" iyz=\"0\" "
        "izz=\"{5:.6f}\"/>\n"
        "    </inertial>\n"
        "    <visual><geometry><mesh filename=\"{6}\"/></geometry></visual>\n"
        "    <collision><geometry><mesh filename=\"{6}\"/></geometry></collision>\n"
        "  </link>\n",
        name, text_of(0.5 * (low + high)), mass, s.y() + s.z(), s.x() + s.z(), s.x() + s.y(),
        part.file);
  }

  void joint(const std::string& name, const char* type, const std::string& parent,
             const std::string& child, const Eigen::Vector3d& origin, const char* axis,
             const Range& range) {
    // Effort and velocity of a strong adult; Throng ignores both.
    text_ += fmt::format(
        "  <joint name=\"{}\" type=\"{}\">\n"
        "    <parent link=\"{}\"/>\n"
        "    <child link=\"{}\"/>\n"
        "    <origin xyz=\"{}\"/>\n"
        "    <axis xyz=\"{}\"/>\n"
        "    <limit lower=\"{:.5f}\" upper=\"{:.5f}\" effort=\"300\" velocity=\"15\"/>\n"
        "  </joint>\n",
        name, type, parent, child, text_of(origin), axis, range.lower, range.upper);
  }

  void revolute(const std::string& name, const std::string& parent, const std::string& child,
                const Eigen::Vector3d& origin, const char* axis, const Range& range) {
    joint(name, "revolute", parent, child, origin, axis, range);
  }

  std::string text_;
};

/// Adds one arm and one leg; positive angles mean the same on both sides.
void add_side(Urdf& urdf, bool left) {
  const AdultJoints& j = adult_joints();
  const std::string side = left ? "left" : "right";
  const auto here = [&](const Eigen::Vector3d& joint, const Eigen::Vector3d& parent) {
    const Eigen::Vector3d d = joint - parent;
    return Eigen::Vector3d(d.x(), left ? d.y() : -d.y(), d.z());
  };
  const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
  const char* forward = "0 -1 0";  // turns a hanging limb forwards
  const char* outward = left ? "1 0 0" : "-1 0 0";
  const char* inward = left ? "-1 0 0" : "1 0 0";
  const std::string upper_arm = left ? "upperLeftArm" : "upperRightArm";
  const std::string lower_arm = left ? "lowerLeftArm" : "lowerRightArm";
  const std::string hand = left ? "leftHand" : "RightHand";
  const std::string upper_leg = left ? "upperLeftLeg" : "upperRightLeg";
  const std::string lower_leg = left ? "lowerLeftLeg" : "lowerRightLeg";
  const std::string foot = left ? "leftFoot" : "rightFoot";
  // Ranges of knee, hip, ankle, elbow and wrist: Rajagopal et al. 2016, full-body model.
  const std::string shoulder = side + "_shoulder_flexion_link";
  urdf.revolute(side + "_shoulder_flexion", "torso", shoulder, here(j.shoulder, j.thorax), forward,
                degrees(-60, 120));
  urdf.revolute(side + "_shoulder_abduction", shoulder, upper_arm, zero, outward, degrees(-10, 90));
  urdf.revolute(side + "_elbow_flexion", upper_arm, lower_arm, here(j.elbow, j.shoulder), forward,
                degrees(0, 150));
  urdf.revolute(side + "_wrist_flexion", lower_arm, hand, here(j.wrist, j.elbow), inward,
                degrees(-70, 70));
  const std::string hip = side + "_hip_flexion_link";
  const std::string hip2 = side + "_hip_adduction_link";
  urdf.revolute(side + "_hip_flexion", "pelvis", hip, here(j.hip, j.pelvis), forward,
                degrees(-30, 120));
  urdf.revolute(side + "_hip_adduction", hip, hip2, zero, inward, degrees(-50, 30));
  urdf.revolute(side + "_hip_rotation", hip2, upper_leg, zero, left ? "0 0 -1" : "0 0 1",
                degrees(-40, 40));
  urdf.revolute(side + "_knee_flexion", upper_leg, lower_leg, here(j.knee, j.hip), "0 1 0",
                degrees(0, 120));
  urdf.revolute(side + "_ankle_flexion", lower_leg, foot, here(j.ankle, j.knee), forward,
                degrees(-40, 30));
}

}  // namespace

std::string adult_urdf_text() {
  const AdultJoints& j = adult_joints();
  const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
  Urdf urdf;
  urdf.text_ =
      "<?xml version=\"1.0\"?>\n"
      "<!-- An adult 1.75 m tall. x forward, y left, z up, metres; all joints at zero: standing "
      "upright,\n"
      "     arms hanging, soles at z = 0 of base_footprint. Written by throng_generate_adult. -->\n"
      "<robot name=\"adult\">\n";
  for (const char* name :
       {"base_footprint", "pelvis_lateral_link", "pelvis_forward_link", "pelvis_vertical_link",
        "pelvis_yaw_link", "pelvis_pitch_link", "left_shoulder_flexion_link",
        "right_shoulder_flexion_link", "left_hip_flexion_link", "left_hip_adduction_link",
        "right_hip_flexion_link", "right_hip_adduction_link"})
    urdf.helper(name);
  for (const AdultPart& part : adult_parts()) urdf.body(part);
  urdf.joint("pelvis_lateral", "prismatic", "base_footprint", "pelvis_lateral_link", zero, "0 1 0",
             {-0.06, 0.06});
  urdf.joint("pelvis_forward", "prismatic", "pelvis_lateral_link", "pelvis_forward_link", zero,
             "1 0 0", {-0.03, 0.03});
  urdf.joint("pelvis_vertical", "prismatic", "pelvis_forward_link", "pelvis_vertical_link",
             j.pelvis, "0 0 1", {-0.15, 0.06});
  urdf.revolute("pelvis_yaw", "pelvis_vertical_link", "pelvis_yaw_link", zero, "0 0 1",
                degrees(-20, 20));
  urdf.revolute("pelvis_pitch", "pelvis_yaw_link", "pelvis_pitch_link", zero, "0 1 0",
                degrees(-15, 15));
  urdf.revolute("pelvis_roll", "pelvis_pitch_link", "pelvis", zero, "1 0 0", degrees(-15, 15));
  urdf.revolute("thorax_yaw", "pelvis", "torso", j.thorax - j.pelvis, "0 0 1", degrees(-45, 45));
  urdf.revolute("head_yaw", "torso", "head", j.head - j.thorax, "0 0 1", degrees(-45, 45));
  add_side(urdf, false);
  add_side(urdf, true);
  urdf.text_ += "</robot>\n";
  return urdf.text_;
}

}  // namespace throng
