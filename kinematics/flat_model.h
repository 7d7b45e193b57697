// FlatModel stores the kinematic tree as flat arrays; forward_kinematics() poses many avatars at
// once.
// Invariant: immutable after construction.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/pose.h"
#include "base/simd.h"
#include "kinematics/robot.h"

namespace throng {

/// Column of a posture row: an independent joint (fixed and mimic joints have none).
struct JointColumn {
  std::string name;
  bool prismatic = false;  ///< metres of the unscaled model; otherwise radians
  float lower = 0;
  float upper = 0;
};

class FlatModel {
 public:
  /// `output_links`: indices into Robot::links of the poses to compute, in this order.
  FlatModel(const Robot& robot, std::span<const int> output_links);
  ~FlatModel();
  FlatModel(FlatModel&&) noexcept;
  FlatModel& operator=(FlatModel&&) noexcept;

  const std::vector<JointColumn>& columns() const { return columns_; }
  int column_count() const { return static_cast<int>(columns_.size()); }
  int output_count() const { return output_count_; }
  int column_of(const std::string& joint_name) const;

  /// Maximum distance of output links from the root in any posture (metres, unscaled): the sum of
  /// the offsets along the chain, prismatic travel included.
  const std::vector<float>& reach_m() const { return reach_m_; }

  struct Ops;  // the flat program, private to forward_kinematics()
  const Ops& ops() const { return *ops_; }

 private:
  std::vector<JointColumn> columns_;
  std::vector<float> reach_m_;
  int output_count_ = 0;
  std::unique_ptr<Ops> ops_;
};

struct RootFrame {
  Eigen::Quaternionf world_from_root = Eigen::Quaternionf::Identity();  ///< unit
  float scale = 1;  ///< height of the avatar / height of the model
};

/// Computes the poses of all output links of roots.size() avatars that share a model.
///   postures  avatar-major, model.column_count() floats per row (radians, or metres of the model)
///   poses     avatar-major, model.output_count() per row; translations scaled, relative to the
///   root
/// Angles should be within some tens of turns. Does not allocate. Identical to the bit on every
/// SIMD target, and independent of how avatars are grouped into calls.
void forward_kinematics(const FlatModel& model, std::span<const float> postures,
                        std::span<const RootFrame> roots, std::span<PartPose> poses,
                        SimdTarget target = SimdTarget::kBest);
/// Same for scattered rows: rows[i] points to the posture row of avatar i.
void forward_kinematics(const FlatModel& model, std::span<const float* const> rows,
                        std::span<const RootFrame> roots, std::span<PartPose> poses,
                        SimdTarget target = SimdTarget::kBest);

}  // namespace throng
