#include "python/posed_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/errors.h"

namespace throng {
namespace {

/// Tolerance for rotations that were computed in float.
constexpr double kSlack = 1e-3;

using Rows = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;

void require_rigid(const Rows& pose, size_t body, size_t part) {
  const std::string where = fmt::format("poses[{}, {}]", body, part);
  if (!pose.allFinite()) throw InputError(where, "finite numbers", "another one");
  for (const double place_m : {pose(0, 3), pose(1, 3), pose(2, 3)})
    if (std::abs(place_m) > kMaxPosition_m)
      throw InputError(where, fmt::format("a position within {:g} m of the origin", kMaxPosition_m),
                       fmt::format("{:g}", place_m));
  const Eigen::Matrix3d turn = pose.leftCols<3>();
  const double off = (turn * turn.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (off > kSlack || turn.determinant() < 0)
    throw InputError(
        where, "a rotation in the first three columns (the size of a body is its scale)",
        off > kSlack ? fmt::format("rows that deviate by {:.3g}", off) : "a reflection");
}

}  // namespace

PosedParts::PosedParts(const std::vector<std::shared_ptr<const BodyShape>>& shapes) {
  for (const auto& shape : shapes) {
    extents_.emplace_back();
    for (const PartShape& part : shape->parts) {
      Eigen::AlignedBox3f box;
      Extent extent;
      for (const Eigen::Vector3f& point : part.points) {
        box.extend(point);
        extent.radius_m = std::max(extent.radius_m, point.norm());
      }
      extent.centre_m = box.center();
      extent.half_m = box.sizes() / 2;
      extents_.back().push_back(extent);
    }
  }
}

void PosedParts::set(std::span<const double> matrices, size_t stride,
                     std::span<const uint16_t> types, std::span<const float> scales) {
  types_ = types;
  scales_ = scales;
  roots_.resize(types.size());
  first_.clear();
  reach_m_.assign(extents_.size(), 0);
  size_t parts = 0;
  for (const uint16_t type : types) {
    first_.push_back(parts);
    parts += extents_[type].size();
  }
  if (parts * stride != matrices.size())
    throw InputError("poses", fmt::format("{} matrices, one per part of each body", parts),
                     fmt::format("{}", matrices.size() / stride));
  poses_.resize(parts);
  for (size_t body = 0; body < types.size(); ++body)
    set_body(body, matrices.data() + first_[body] * stride, stride);
}

void PosedParts::set_body(size_t body, const double* matrices, size_t stride) {
  const std::vector<Extent>& extents = extents_[types_[body]];
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (size_t part = 0; part < extents.size(); ++part) {
    const Eigen::Map<const Rows> pose(matrices + part * stride);
    require_rigid(pose, body, part);
    middle += pose.col(3);
  }
  middle /= static_cast<double>(extents.size());
  roots_[body].position_m = middle;
  float& reach_m = reach_m_[types_[body]];
  for (size_t part = 0; part < extents.size(); ++part) {
    Rows pose = Eigen::Map<const Rows>(matrices + part * stride);
    pose.col(3) -= middle;
    PartPose& out = poses_[first_[body] + part];
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 4; ++c) out.rows[r][c] = static_cast<float>(pose(r, c));
    const auto from_root_m = static_cast<float>(pose.col(3).norm());
    reach_m = std::max(reach_m, from_root_m / scales_[body] + extents[part].radius_m);
  }
}

void PosedParts::poses(std::span<const uint32_t> bodies, std::span<PartPose> out) const {
  auto to = out.begin();
  for (const uint32_t body : bodies)
    to = std::copy_n(poses_.begin() + static_cast<std::ptrdiff_t>(first_[body]),
                     extents_[types_[body]].size(), to);
}

void PosedParts::bounds(std::span<const uint32_t> bodies, std::span<RootBox> out) const {
  constexpr float kRounding = 1e-5F;
  for (size_t i = 0; i < bodies.size(); ++i) {
    const uint32_t body = bodies[i];
    const std::vector<Extent>& extents = extents_[types_[body]];
    Eigen::AlignedBox3f box;
    for (size_t part = 0; part < extents.size(); ++part) {
      const Eigen::Map<const Eigen::Matrix<float, 3, 4, Eigen::RowMajor>> pose(
          &poses_[first_[body] + part].rows[0][0]);
      const Eigen::Matrix3f turn = pose.leftCols<3>();
      const Eigen::Vector3f centre = turn * (scales_[body] * extents[part].centre_m) + pose.col(3);
      const Eigen::Vector3f half = turn.cwiseAbs() * (scales_[body] * extents[part].half_m);
      box.extend(centre - half);
      box.extend(centre + half);
    }
    const float slack =
        kRounding * (1 + box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).maxCoeff());
    for (int axis = 0; axis < 3; ++axis) {
      out[i].min_m[axis] = box.min()[axis] - slack;
      out[i].max_m[axis] = box.max()[axis] + slack;
    }
  }
}

}  // namespace throng
