#include "avatars/models/adult_body.h"

#include <fmt/format.h>

#include <fstream>

#include "avatars/mesh/tri.h"
#include "avatars/models/loft.h"
#include "base/errors.h"

namespace throng {
namespace {

Eigen::Vector3d on_grid(const Eigen::Vector3d& p) { return rounded(p).cast<double>(); }

}  // namespace

const AdultJoints& adult_joints() {
  // Fractions of stature by Drillis & Contini, in Winter, Biomechanics and Motor Control of Human
  // Movement: ankle height .039, shank .246, thigh .245, upper arm .188, forearm .152.
  static const AdultJoints joints = [] {
    constexpr double h = kAdultHeight_m;
    AdultJoints j;
    // Hip joint centres are .097 h apart; the legs converge slightly towards the feet.
    j.ankle = on_grid({0, 0.075, 0.039 * h});
    j.knee = on_grid({0, 0.080, (0.039 + 0.246) * h});
    j.hip = on_grid({0, 0.085, (0.039 + 0.246 + 0.245) * h});
    j.pelvis = {0, 0, j.hip.z()};
    j.thorax = on_grid({0, 0, 0.600 * h});
    j.head = on_grid({0, 0, 0.852 * h});
    // Acromion height .818 h. The arms hang slightly outwards, clear of chest, hips and thighs.
    j.shoulder = on_grid({-0.012, 0.192, 0.816 * h});
    j.elbow = on_grid(j.shoulder + Eigen::Vector3d(-0.03, 0.100, -1).normalized() * (0.188 * h));
    j.wrist = on_grid(j.elbow + Eigen::Vector3d(0.08, 0.070, -1).normalized() * (0.152 * h));
    return j;
  }();
  return joints;
}

std::vector<AdultPart> adult_parts() {
  const AdultJoints& j = adult_joints();
  std::vector<AdultPart> parts;
  const auto add = [&](const char* file, const Mesh& shape, const Eigen::Vector3d& origin) {
    parts.push_back({file, relative_to(shape, origin), origin});
  };
  const auto add_pair = [&](const char* right, const char* left, const Mesh& shape,
                            const Eigen::Vector3d& origin) {
    const Mesh mesh = relative_to(shape, origin);
    parts.push_back({right, mirrored(mesh), {origin.x(), -origin.y(), origin.z()}});
    parts.push_back({left, mesh, origin});
  };
  add("head.tri", head_shape(), j.head);
  add("torso.tri", torso_shape(), j.thorax);
  add("pelvis.tri", pelvis_shape(), j.pelvis);
  add_pair("upperRightLeg.tri", "upperLeftLeg.tri", upper_leg_shape(), j.hip);
  add_pair("lowerRightLeg.tri", "lowerLeftLeg.tri", lower_leg_shape(), j.knee);
  add_pair("rightFoot.tri", "leftFoot.tri", foot_shape(), j.ankle);
  add_pair("upperRightArm.tri", "upperLeftArm.tri", upper_arm_shape(), j.shoulder);
  add_pair("lowerRightArm.tri", "lowerLeftArm.tri", lower_arm_shape(), j.elbow);
  add_pair("RightHand.tri", "leftHand.tri", hand_shape(), j.wrist);
  return parts;
}

void write_adult(const std::filesystem::path& directory) {
  const auto write = [&](const std::string& name, const std::string& text) {
    std::ofstream out(directory / name, std::ios::binary);
    out << text;
    out.close();
    if (!out) throw EnvironmentError(fmt::format("cannot write {}", (directory / name).string()));
  };
  for (const AdultPart& part : adult_parts()) write(part.file, format_tri(part.mesh));
  write("adult.urdf", adult_urdf_text());
}

}  // namespace throng
