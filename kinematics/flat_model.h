// The kinematic tree as flat arrays, and forward kinematics of many avatars at once.
// One rule: immutable after construction; KDL::TreeFkSolverPos_recursive is the oracle in tests.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/pose.h"
#include "base/simd.h"
#include "kinematics/robot.h"

namespace throng {

/// One column of a posture row: a joint that moves by itself (fixed and mimic joints have none).
struct JointColumn {
  std::string name;
  bool prismatic = false;  ///< metres of the unscaled model; otherwise radians
  float lower = 0;
  float upper = 0;
};

class FlatModel {
 public:
  /// Builds the KDL::Tree of `robot` and flattens it. `output_links` (indices into Robot::links)
  /// are the links whose poses forward_kinematics() delivers, in this order.
  FlatModel(const Robot& robot, std::span<const int> output_links);
  ~FlatModel();
  FlatModel(FlatModel&&) noexcept;
  FlatModel& operator=(FlatModel&&) noexcept;

  const std::vector<JointColumn>& columns() const { return columns_; }
  int column_count() const { return static_cast<int>(columns_.size()); }
  int output_count() const { return output_count_; }
  /// Column of the joint of that name, or -1.
  int column_of(const std::string& joint_name) const;

  /// How far the origin of each output link can be from the root's origin in any posture within the
  /// limits (metres, unscaled): the sum of the offsets along the chain, prismatic travel included.
  const std::vector<float>& reach_m() const { return reach_m_; }

  struct Ops;  // the flat program, private to forward_kinematics()
  const Ops& ops() const { return *ops_; }

 private:
  std::vector<JointColumn> columns_;
  std::vector<float> reach_m_;
  int output_count_ = 0;
  std::unique_ptr<Ops> ops_;
};

/// What forward kinematics needs to know of an avatar besides its posture.
struct RootFrame {
  Eigen::Quaternionf world_from_root = Eigen::Quaternionf::Identity();  ///< unit
  float scale = 1;  ///< height of the avatar / height of the model
};

/// Poses of all output links of roots.size() avatars that share a model.
///   postures  avatar-major, model.column_count() floats a row (radians, or metres of the model)
///   poses     avatar-major, model.output_count() a row; translations scaled, relative to the root
/// Angles are meant to be within some tens of turns. No allocation. Identical to the bit on every
/// SIMD target, and independent of how avatars are grouped into calls.
void forward_kinematics(const FlatModel& model, std::span<const float> postures,
                        std::span<const RootFrame> roots, std::span<PartPose> poses,
                        SimdTarget target = SimdTarget::kBest);
/// The same for rows that lie anywhere: rows[i] points to the posture row of avatar i.
void forward_kinematics(const FlatModel& model, std::span<const float* const> rows,
                        std::span<const RootFrame> roots, std::span<PartPose> poses,
                        SimdTarget target = SimdTarget::kBest);

}  // namespace throng
