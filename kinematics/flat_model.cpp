#include "kinematics/flat_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <kdl/frames.hpp>
#include <kdl/tree.hpp>
#include <optional>

#include "base/errors.h"
#include "kinematics/flat_ops.h"
#include "kinematics/kdl_tree.h"

namespace throng {
namespace {

/// Offsets below a picometre or a picoradian are rounding errors of the file's decimals.
constexpr double kNegligible = 1e-12;

Eigen::Vector3d to_eigen(const KDL::Vector& v) { return {v.x(), v.y(), v.z()}; }

Eigen::Isometry3d to_eigen(const KDL::Frame& frame) {
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) out.linear()(r, c) = frame.M(r, c);
  out.translation() = to_eigen(frame.p);
  return out;
}

std::optional<int> principal(const Eigen::Vector3d& v) {
  for (int k = 0; k < 3; ++k)
    if (std::abs(std::abs(v[k]) - 1) < kNegligible) return k;
  return std::nullopt;
}

/// Smallest rotation between unit vectors that are not opposite; avoids compiling Eigen's SVD.
Eigen::Quaterniond turn(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const double s = std::sqrt((1 + to.dot(from)) * 2);
  const Eigen::Vector3d axis = from.cross(to);
  Eigen::Quaterniond q;
  q.vec() = axis * (1 / s);
  q.w() = s * 0.5;
  return q;
}

/// A joint as in KDL: parent_from_child(q) = before * joint(q) * after.
struct FlatJoint {
  bool fixed = true;
  bool slides = false;
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  Eigen::Isometry3d before = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d after = Eigen::Isometry3d::Identity();
  Drive drive;
  double travel_m = 0;  ///< maximum displacement of a sliding joint from zero
};

FlatJoint to_flat(const KDL::Segment& segment) {
  const KDL::Joint& joint = segment.getJoint();
  FlatJoint out;
  const Eigen::Isometry3d tip = to_eigen(segment.getFrameToTip());
  out.fixed = joint.getType() == KDL::Joint::Fixed;
  if (out.fixed) {
    out.after = tip;
    return out;
  }
  out.slides = joint.getType() == KDL::Joint::TransAxis;
  out.axis = to_eigen(joint.JointAxis());
  out.before.translation() = to_eigen(joint.JointOrigin());
  out.after = out.before.inverse() * tip;
  return out;
}

class Flattener {
 public:
  Flattener(const Robot& robot, const std::vector<JointColumn>& columns,
            std::span<const int> output_links, FlatModel::Ops& ops, std::vector<float>& reach_m)
      : robot_(robot), ops_(ops), reach_m_(reach_m), nodes_(robot.links.size()) {
    const KDL::Tree tree = to_kdl(robot);
    for (size_t i = 0; i < robot.joints.size(); ++i) {
      Node& node = nodes_[i + 1];
      const std::string& child = robot.links[i + 1].name;
      node.joint = to_flat(tree.getSegment(child)->second.segment);
      if (!node.joint.fixed) set_drive(node.joint, robot.joints[i], columns);
    }
    for (size_t i = 0; i < output_links.size(); ++i)
      nodes_[static_cast<size_t>(output_links[i])].outputs.push_back(static_cast<int>(i));
    prune_to_outputs();
    reach_m_.assign(output_links.size(), 0.0f);
    visit(nodes_[0], Eigen::Isometry3d::Identity(), 0, 0);
  }

 private:
  struct Node {
    FlatJoint joint;
    std::vector<int> outputs;
    std::vector<int> children;  ///< those with outputs below, lightest subtree first
    int weight = 0;             ///< number of links in the subtree that outputs need
  };

  static size_t index(int i) { return static_cast<size_t>(i); }

  void set_drive(FlatJoint& flat, const Joint& joint, const std::vector<JointColumn>& columns) {
    double multiplier = 1;
    double offset = 0;
    const Joint* leader = &joint;
    while (leader->mimic) {  // q = m (m' q' + o') + o
      offset += multiplier * leader->mimic->offset;
      multiplier *= leader->mimic->multiplier;
      leader = &robot_.joints[index(leader->mimic->joint)];
    }
    const auto column = std::find_if(columns.begin(), columns.end(),
                                     [&](const JointColumn& c) { return c.name == leader->name; });
    assert(column != columns.end());
    flat.drive = {static_cast<int32_t>(column - columns.begin()), static_cast<float>(multiplier),
                  static_cast<float>(offset)};
    if (flat.slides)
      flat.travel_m = std::max(std::abs(multiplier * leader->lower + offset),
                               std::abs(multiplier * leader->upper + offset));
  }

  void prune_to_outputs() {
    for (size_t i = nodes_.size(); i-- > 0;) {  // children are stored after their parents
      Node& node = nodes_[i];
      std::stable_sort(node.children.begin(), node.children.end(), [&](int a, int b) {
        return nodes_[index(a)].weight < nodes_[index(b)].weight;
      });
      for (const int child : node.children) node.weight += nodes_[index(child)].weight;
      if (node.weight == 0 && node.outputs.empty()) continue;
      node.weight += 1;
      if (i > 0)
        nodes_[index(robot_.joints[i - 1].parent_link)].children.push_back(static_cast<int>(i));
    }
  }

  void push(OpKind kind, int index, const Eigen::Vector3d& v = Eigen::Vector3d::Zero()) {
    Op op;
    op.kind = kind;
    op.index = index;
    for (int k = 0; k < 3; ++k) op.values[k] = static_cast<float>(v[k]);
    ops_.program.push_back(op);
  }

  /// Applies the accumulated constant part; returns the displacement of the origin.
  double flush(Eigen::Isometry3d& pending) {
    const double moved = flush_translation(pending);
    if (!pending.linear().isIdentity(kNegligible)) {
      Op op;
      op.kind = OpKind::kReorient;
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c)
          op.values[3 * r + c] = static_cast<float>(pending.linear()(r, c));
      ops_.program.push_back(op);
    }
    pending = Eigen::Isometry3d::Identity();
    return moved;
  }

  double flush_translation(Eigen::Isometry3d& pending) {
    const Eigen::Vector3d t = pending.translation();
    pending.translation().setZero();
    std::vector<int> along;
    for (int k = 0; k < 3; ++k)
      if (std::abs(t[k]) > kNegligible) along.push_back(k);
    constexpr OpKind kSingle[] = {OpKind::kMoveX, OpKind::kMoveY, OpKind::kMoveZ};
    if (along.size() == 1) push(kSingle[along[0]], 0, t);
    if (along.size() > 1) push(OpKind::kMove, 0, t);
    return t.norm();
  }

  /// Appends the ops of a subtree. `pending`: constant part between running pose and node frame.
  void visit(const Node& node, Eigen::Isometry3d pending, int slot, double reach) {
    if (!node.outputs.empty()) reach += flush(pending);
    for (const int output : node.outputs) {
      push(OpKind::kEmit, output);
      // Rounded up: float poses may deviate by a few units in the last place per joint.
      reach_m_[index(output)] = static_cast<float>(reach * (1 + 1e-5) + 1e-6);
    }
    if (node.children.size() > 1) {
      reach += flush(pending);
      push(OpKind::kSave, slot);
      assert(slot < kMaxSlots);
    }
    for (const int child : node.children) {
      if (child != node.children.front()) push(OpKind::kLoad, slot);
      const bool is_last = child == node.children.back();
      descend(nodes_[index(child)], pending, is_last ? slot : slot + 1, reach);
    }
  }

  void descend(const Node& child, Eigen::Isometry3d pending, int slot, double reach) {
    const FlatJoint& joint = child.joint;
    pending = pending * joint.before;
    if (joint.fixed) {
      visit(child, pending * joint.after, slot, reach);
    } else if (joint.slides) {
      reach += flush_translation(pending) + joint.travel_m;
      push(OpKind::kSlide, add(joint.drive, 1, ops_.travels), pending.linear() * joint.axis);
      visit(child, pending * joint.after, slot, reach);
    } else {
      const Eigen::Matrix3d turned = principal_frame(joint, pending.linear());
      pending.linear() = pending.linear() * turned;
      const Eigen::Vector3d axis = turned.transpose() * joint.axis;
      reach += flush(pending);
      const int k = principal(axis).value();
      constexpr OpKind kRotate[] = {OpKind::kRotateX, OpKind::kRotateY, OpKind::kRotateZ};
      push(kRotate[k], add(joint.drive, axis[k] < 0 ? -1 : 1, ops_.angles));
      pending.linear() = turned.transpose();
      visit(child, pending * joint.after, slot, reach);
    }
  }

  /// A rotation Q with joint(q) = Q rotate_k(q) Q^T and the fewest reorientations.
  static Eigen::Matrix3d principal_frame(const FlatJoint& joint, const Eigen::Matrix3d& pending) {
    if (principal(pending * joint.axis)) return pending.transpose();  // none before, merged after
    Eigen::Matrix3d after = joint.after.linear();
    if (principal(after.transpose() * joint.axis)) return after;  // one before, none after
    if (principal(joint.axis)) return Eigen::Matrix3d::Identity();
    int nearest = 0;
    joint.axis.cwiseAbs().maxCoeff(&nearest);
    return turn(Eigen::Vector3d::Unit(nearest), joint.axis.normalized()).toRotationMatrix();
  }

  static int add(Drive drive, float sign, std::vector<Drive>& to) {
    drive.multiplier *= sign;
    drive.offset *= sign;
    to.push_back(drive);
    return static_cast<int>(to.size()) - 1;
  }

  const Robot& robot_;
  FlatModel::Ops& ops_;
  std::vector<float>& reach_m_;
  std::vector<Node> nodes_;
};

std::vector<JointColumn> columns_of(const Robot& robot) {
  std::vector<JointColumn> columns;
  for (const Joint& joint : robot.joints)
    if (joint.kind != Joint::Kind::kFixed && !joint.mimic)
      columns.push_back({joint.name, joint.kind == Joint::Kind::kPrismatic,
                         static_cast<float>(joint.lower), static_cast<float>(joint.upper)});
  return columns;
}

}  // namespace

FlatModel::FlatModel(const Robot& robot, std::span<const int> output_links)
    : columns_(columns_of(robot)),
      output_count_(static_cast<int>(output_links.size())),
      ops_(std::make_unique<Ops>()) {
  const auto moving = std::count_if(robot.joints.begin(), robot.joints.end(),
                                    [](const Joint& j) { return j.kind != Joint::Kind::kFixed; });
  if (moving > kMaxDrives)
    throw InputError(robot.name, fmt::format("at most {} joints that move", kMaxDrives),
                     fmt::format("{}", moving));
  Flattener(robot, columns_, output_links, *ops_, reach_m_);
}

FlatModel::~FlatModel() = default;
FlatModel::FlatModel(FlatModel&&) noexcept = default;
FlatModel& FlatModel::operator=(FlatModel&&) noexcept = default;

int FlatModel::column_of(const std::string& joint_name) const {
  for (size_t i = 0; i < columns_.size(); ++i)
    if (columns_[i].name == joint_name) return static_cast<int>(i);
  return -1;
}

namespace {

void pose_rows(const FlatModel& model, const PostureRows& rows, std::span<const RootFrame> roots,
               std::span<PartPose> poses, SimdTarget target) {
  assert(poses.size() == roots.size() * static_cast<size_t>(model.output_count()));
  const SimdTarget chosen = resolved(target);
  if (chosen == SimdTarget::kScalar)
    forward_kinematics_scalar(model, rows, roots, poses);
  else
    forward_kinematics_simd(model, rows, roots, poses, chosen);
}

}  // namespace

void forward_kinematics(const FlatModel& model, std::span<const float> postures,
                        std::span<const RootFrame> roots, std::span<PartPose> poses,
                        SimdTarget target) {
  const auto columns = static_cast<size_t>(model.column_count());
  assert(postures.size() == roots.size() * columns);
  pose_rows(model, {postures.data(), columns, nullptr}, roots, poses, target);
}

void forward_kinematics(const FlatModel& model, std::span<const float* const> rows,
                        std::span<const RootFrame> roots, std::span<PartPose> poses,
                        SimdTarget target) {
  assert(rows.size() == roots.size());
  pose_rows(model, {nullptr, 0, rows.data()}, roots, poses, target);
}

}  // namespace throng
