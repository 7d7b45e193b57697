#include "tests/kinematics/finite_poses.h"

#include <algorithm>
#include <numeric>
#include <vector>

namespace throng {

bool has_finite_poses(const Robot& robot) {
  std::vector<int> links(robot.links.size());
  std::iota(links.begin(), links.end(), 0);
  const FlatModel model(robot, links);
  std::vector<float> posture;
  for (const JointColumn& column : model.columns()) posture.push_back(column.upper);
  const RootFrame root;
  std::vector<PartPose> poses(links.size());
  forward_kinematics(model, posture, {&root, 1}, poses);
  return std::all_of(poses.begin(), poses.end(),
                     [](const PartPose& pose) { return to_isometry(pose).matrix().allFinite(); });
}

}  // namespace throng
