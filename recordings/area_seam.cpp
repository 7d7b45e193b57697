#include "recordings/area_seam.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace throng {
namespace {

/// What closes a gap reaches so far into the polygons where it does not end in their corners.
constexpr double kOverlap_m = 3 * kAreaUnit_m;
/// Edges of a gap are antiparallel within 20 degrees, the cosine.
constexpr double kFacing = -0.94;

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// The part of an edge that a seam takes.
struct SeamEnd {
  Eigen::Vector2d point;
  bool is_corner = false;
};

}  // namespace

double AreaEdge::distance_m(const Eigen::Vector2d& p) const {
  const Eigen::Vector2d along = to - from;
  const double square = along.squaredNorm();
  const double t = square > 0 ? std::clamp((p - from).dot(along) / square, 0.0, 1.0) : 0.0;
  return (p - from - t * along).norm();
}

double AreaEdge::distance_m(const AreaEdge& other) const {
  const auto side = [](const AreaEdge& edge, const Eigen::Vector2d& p) {
    return cross(edge.to - edge.from, p - edge.from);
  };
  if (side(*this, other.from) * side(*this, other.to) < 0 &&
      side(other, from) * side(other, to) < 0)
    return 0;
  return std::min(
      {distance_m(other.from), distance_m(other.to), other.distance_m(from), other.distance_m(to)});
}

std::optional<Seam> seam_between(const AreaEdge& a, const AreaEdge& b) {
  const Eigen::Vector2d along_a = (a.to - a.from).normalized();
  const Eigen::Vector2d along_b = (b.from - b.to).normalized();
  if (!(-along_a.dot(along_b) < kFacing)) return std::nullopt;
  const Eigen::Vector2d along = (along_a + along_b).normalized(), out(along.y(), -along.x());
  const auto at = [&](const Eigen::Vector2d& from, const Eigen::Vector2d& to, double s) {
    const double first = from.dot(along), last = to.dot(along);
    return Eigen::Vector2d(from + (s - first) / (last - first) * (to - from));
  };
  const auto on_a = [&](double s) { return at(a.from, a.to, s); };
  const auto on_b = [&](double s) { return at(b.to, b.from, s); };
  const auto width = [&](double s) { return (on_b(s) - on_a(s)).dot(out); };
  const double begin = std::max(a.from.dot(along), b.to.dot(along));
  const double end = std::min(a.to.dot(along), b.from.dot(along));
  if (!(end - begin > kAreaUnit_m)) return std::nullopt;
  // The width is linear: of the overlap the part remains where it is that of a gap.
  double low = begin, high = end;
  const double at_begin = width(begin), at_end = width(end);
  const auto keep = [&](double over_begin, double over_end) {
    if (over_begin > 0 && over_end > 0) high = low;
    if (over_begin > 0 && over_end <= 0)
      low = std::max(low, begin + over_begin / (over_begin - over_end) * (end - begin));
    if (over_begin <= 0 && over_end > 0)
      high = std::min(high, begin + over_begin / (over_begin - over_end) * (end - begin));
  };
  const double most_m = kMaxAreaGap_m + kAreaRounding_m;
  keep(at_begin - most_m, at_end - most_m);
  keep(-kOffGrid_m - at_begin, -kOffGrid_m - at_end);
  if (!(high - low > kAreaUnit_m)) return std::nullopt;
  // Corners that face each other belong together, also where the gap is cut off slantwise.
  const auto ends = [&](double s, bool is_limit, const Eigen::Vector2d& corner_a,
                        const Eigen::Vector2d& corner_b) {
    if (is_limit && (corner_a - corner_b).norm() <= most_m)
      return std::pair(SeamEnd{corner_a, true}, SeamEnd{corner_b, true});
    const auto is_at = [&](const Eigen::Vector2d& corner) {
      return is_limit && std::abs(corner.dot(along) - s) <= 1e-9;
    };
    return std::pair(is_at(corner_a) ? SeamEnd{corner_a, true} : SeamEnd{on_a(s), false},
                     is_at(corner_b) ? SeamEnd{corner_b, true} : SeamEnd{on_b(s), false});
  };
  const auto [a_low, b_low] = ends(low, low == begin, a.from, b.to);
  const auto [a_high, b_high] = ends(high, high == end, a.to, b.from);
  const auto moved = [&](const SeamEnd& seam_end, double sign) -> Eigen::Vector2d {
    return seam_end.is_corner ? seam_end.point : seam_end.point + sign * kOverlap_m * out;
  };
  Seam seam;
  seam.filling = {moved(a_low, -1), moved(b_low, 1), moved(b_high, 1), moved(a_high, -1)};
  seam.width_m = std::max(width(low), width(high));
  seam.length_m = high - low;
  seam.middle_m = 0.5 * (on_a(0.5 * (low + high)) + on_b(0.5 * (low + high)));
  return seam;
}

}  // namespace throng
