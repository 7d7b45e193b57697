#include "bench/workbench/random_pairs.h"

#include <algorithm>
#include <array>

#include "avatars/avatars.h"
#include "culling/triangles/triangle_test.h"

namespace throng::bench {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kSpacing_m = 12;     // between pairs of bodies: far beyond any body's reach
constexpr double kPartReach_m = 0.3;  // maximum distance of a part's frame from its root, per axis
constexpr double kMinScale = 0.8, kLargestScale = 1.25;
constexpr double kMargin_m = 0.01;
constexpr size_t kBrute = size_t{16} * 16;  // maximum of triangle pairs tested in double

PartShape shape_of(const Solid& solid) { return {solid.points, solid.triangles}; }

PartShape plate(const Vector3d& along, const Vector3d& across) {
  PartShape out;
  const Vector3d corners[] = {-along - across, along - across, along + across, across - along};
  for (const Vector3d& corner : corners) out.points.push_back(corner.cast<float>());
  out.triangles = {{0, 1, 2}, {0, 2, 3}};
  return out;
}

/// Draws a part of a family; `large` applies to the first of two types where sizes matter.
PartShape random_part(Family family, Draw& draw, bool large) {
  const auto size = [&](double low, double high) {
    return Vector3d(draw.uniform(low, high), draw.uniform(low, high), draw.uniform(low, high));
  };
  const auto blob = [&](double low, double high) {
    return draw.integer(0, 1) == 0 ? shape_of(box_solid(size(low, high), 0.05 * draw.direction()))
                                   : shape_of(bumpy_ellipsoid(draw, 3, 4, size(low, high), 0.2));
  };
  switch (family) {
    case Family::kFlat:
      if (draw.integer(0, 2) == 0) return blob(0.03, 0.2);
      return draw.integer(0, 1) == 0
                 ? plate({draw.uniform(0.02, 0.3), 0, 0}, {0, draw.uniform(0.02, 0.3), 0})
                 : plate(draw.uniform(0.02, 0.3) * draw.direction(), 0.2 * draw.direction());
    case Family::kNeedle: {
      if (draw.integer(0, 2) == 0) return blob(0.03, 0.2);
      const double thin = std::pow(10.0, draw.uniform(-7, -4));
      return shape_of(box_solid({thin, thin, draw.uniform(0.2, 0.5)}));
    }
    case Family::kPoint: {
      if (draw.integer(0, 2) == 0) return blob(0.03, 0.2);
      PartShape out;
      const Vector3f here = draw.in_box(0.1).cast<float>();
      const Vector3f there = draw.in_box(0.3).cast<float>();
      out.points = {here, draw.integer(0, 1) == 0 ? here : there, here};
      out.triangles.emplace_back(0, 1, 2);
      return out;
    }
    case Family::kNested:
      return large ? shape_of(box_solid(size(0.3, 0.5))) : blob(0.01, 0.08);
    case Family::kTouching:
      // Sizes that are exact in binary: faces meet exactly.
      if (draw.integer(0, 3) == 0) return plate({0.25, 0, 0}, {0, 0.25, 0.125});
      return shape_of(box_solid(
          {draw.integer(1, 8) / 32.0, draw.integer(1, 8) / 32.0, draw.integer(1, 8) / 32.0}));
    case Family::kFar:
      return draw.integer(0, 3) == 0 ? plate({0.2, 0, 0}, {0, 0.2, 0.1}) : blob(0.03, 0.2);
    default:
      return blob(0.03, 0.25);
  }
}

BodyKind kind_of(std::vector<PartShape> shapes, std::vector<MixedPart> mixed = {}) {
  BodyKind kind;
  kind.mixed = std::move(mixed);
  double reach = 0;
  for (const PartShape& shape : shapes) {
    kind.trees.emplace_back(shape.points, shape.triangles);
    reach = std::max(reach, reach_of(shape.points));
  }
  // Scales apply to the sphere and the points, but not to the poses. The rest covers rounding.
  const double radius = 1.001 * (reach + kPartReach_m * std::sqrt(3.0) / kMinScale) + 0.001;
  kind.type = std::make_shared<BodyType>(
      std::move(shapes), RootSphere{Vector3f::Zero(), static_cast<float>(radius)}, false);
  return kind;
}

std::vector<Triangle> triangles_of(const PartShape& shape, const PartPose& pose, float scale,
                                   const Vector3d& shift) {
  std::vector<Vector3d> points;
  for (const Vector3f& point : shape.points)
    points.push_back(placed_exactly(pose, scale, point) + shift);
  std::vector<Triangle> out;
  for (const Eigen::Vector3i& t : shape.triangles)
    out.push_back({{points[static_cast<size_t>(t[0])], points[static_cast<size_t>(t[1])],
                    points[static_cast<size_t>(t[2])]}});
  return out;
}

/// False proves that the triangles are apart: comparisons only, without rounding.
bool boxes_meet(const Triangle& p, const Triangle& q) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto low = [axis](const Triangle& t) {
      return std::min({t.corner[0][axis], t.corner[1][axis], t.corner[2][axis]});
    };
    const auto high = [axis](const Triangle& t) {
      return std::max({t.corner[0][axis], t.corner[1][axis], t.corner[2][axis]});
    };
    if (low(p) > high(q) || low(q) > high(p)) return false;
  }
  return true;
}

/// Tests whether a piece of one part lies in a solid of the other, or two triangles touch.
bool mixed_touch(const RandomPairs& world, uint32_t a, size_t i, uint32_t b, size_t j) {
  const PartPose &pose_a = world.parts_of(a)[i], &pose_b = world.parts_of(b)[j];
  // Rounded as in the culling pass, because here triangles decide without a margin.
  const Vector3d a_to_b = (world.root(b) - world.root(a)).cast<float>().cast<double>();
  const std::vector<Triangle> of_a =
      triangles_of(world.kind(a).type->parts()[i], pose_a, world.scale(a), Vector3d::Zero());
  for (const Triangle& q :
       triangles_of(world.kind(b).type->parts()[j], pose_b, world.scale(b), a_to_b))
    for (const Triangle& p : of_a)
      if (boxes_meet(p, q) && triangles_touch(p, q)) return true;
  const auto holds = [&](uint32_t outer, size_t part, uint32_t inner, size_t inner_part,
                         const Vector3d& shift) {
    const PartPose& pose = world.parts_of(outer)[part];
    const MixedPart& pieces = world.kind(inner).mixed[inner_part];
    for (const auto* some : {&pieces.solids, &pieces.loose})
      for (const Solid& piece : *some) {
        const Vector3d p = shift + placed_exactly(world.parts_of(inner)[inner_part],
                                                  world.scale(inner), piece.points[0]);
        const Eigen::Isometry3d frame = to_isometry(pose);
        if (world.kind(outer).mixed[part].contains(frame.linear().inverse() *
                                                   (p - frame.translation()) /
                                                   static_cast<double>(world.scale(outer))))
          return true;
      }
    return false;
  };
  return holds(a, i, b, j, a_to_b) || holds(b, j, a, i, -a_to_b);
}

}  // namespace

std::string_view name_of(Family family) {
  constexpr std::array<std::string_view, 9> kNames = {
      "blobs", "adult", "flat", "needle", "point", "nested", "far", "touching", "mixed"};
  return kNames[static_cast<size_t>(family)];
}

std::vector<BodyKind> kinds_of(Family family, Draw& draw) {
  std::vector<BodyKind> kinds;
  if (family == Family::kAdult) {
    const std::shared_ptr<const Model> adult = load_model(adult_urdf());
    for (size_t first = 0; first < adult->parts.size(); first += 4) {
      std::vector<PartShape> shapes;
      for (size_t i = first; i < std::min(first + 4, adult->parts.size()); ++i)
        shapes.push_back({adult->parts[i].mesh.vertices, adult->parts[i].mesh.triangles});
      kinds.push_back(kind_of(std::move(shapes)));
    }
    return kinds;
  }
  for (int k = 0; k < 8; ++k) {
    std::vector<PartShape> shapes;
    if (family == Family::kMixed) {
      std::vector<MixedPart> mixed;
      for (int part = 0; part < 4; ++part) {
        mixed.push_back(mixed_part(draw, k % 2 == 0 ? 0.25 : 0.05, k % 2 == 1));
        shapes.push_back(shape_of(mixed.back().mesh));
      }
      kinds.push_back(kind_of(std::move(shapes), std::move(mixed)));
      continue;
    }
    for (int part = 0; part < 4; ++part) shapes.push_back(random_part(family, draw, k % 2 == 0));
    kinds.push_back(kind_of(std::move(shapes)));
  }
  return kinds;
}

bool PartBox::is_within_margin(const PartBox& a, const PartBox& b, const Vector3d& a_to_b_m) {
  const Vector3d gap = (b.low + a_to_b_m - a.high).cwiseMax(a.low - b.high - a_to_b_m);
  return gap.maxCoeff() <= kMargin_m;
}

RandomPairs::RandomPairs(Family family, const std::vector<BodyKind>& kinds, Draw& draw)
    : kinds_(kinds) {
  for (int pair = 0; pair < kPairs; ++pair) {
    const double far = family != Family::kFar ? 0 : draw.integer(0, 1) == 0 ? 1e4 : 1e5;
    const int column = pair % 16, row = pair / 16;
    const Vector3d home(far + kSpacing_m * column, -far + kSpacing_m * row, 0);
    const bool is_nested = family == Family::kNested || family == Family::kMixed;
    const bool is_lattice = family == Family::kTouching;
    add(draw, home, is_nested ? 0 : draw.integer(0, 1), is_lattice);
    add(draw, home, 1, is_lattice);
    meet(draw, family);
  }
}

void RandomPairs::poses(std::span<const uint32_t> bodies, std::span<PartPose> out) const {
  size_t next = 0;
  for (const uint32_t body : bodies)
    for (const PartPose& pose : parts_of(body)) out[next++] = pose;
}

PartBox RandomPairs::box(uint32_t body, size_t part) const {
  PartBox box{Vector3d::Constant(1e30), Vector3d::Constant(-1e30)};
  for (const Vector3f& point : kind(body).type->parts()[part].points) {
    const Vector3d p = placed_exactly(parts_of(body)[part], scales_[body], point);
    box.low = box.low.cwiseMin(p);
    box.high = box.high.cwiseMax(p);
  }
  return box;
}

void RandomPairs::add(Draw& draw, const Vector3d& where, int parity, bool is_lattice) {
  ids_.push_back(static_cast<uint32_t>(ids_.size()));
  const int half = static_cast<int>(kinds_.size()) / 2;
  types_.push_back(static_cast<uint16_t>(2 * draw.integer(0, half - 1) + parity));
  scales_.push_back(is_lattice ? 1.0f : static_cast<float>(draw.uniform(kMinScale, kLargestScale)));
  roots_.push_back({where, draw.rotation().cast<float>()});
  first_.push_back(poses_.size());
  for (int part = 0; part < kinds_[types_.back()].type->part_count(); ++part) {
    if (!is_lattice) {
      poses_.push_back(draw.pose(kPartReach_m));
      continue;
    }
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    for (int axis = 0; axis < 3; ++axis) pose.translation()[axis] = draw.integer(-8, 8) / 32.0;
    poses_.push_back(to_part_pose(pose));
  }
}

/// Moves the last body to meet the previous one.
void RandomPairs::meet(Draw& draw, Family family) {
  const uint32_t a = ids_.back() - 1, b = ids_.back();
  const auto corner = [&](uint32_t body) {
    const auto& parts = kind(body).type->parts();
    const size_t part = static_cast<size_t>(draw.integer(0, static_cast<int>(parts.size()) - 1));
    const auto& points = parts[part].points;
    const auto i = static_cast<size_t>(draw.integer(0, static_cast<int>(points.size()) - 1));
    return placed_exactly(parts_of(body)[part], scales_[body], points[i]);
  };
  Vector3d offset = corner(a) - corner(b);
  if (family == Family::kNested || (family == Family::kMixed && draw.integer(0, 1) == 0))
    offset = to_isometry(parts_of(a)[0]).translation() - to_isometry(parts_of(b)[0]).translation() +
             draw.in_box(0.2);
  else if (family != Family::kTouching)
    offset += draw.uniform(-0.02, 0.04) * draw.direction();
  roots_[b].position_m += offset;
}

bool RandomPairs::touch(uint32_t a, size_t i, uint32_t b, size_t j) const {
  if (!kind(a).mixed.empty()) return mixed_touch(*this, a, i, b, j);
  const PartShape& shape_a = kind(a).type->parts()[i];
  const PartShape& shape_b = kind(b).type->parts()[j];
  const PartPose &pose_a = parts_of(a)[i], &pose_b = parts_of(b)[j];
  const Vector3d a_to_b = root(b) - root(a);
  if (shape_a.triangles.size() * shape_b.triangles.size() <= kBrute) {
    const std::vector<Triangle> of_a = triangles_of(shape_a, pose_a, scale(a), Vector3d::Zero());
    for (const Triangle& q : triangles_of(shape_b, pose_b, scale(b), a_to_b))
      for (const Triangle& p : of_a)
        if (boxes_meet(p, q) && triangles_touch(p, q)) return true;
  }
  TriangleCounters counters;
  return solids_touch(kind(a).trees[i], pose_a, scale(a), kind(b).trees[j], pose_b, scale(b),
                      a_to_b.cast<float>(), counters);
}

}  // namespace throng::bench
