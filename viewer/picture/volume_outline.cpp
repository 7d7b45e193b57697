#include "viewer/picture/volume_outline.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <type_traits>

#include "avatars/mesh/primitives.h"
#include "culling/fitted.h"
#include "culling/volumes/polytope.h"
#include "culling/volumes/pose_math.h"

namespace throng {
namespace {

constexpr float kOpacity = 0.16F;
constexpr int kCircle = 48;  // edges of a great circle

/// Linear light; a darker version of Tol's "bright".
constexpr std::array<std::pair<std::string_view, std::array<float, 3>>, 6> kColours = {{
    {"sphere", {0.02F, 0.18F, 0.55F}},
    {"aabb", {0.60F, 0.20F, 0.02F}},
    {"obb", {0.05F, 0.35F, 0.08F}},
    {"kdop", {0.45F, 0.35F, 0.02F}},
    {"ordop", {0.50F, 0.02F, 0.30F}},
    {"body", {0.10F, 0.10F, 0.10F}},
}};

void add_face(VolumeOutline& out, std::span<const Eigen::Vector3f> corners) {
  const auto first = static_cast<int>(out.faces.vertices.size());
  out.faces.vertices.insert(out.faces.vertices.end(), corners.begin(), corners.end());
  for (int i = 2; i < static_cast<int>(corners.size()); ++i)
    out.faces.triangles.emplace_back(first, first + i - 1, first + i);
  for (size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector3f &p = corners[i], &q = corners[(i + 1) % corners.size()];
    // Two faces share each edge, in opposite directions.
    const auto is_first = [&] {
      for (int axis = 0; axis < 3; ++axis)
        if (p[axis] != q[axis]) return p[axis] < q[axis];
      return false;
    };
    if (is_first()) out.edges.emplace_back(p, q);
  }
}

/// `axes`: unit columns.
VolumeOutline box(const Eigen::Vector3f& centre, const Eigen::Vector3f& half,
                  const Eigen::Matrix3f& axes) {
  VolumeOutline out;
  const auto corner = [&](int i) -> Eigen::Vector3f {
    const Eigen::Vector3f sign((i & 1) ? 1.0F : -1.0F, (i & 2) ? 1.0F : -1.0F,
                               (i & 4) ? 1.0F : -1.0F);
    return centre + axes * sign.cwiseProduct(half);
  };
  constexpr int kFaces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (const auto& face : kFaces) {
    const std::array corners = {corner(face[0]), corner(face[1]), corner(face[2]), corner(face[3])};
    add_face(out, corners);
  }
  return out;
}

VolumeOutline slabs(const Slabs& placed, int k) {
  const Polytope solid = polytope_of(placed, k);
  VolumeOutline out;
  size_t begin = 0;
  for (const size_t end : solid.face_ends) {
    std::vector<Eigen::Vector3f> corners;
    for (size_t i = begin; i < end; ++i) corners.push_back(solid.corners_m[i].cast<float>());
    add_face(out, corners);
    begin = end;
  }
  return out;
}

VolumeOutline outline(const Sphere::Placed& sphere) {
  return sphere_outline(sphere.centre_m, sphere.radius_m);
}
VolumeOutline outline(const Aabb::Placed& aabb) {
  return box(aabb.centre_m, aabb.half_m, Eigen::Matrix3f::Identity());
}
VolumeOutline outline(const Obb::Placed& obb) { return box(obb.centre_m, obb.half_m, obb.axes); }

template <typename V>
constexpr int kDirectionsOf = 0;
template <int K>
constexpr int kDirectionsOf<Kdop<K>> = K;
template <int K>
constexpr int kDirectionsOf<Ordop<K>> = K;

void turn(VolumeOutline& out, const PartPose& pose, float scale) {
  const auto place = [&](Eigen::Vector3f& p) { p = placed_point(pose, scale, p); };
  for (Eigen::Vector3f& p : out.faces.vertices) place(p);
  for (auto& [p, q] : out.edges) {
    place(p);
    place(q);
  }
}

}  // namespace

VolumeOutline outline_of(VolumeKind kind, const BodyType& type, size_t part, const PartPose& pose,
                         float scale) {
  VolumeOutline out;
  with_volume(kind, [&]<typename V>() {
    const typename V::Fitted& fitted = type.volumes().of<V>()[part];
    const typename V::Placed placed = V::place(fitted, pose, scale);
    if constexpr (requires { outline(placed); }) {
      out = outline(placed);
    } else if constexpr (std::is_same_v<typename V::Placed, Slabs>) {
      out = slabs(placed, kDirectionsOf<V>);
    } else if constexpr (kDirectionsOf<V> > 0) {
      out = slabs(fitted, kDirectionsOf<V>);
      turn(out, pose, scale);
    }
  });
  return out;
}

VolumeOutline sphere_outline(const Eigen::Vector3f& centre_m, float radius_m) {
  VolumeOutline out;
  out.faces = sphere_mesh(static_cast<double>(radius_m));
  for (Eigen::Vector3f& p : out.faces.vertices) p = centre_m + radius_m * p.normalized();
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 0; i < kCircle; ++i) {
      const auto at = [&](int step) {
        const auto angle = static_cast<float>(2 * std::numbers::pi * step / kCircle);
        Eigen::Vector3f p = centre_m;
        p[(axis + 1) % 3] += radius_m * std::cos(angle);
        p[(axis + 2) % 3] += radius_m * std::sin(angle);
        return p;
      };
      out.edges.emplace_back(at(i), at(i + 1));
    }
  return out;
}

VolumeOutline box_outline(const Eigen::Vector3f& low_m, const Eigen::Vector3f& high_m) {
  return box(0.5F * (low_m + high_m), 0.5F * (high_m - low_m), Eigen::Matrix3f::Identity());
}

Mesh bars_of(const VolumeOutline& outline, float thickness_m) {
  Mesh out;
  const Mesh unit = box_mesh(Eigen::Vector3d::Ones());
  for (const auto& [p, q] : outline.edges) {
    const Eigen::Vector3f along = q - p;
    const float length = along.norm();
    if (length < 1e-6F) continue;
    const Eigen::Quaternionf turned =
        Eigen::Quaternionf::FromTwoVectors(Eigen::Vector3f::UnitX(), along);
    const auto first = static_cast<int>(out.vertices.size());
    const Eigen::Vector3f size(length + thickness_m, thickness_m, thickness_m);
    for (const Eigen::Vector3f& v : unit.vertices)
      out.vertices.push_back(0.5F * (p + q) + turned * v.cwiseProduct(size));
    for (const Eigen::Vector3i& t : unit.triangles)
      out.triangles.push_back(t + Eigen::Vector3i::Constant(first));
  }
  return out;
}

Eigen::Vector3f volume_rgb(std::string_view name) {
  for (const auto& [begin, rgb] : kColours)
    if (name.starts_with(begin)) return {rgb[0], rgb[1], rgb[2]};
  const auto& rgb = kColours.back().second;
  return {rgb[0], rgb[1], rgb[2]};
}

void VolumeItems::add(const VolumeOutline& outline, const Eigen::Vector3f& root_m,
                      const Eigen::Vector3f& rgb, float thickness_m) {
  if (outline.faces.vertices.empty()) return;
  pieces_.push_back({shape_of(outline.faces), root_m, rgb, kOpacity});
  pieces_.push_back({shape_of(bars_of(outline, thickness_m)), root_m, rgb, 1});
}

void VolumeItems::append_to(std::vector<RenderItem>& items) const {
  for (const Piece& piece : pieces_) {
    RenderItem item{&piece.shape};
    item.world_from_shape.translation() = piece.root_m;
    item.rgb = piece.rgb;
    item.opacity = piece.opacity;
    items.push_back(item);
  }
}

}  // namespace throng
