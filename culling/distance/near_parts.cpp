#include "culling/distance/near_parts.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "culling/distance/contact_point.h"
#include "culling/distance/hull_distance.h"
#include "culling/distance/surface_distance.h"
#include "culling/fitted.h"

namespace throng {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using NearVolume = Ordop<26>;

/// Low corner, high corner.
struct Box {
  float low[3], high[3];
};

/// Squared gap of two boxes.
float gap2(const Box& a, const Box& b) {
  float sum = 0;
  for (size_t axis = 0; axis < 3; ++axis) {
    const float gap = std::max(a.low[axis] - b.high[axis], b.low[axis] - a.high[axis]);
    sum += gap > 0 ? gap * gap : 0;
  }
  return sum;
}

/// Rounding of a gap and of its square.
float widened2(float near_m) { return near_m * near_m * 1.00001f; }

Box body_box(const PosedBodies& posed, const PosedBody& body) {
  const float* box = posed.box_of(body);
  return {{box[0], box[1], box[2]}, {box[4], box[5], box[6]}};
}

/// The rows of a body's part boxes; see kernels.h.
struct PartBoxes {
  PartBoxes(const PosedBodies& posed, const PosedBody& body, size_t parts)
      : rows(posed.box_of(body) + kBoxLanes), stride(padded_parts(parts)) {}
  Box at(size_t part) const {
    return {{rows[part], rows[stride + part], rows[2 * stride + part]},
            {rows[3 * stride + part], rows[4 * stride + part], rows[5 * stride + part]}};
  }
  const float* rows;
  size_t stride;
};

Box moved(Box box, const Vector3f& by) {
  for (size_t axis = 0; axis < 3; ++axis) {
    box.low[axis] += by[static_cast<Eigen::Index>(axis)];
    box.high[axis] += by[static_cast<Eigen::Index>(axis)];
  }
  return box;
}

struct PartThere {
  const BodyType::Volumes& volumes;
  const PartPose& pose;
  float scale;
};

PartThere part_of(const NearFrame& frame, const PosedBody& body, size_t part) {
  return {frame.types[body.slot.type]->volumes(), frame.posed.poses()[body.pose + part],
          body.slot.scale};
}

/// Both bounds by the hulls, rounded outwards, doubles as well.
void narrow(const HullGap& gap, NearCandidate& candidate) {
  candidate.lo_m = std::max(candidate.lo_m, static_cast<float>(gap.lo_m * (1 - 1e-6) - 1e-7));
  candidate.hi_m = static_cast<float>(gap.corners_m * (1 + 1e-6) + 1e-7);
  Eigen::Map<Vector3f>(candidate.direction.data()) = gap.direction.cast<float>();
  Eigen::Map<Vector3f>(candidate.near_m.data()) = gap.points_m.on_a.cast<float>();
}

/// The points of a part that lie on it: all, or, where there are triangles, their corners.
std::vector<Vector3f> points_on(const PartShape& part) {
  if (part.triangles.empty()) return part.points;
  std::vector<char> is_corner(part.points.size(), 0);
  for (const Eigen::Vector3i& triangle : part.triangles)
    for (const int corner : triangle) is_corner[static_cast<size_t>(corner)] = 1;
  std::vector<Vector3f> out;
  for (size_t i = 0; i < part.points.size(); ++i)
    if (is_corner[i]) out.push_back(part.points[i]);
  return out;
}

}  // namespace

ConvexHull BodyType::Volumes::hull_of(const PartShape& part) { return ConvexHull(points_on(part)); }

void fit_for_near(const BodyType& type, bool exact) {
  type.volumes().tables();
  type.volumes().of<NearVolume>();
  type.volumes().hulls();
  if (exact) type.volumes().surfaces();
}

bool may_be_near(const NearFrame& frame, const NearBodies& bodies) {
  return gap2(body_box(frame.posed, *bodies.a),
              moved(body_box(frame.posed, *bodies.b), bodies.a_to_b_m)) <= widened2(frame.near_m);
}

void find_near_parts(const NearFrame& frame, const NearBodies& bodies,
                     GrowBuffer<NearCandidate>& out, size_t& count, NearCounters& counters) {
  const auto parts_of = [&](const PosedBody& body) {
    return static_cast<size_t>(frame.types[body.slot.type]->part_count());
  };
  const size_t parts_a = parts_of(*bodies.a), parts_b = parts_of(*bodies.b);
  const PartBoxes boxes_a(frame.posed, *bodies.a, parts_a),
      boxes_b(frame.posed, *bodies.b, parts_b);
  const Box all_b = moved(body_box(frame.posed, *bodies.b), bodies.a_to_b_m);
  const float most2 = widened2(frame.near_m);
  for (size_t part_a = 0; part_a < parts_a; ++part_a) {
    const Box box_a = boxes_a.at(part_a);
    if (gap2(box_a, all_b) > most2) continue;
    const Box seen_from_b = moved(box_a, -bodies.a_to_b_m);
    std::array<float, padded_parts(BodyType::kMaxParts)> gaps2;
    for (size_t part_b = 0; part_b < parts_b; ++part_b)
      gaps2[part_b] = gap2(seen_from_b, boxes_b.at(part_b));
    for (size_t part_b = 0; part_b < parts_b; ++part_b) {
      if (gaps2[part_b] > most2) continue;
      ++counters.volume_tests;
      const PartThere a = part_of(frame, *bodies.a, part_a), b = part_of(frame, *bodies.b, part_b);
      const ProvenGap gap = ordop_gap<26>(a.volumes.of<NearVolume>()[part_a], a.pose, a.scale,
                                          b.volumes.of<NearVolume>()[part_b], b.pose, b.scale,
                                          bodies.a_to_b_m, bodies.margin_m);
      if (gap.at_least_m > frame.near_m) continue;
      NearCandidate candidate{
          gap.at_least_m, 0, {}, {}, static_cast<uint8_t>(part_a), static_cast<uint8_t>(part_b)};
      narrow(hull_gap({&a.volumes.hulls()[part_a], &a.pose, a.scale},
                      {&b.volumes.hulls()[part_b], &b.pose, b.scale}, bodies.a_to_b_m,
                      gap.direction.cast<double>()),
             candidate);
      if (candidate.lo_m > frame.near_m) continue;
      out.grow(count + 1, count);
      out[count++] = candidate;
    }
  }
}

NearVerdict NearDecider::decide(const NearFrame& frame, const NearBodies& bodies,
                                const NearCandidate& candidate, double within_m,
                                NearCounters& counters) {
  ++counters.exact_tests;
  const PartThere a = part_of(frame, *bodies.a, candidate.part_a),
                  b = part_of(frame, *bodies.b, candidate.part_b);
  const PlacedSurface surface_a{&a.volumes.surfaces()[candidate.part_a], &a.pose, a.scale},
      surface_b{&b.volumes.surfaces()[candidate.part_b], &b.pose, b.scale};
  NearVerdict out;
  if (candidate.lo_m == 0 && solids_touch(*surface_a.surface, a.pose, a.scale, *surface_b.surface,
                                          b.pose, b.scale, bodies.a_to_b_m, counters.primitives)) {
    const Depth depth =
        depths_.depth({&a.volumes.hulls()[candidate.part_a], &a.pose, a.scale},
                      {&b.volumes.hulls()[candidate.part_b], &b.pose, b.scale}, bodies.a_to_b_m);
    out.is_near = true;
    // Nothing only if rounding has it otherwise here.
    const Vector3d nowhere = Vector3d::Constant(NearPair::kNowhere);
    out.on_a_m = out.on_b_m =
        contact_point(surface_a, surface_b, bodies.a_to_b_m, counters.primitives).value_or(nowhere);
    out.normal = depth.direction;
    out.depth_m = depth.depth_m;
    return out;
  }
  const Eigen::Vector3f direction(candidate.direction.data()), near_m(candidate.near_m.data());
  // They are not farther apart than two of their corners.
  const double most_m = std::min(within_m, static_cast<double>(candidate.hi_m));
  const std::optional<SurfaceGap> gap =
      surface_gap(surface_a, surface_b, bodies.a_to_b_m, most_m,
                  {direction.cast<double>().normalized(), static_cast<double>(candidate.lo_m),
                   near_m.cast<double>()},
                  counters.primitives);
  if (!gap) return out;
  out.is_near = true;
  out.hi_m = gap->hi_m;
  out.lo_m = gap->lo_m;
  out.on_a_m = gap->points_m.on_a;
  out.on_b_m = gap->points_m.on_b;
  const Vector3d between = out.on_b_m - out.on_a_m;
  out.normal = out.hi_m > 0 ? Vector3d(between / out.hi_m)
                            : Vector3d::Constant(static_cast<double>(NearPair::kUnknown));
  return out;
}

}  // namespace throng
