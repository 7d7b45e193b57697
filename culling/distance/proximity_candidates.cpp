#include "culling/distance/proximity_candidates.h"

#include <algorithm>
#include <limits>
#include <optional>

#include "culling/distance/hull_depth.h"
#include "culling/distance/surface_distance.h"
#include "culling/fitted.h"
#include "culling/kernels/kernels.h"

namespace throng {
namespace {

using Eigen::Vector3d;

/// Bounds found in double precision are rounded outwards by the float rounding of their frames.
constexpr double kShare = 1e-6, kRounding_m = 1e-7;

PlacedHull hull_of(const PartRef& part) {
  return {&part.volumes->hulls()[part.part], part.pose, part.scale};
}
PlacedSurface surface_of(const PartRef& part) {
  return {&part.volumes->surfaces()[part.part], &part.volumes->hulls()[part.part], part.pose,
          part.scale};
}

/// Vector from the middle of part a to that of part b, as initial direction.
Vector3d middle_to_middle(const PartPair& pair) {
  const auto middle = [](const PartRef& part) -> Vector3d {
    const Eigen::Vector3f origin(part.volumes->tables()[part.part].origin);
    return to_isometry(*part.pose) * (static_cast<double>(part.scale) * origin.cast<double>());
  };
  const Vector3d between = pair.a_to_b_m.cast<double>() + middle(pair.b) - middle(pair.a);
  const double length = between.norm();
  return length > 0 ? Vector3d(between / length) : Vector3d::UnitX();
}

HullGap gap_of_hulls(const PartPair& pair) {
  return hull_gap(hull_of(pair.a), hull_of(pair.b), pair.a_to_b_m, middle_to_middle(pair));
}

double lo_m(const HullGap& gap) { return gap.lo_m * (1 - kShare) - kRounding_m; }
double hi_m(const HullGap& gap) { return gap.corner_distance_m * (1 + kShare) + kRounding_m; }

/// Distance of parts that do not touch, within the known bounds; independent of the margin.
std::optional<SurfaceGap> gap_of_surfaces(const PartPair& pair, const ProximityCandidate& candidate,
                                          const HullGap& hulls, ProximityCounters& counters) {
  const double known_m = std::max({0.0, static_cast<double>(candidate.lo_m), lo_m(hulls)});
  return surface_gap(surface_of(pair.a), surface_of(pair.b), pair.a_to_b_m,
                     std::min(static_cast<double>(candidate.hi_m), hi_m(hulls)),
                     {hulls.direction, known_m, hulls.points_m.on_a}, counters.primitives);
}

bool touches(const PartPair& pair, TouchState known, ProximityCounters& counters) {
  if (known != TouchState::kUntested) return known == TouchState::kYes;
  return parts_touch(pair, counters.primitives);
}

}  // namespace

std::vector<Eigen::Vector3f> BodyType::Volumes::points_on(const PartShape& part) {
  if (part.triangles.empty()) return part.points;
  std::vector<char> is_corner(part.points.size(), 0);
  for (const Eigen::Vector3i& triangle : part.triangles)
    for (const int corner : triangle) is_corner[static_cast<size_t>(corner)] = 1;
  std::vector<Eigen::Vector3f> out;
  for (size_t i = 0; i < part.points.size(); ++i)
    if (is_corner[i]) out.push_back(part.points[i]);
  return out;
}

void fit_for_proximity(const BodyType& type) {
  type.volumes().tables();
  type.volumes().nearby_points();
  type.volumes().hulls();
  if (type.has_triangles()) type.volumes().surfaces();
}

void ProximityCandidates::begin(const MidPhaseFrame& frame, const PosedBodies& bodies,
                                float margin_m) {
  bodies_ = &bodies;
  margin_m_ = std::max(margin_m, kMinGap_m);
  parts_.begin(frame, bodies, margin_m);
}

void ProximityCandidates::find_bounds(const MidPhaseFrame& frame) {
  constexpr float kFar_m = std::numeric_limits<float>::infinity();
  const size_t count = parts_.candidates().size();
  bounds_.resize(count);
  overlaps_.resize(count);
  std::fill_n(bounds_.data(), count, GapBounds{kFar_m, kFar_m});
  std::fill_n(overlaps_.data(), count, uint8_t{0});
  parts_.for_each_bucket(
      [&](size_t a, size_t b, std::span<uint32_t> bucket) {
        const ShapePart part_a = shape_part(frame, a), part_b = shape_part(frame, b);
        frame.kernels->ordop_gaps(part_a.table(), part_b.table(), part_a.nearby_points(),
                                  part_b.nearby_points(), pairs().data(), bodies_->poses(),
                                  candidates().data(), bucket.data(), bucket.size(), margin_m_,
                                  bounds_.data(), overlaps_.data());
      },
      [&](uint32_t one) {  // shapes without buckets are rare
        const Candidate& c = candidates()[one];
        const auto &a = frame.types[pairs()[c.pair].type_a]->volumes(),
                   &b = frame.types[pairs()[c.pair].type_b]->volumes();
        scalar_kernels().ordop_gaps(a.tables()[c.part_a], b.tables()[c.part_b],
                                    a.nearby_points()[c.part_a], b.nearby_points()[c.part_b],
                                    pairs().data(), bodies_->poses(), candidates().data(), &one, 1,
                                    margin_m_, bounds_.data(), overlaps_.data());
      });
}

void ProximityCandidates::reserve_like(const ProximityCandidates& other) {
  parts_.reserve_like(other.parts_);
  bounds_.match(other.bounds_);
  overlaps_.match(other.overlaps_);
}

void tighten_by_hulls(const PartPair& pair, ProximityCandidate& candidate) {
  const HullGap gap = gap_of_hulls(pair);
  candidate.lo_m = std::max(candidate.lo_m, static_cast<float>(lo_m(gap)));
  candidate.hi_m = std::min(candidate.hi_m, static_cast<float>(hi_m(gap)));
}

void tighten_by_triangles(const PartPair& pair, ProximityCandidate& candidate,
                          ProximityCounters& counters) {
  const HullGap hulls = gap_of_hulls(pair);
  const double known_m = std::max(static_cast<double>(candidate.lo_m), lo_m(hulls));
  if (known_m <= 0 && touches(pair, candidate.touch, counters)) {
    candidate.lo_m = candidate.hi_m = 0;
    return;
  }
  const std::optional<SurfaceGap> gap = gap_of_surfaces(pair, candidate, hulls, counters);
  if (!gap) return;
  candidate.lo_m = std::max(candidate.lo_m, rounded_down(gap->lo_m));
  candidate.hi_m = std::min(candidate.hi_m, rounded_up(gap->hi_m));
}

DistanceResult TriangleQuery::decide(const PartPair& pair, const ProximityCandidate& candidate,
                                     double within_m, ProximityCounters& counters) {
  ++counters.triangle_queries;
  if (candidate.touch == TouchState::kYes) return touching(pair, counters);
  const HullGap hulls = gap_of_hulls(pair);
  const double known_m = std::max(static_cast<double>(candidate.lo_m), lo_m(hulls));
  if (known_m > within_m) return {};
  if (known_m <= 0 && touches(pair, candidate.touch, counters)) return touching(pair, counters);
  const std::optional<SurfaceGap> gap = gap_of_surfaces(pair, candidate, hulls, counters);
  if (!gap || gap->lo_m > within_m) return {};
  DistanceResult out{true,
                     false,
                     gap->lo_m,
                     gap->hi_m,
                     gap->points_m.on_a,
                     gap->points_m.on_b,
                     Vector3d::Constant(ProximityPair::kNoPosition)};
  if (out.hi_m > 0) out.normal = (out.on_b_m - out.on_a_m) / out.hi_m;
  return out;
}

DistanceResult TriangleQuery::decide_touch(const PartPair& pair, TouchState known,
                                           ProximityCounters& counters) {
  ++counters.triangle_queries;
  return touches(pair, known, counters) ? touching(pair, counters) : DistanceResult();
}

DistanceResult TriangleQuery::touching(const PartPair& pair, ProximityCounters& counters) {
  const Depth depth = depths_.depth(hull_of(pair.a), hull_of(pair.b), pair.a_to_b_m);
  // Null only if rounding has a different result here.
  const Vector3d point =
      contact_point(surface_of(pair.a), surface_of(pair.b), pair.a_to_b_m,
                    0.5 * (depth.points_m.on_a + depth.points_m.on_b), counters.primitives)
          .value_or(Vector3d::Constant(ProximityPair::kNoPosition));
  return {true, true, 0, 0, point, point, depth.direction, depth.depth_m};
}

}  // namespace throng
