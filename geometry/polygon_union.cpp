#include "geometry/polygon_union.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <boost/geometry/geometries/box.hpp>
#include <boost/geometry/geometries/point.hpp>
#include <boost/geometry/index/rtree.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <optional>
#include <set>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "base/errors.h"
#include "geometry/polygon.h"
#include "geometry/polygon_grid.h"

namespace throng {

// AreaEdge is an edge of an area; Seam is the strip between two edges that face each other.

inline constexpr double kMaxAreaGap_m = 1e-3;
/// Files print coordinates to 0.1 mm: a gap of 1 mm may appear this much wider.
inline constexpr double kAreaRounding_m = 0.9e-4;
/// Corners lie within 0.07 mm of the grid, two edges of one line within twice that.
inline constexpr double kOffGrid_m = 1.5 * kAreaUnit_m;

/// Edge between consecutive corners of a ring, with the walkable side on the left.
struct AreaEdge {
  Eigen::Vector2d from, to;
  uint32_t polygon = 0;
  bool may_slit = false;  ///< the ring is wider than a gap

  double distance_m(const Eigen::Vector2d& p) const;
  double distance_m(const AreaEdge& other) const;
};

/// Strip between two edges that face each other across a gap or share a line.
struct Seam {
  Polygon::Ring filling;
  double width_m = 0, length_m = 0;
  Eigen::Vector2d middle_m = Eigen::Vector2d::Zero();
};

std::optional<Seam> seam_between(const AreaEdge& a, const AreaEdge& b);

namespace {

namespace bg = boost::geometry;
using BoxPoint = bg::model::point<double, 2, bg::cs::cartesian>;
using Box = bg::model::box<BoxPoint>;
using BoxTree = bg::index::rtree<std::pair<Box, uint32_t>, bg::index::quadratic<16>>;

/// Maximum number of edge pairs of different polygons with overlapping boxes, counted twice; a
/// union with this many takes 5 s.
constexpr size_t kMaxPairs = 500'000;
/// Maximum number of edge pairs with overlapping boxes; this many take 1 s.
constexpr size_t kMaxVisits = 5'000'000;
/// Edges that differ by less are one line.
constexpr double kNoWidth_m = 1e-6;
/// Files with millimetres print the ends of a cut up to this far from its line.
constexpr double kStraight_m = 1e-3;
Box box_of(Eigen::Vector2d low, Eigen::Vector2d high, double margin_m) {
  low.array() -= margin_m;
  high.array() += margin_m;
  return {BoxPoint(low.x(), low.y()), BoxPoint(high.x(), high.y())};
}

Box box_of(const AreaEdge& edge) {
  return box_of(edge.from.cwiseMin(edge.to), edge.from.cwiseMax(edge.to),
                kMaxAreaGap_m + kAreaRounding_m);
}

Box box_of(const Polygon& polygon) {
  Eigen::Vector2d low = polygon.outline.front(), high = low;
  for (const Eigen::Vector2d& corner : polygon.outline) {
    low = low.cwiseMin(corner);
    high = high.cwiseMax(corner);
  }
  return box_of(low, high, kMaxAreaGap_m + kAreaRounding_m);
}

class Joiner {
 public:
  Joiner(const std::vector<Polygon>& polygons, const std::string& where)
      : polygons_(polygons),
        where_(where),
        group_(polygons.size()),
        has_slit_(polygons.size(), false) {
    std::iota(group_.begin(), group_.end(), 0u);
    list_edges();
    find_pairs();
    find_nested();
  }

  JoinedArea join() {
    JoinedArea out;
    std::vector<std::vector<uint32_t>> members(polygons_.size());
    for (uint32_t i = 0; i < polygons_.size(); ++i) members[group_of(i)].push_back(i);
    for (uint32_t i = 0; i < polygons_.size(); ++i) {
      // A group takes the place of its first polygon, which names it.
      if (members[i].size() == 1 && !has_slit_[i]) out.polygons.push_back(polygons_[i]);
      if (members[i].size() > 1 || (members[i].size() == 1 && has_slit_[i]))
        join_group(members[i], out);
    }
    std::set<std::pair<uint32_t, uint32_t>> gaps;
    for (const auto& [pair, seam] : seams_) {
      if (!(seam.width_m > kAreaUnit_m && seam.length_m > seam.width_m)) continue;
      gaps.insert(pair);
      if (seam.width_m <= out.max_gap_m) continue;
      out.max_gap_m = seam.width_m;
      out.max_gap_at_m = seam.middle_m;
    }
    out.gaps = static_cast<int64_t>(gaps.size());
    return out;
  }

 private:
  struct Origin {
    Eigen::Vector2d corner_m;
    uint32_t polygon = 0;
    uint32_t order = 0;
    bool is_shared = false;  ///< shared by several polygons or the two sides of a slit
  };
  struct Corner {
    Eigen::Vector2d at_m;
    uint32_t order = std::numeric_limits<uint32_t>::max();  ///< index in the input; none: maximum
    bool is_kept = false;
  };
  using CornerRing = std::vector<Corner>;

  [[noreturn]] void reject(const std::string& expected, const std::string& found) const {
    throw InputError(where_, expected + " in the walkable area (WKT)", found);
  }

  static uint64_t key_of(const GridPoint& point) {
    return (static_cast<uint64_t>(static_cast<uint32_t>(point.x())) << 32) |
           static_cast<uint32_t>(point.y());
  }

  void list_edges() {
    for (uint32_t i = 0; i < polygons_.size(); ++i) {
      const auto add = [&](Polygon::Ring ring, bool is_outline) {
        if ((doubled_area(ring) > 0) != is_outline) std::reverse(ring.begin(), ring.end());
        // A hole this narrow everywhere is an obstacle.
        const bool may_slit = width_of(ring) > kMaxAreaGap_m;
        for (size_t k = 0; k < ring.size(); ++k)
          if (ring[k] != ring[(k + 1) % ring.size()])
            edges_.push_back({ring[k], ring[(k + 1) % ring.size()], i, may_slit});
      };
      add(polygons_[i].outline, true);
      for (const Polygon::Ring& hole : polygons_[i].holes) add(hole, false);
    }
    std::vector<std::pair<Box, uint32_t>> boxes;
    for (uint32_t i = 0; i < edges_.size(); ++i) boxes.emplace_back(box_of(edges_[i]), i);
    tree_ = BoxTree(boxes);
  }

  /// Calls visit(i) for all intersecting boxes; it returns whether the pair counts.
  template <typename Visit>
  void for_each_meeting(const BoxTree& tree, const Box& box, const Visit& visit) {
    for (auto it = tree.qbegin(bg::index::intersects(box)); it != tree.qend(); ++it) {
      pairs_ += visit(it->second) ? 1 : 0;
      if (pairs_ > kMaxPairs || ++visits_ > kMaxVisits)
        reject(fmt::format("polygons of which at most {} pairs of edges lie side by side",
                           kMaxPairs / 2),
               "more; join or simplify them in the file");
    }
  }

  void find_pairs() {
    for (const AreaEdge& edge : edges_)
      for_each_meeting(tree_, box_of(edge), [&](uint32_t k) {
        const AreaEdge& other = edges_[k];
        if (other.polygon == edge.polygon) return &edge < &other && add_slit(edge, other);
        if (other.polygon < edge.polygon ||
            !(edge.distance_m(other) <= kMaxAreaGap_m + kAreaRounding_m))
          return true;
        const std::optional<Seam> seam = seam_between(edge, other);
        if (seam) seams_.push_back({{edge.polygon, other.polygon}, *seam});
        unite(edge.polygon, other.polygon);
        return true;
      });
    std::stable_sort(seams_.begin(), seams_.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
  }

  /// Adds a gap between edges of one polygon, which is closed like one between polygons.
  bool add_slit(const AreaEdge& a, const AreaEdge& b) {
    const double max_m = kMaxAreaGap_m + kAreaRounding_m;
    if (!(a.may_slit && b.may_slit && a.distance_m(b) <= max_m)) return false;
    const std::optional<Seam> seam = seam_between(a, b);
    if (!seam || !(seam->width_m >= 0)) return false;
    // A pointed notch counts only if it is this narrow everywhere.
    const bool ends = a.to == b.from, begins = b.to == a.from;
    if (ends && !(std::min(b.distance_m(a.from), a.distance_m(b.to)) <= max_m)) return false;
    if (begins && !(std::min(b.distance_m(a.to), a.distance_m(b.from)) <= max_m)) return false;
    has_slit_[a.polygon] = true;
    // The union itself closes strips of zero width and removes spikes of zero width.
    if (seam->width_m > kNoWidth_m) seams_.push_back({{a.polygon, b.polygon}, *seam});
    const auto mark = [&](const Eigen::Vector2d& corner, const AreaEdge& other) {
      if (other.distance_m(corner) <= max_m) slit_corners_.push_back(corner);
    };
    mark(a.from, b);
    mark(a.to, b);
    mark(b.from, a);
    mark(b.to, a);
    return true;
  }

  void find_nested() {
    std::vector<std::pair<Box, uint32_t>> boxes;
    for (uint32_t i = 0; i < polygons_.size(); ++i) boxes.emplace_back(box_of(polygons_[i]), i);
    const BoxTree tree(boxes);
    for (uint32_t i = 0; i < polygons_.size(); ++i)
      for_each_meeting(tree, boxes[i].first, [&](uint32_t k) {
        if (k == i || group_of(i) == group_of(k)) return false;
        if (is_inside({&polygons_[k], 1}, polygons_[i].outline.front())) unite(i, k);
        return true;
      });
  }

  uint32_t group_of(uint32_t i) {
    while (group_[i] != i) i = group_[i] = group_[group_[i]];
    return i;
  }
  void unite(uint32_t i, uint32_t k) {
    i = group_of(i);
    k = group_of(k);
    group_[std::max(i, k)] = std::min(i, k);
  }

  void join_group(const std::vector<uint32_t>& members, JoinedArea& out) {
    GridSet all;
    origins_.clear();
    uint32_t order = 0;
    for (const uint32_t i : members) {
      const auto add = [&](const Polygon::Ring& ring) {
        for (const Eigen::Vector2d& corner : ring) {
          if (!(corner.cwiseAbs().maxCoeff() <= kMaxOnGrid_m))
            reject(fmt::format("polygons that adjoin within {:g} km of the recording's middle",
                               kMaxOnGrid_m / 1000),
                   fmt::format("a corner at ({:g}, {:g}) m; is it in other units?", corner.x(),
                               corner.y()));
          Origin& origin =
              origins_.try_emplace(key_of(grid_point(corner)), Origin{corner, i, order, false})
                  .first->second;
          origin.is_shared |= origin.polygon != i;
          ++order;
        }
      };
      add(polygons_[i].outline);
      for (const Polygon::Ring& hole : polygons_[i].holes) add(hole);
      add_to(all, grid_set(polygons_[i]));
    }
    for (const Eigen::Vector2d& corner : slit_corners_)
      if (const auto found = origins_.find(key_of(grid_point(corner))); found != origins_.end())
        found->second.is_shared = true;
    const uint32_t group = members.front();
    for (const auto& [pair, seam] : seams_)
      if (group_of(pair.first) == group) all.insert(grid_polygon(seam.filling));
    std::vector<GridShape> shapes;
    all.get(shapes);
    std::vector<std::pair<uint32_t, Polygon>> found;
    for (const GridShape& shape : shapes) {
      CornerRing outline = corners_of(shape);
      if (outline.size() < 3 || is_closed_gap(outline)) continue;
      const uint32_t first = begin_with_first(outline);
      std::vector<std::pair<uint32_t, Polygon::Ring>> holes;
      for (auto hole = shape.begin_holes(); hole != shape.end_holes(); ++hole) {
        CornerRing ring = corners_of(*hole);
        if (ring.size() < 3 || is_closed_gap(ring)) continue;
        const uint32_t first_of_hole = begin_with_first(ring);
        holes.emplace_back(first_of_hole, ring_of(ring));
      }
      std::stable_sort(holes.begin(), holes.end(),
                       [](const auto& a, const auto& b) { return a.first < b.first; });
      Polygon& polygon = found.emplace_back(first, Polygon{}).second;
      polygon.outline = ring_of(outline);
      for (auto& hole : holes) polygon.holes.push_back(std::move(hole.second));
    }
    std::stable_sort(found.begin(), found.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    for (auto& polygon : found) out.polygons.push_back(std::move(polygon.second));
  }

  static Polygon::Ring ring_of(const CornerRing& corners) {
    Polygon::Ring ring;
    for (const Corner& corner : corners) ring.push_back(corner.at_m);
    return ring;
  }

  static double width_of(const Polygon::Ring& ring) {
    double round_m = 0;
    for (size_t i = 0; i < ring.size(); ++i)
      round_m += (ring[(i + 1) % ring.size()] - ring[i]).norm();
    return std::abs(doubled_area(ring)) / round_m;
  }

  /// Returns whether a hole is the remainder where several gaps meet.
  static bool is_closed_gap(const CornerRing& corners) {
    return std::none_of(corners.begin(), corners.end(),
                        [](const Corner& c) { return c.is_kept; }) &&
           width_of(ring_of(corners)) <= kMaxAreaGap_m;
  }

  static uint32_t begin_with_first(CornerRing& corners) {
    const auto first =
        std::min_element(corners.begin(), corners.end(),
                         [](const Corner& a, const Corner& b) { return a.order < b.order; });
    const uint32_t order = first->order;
    std::rotate(corners.begin(), first, corners.end());
    return order;
  }

  /// Returns whether a corner belongs to one polygon only, with no other polygon nearby.
  bool is_own(const Origin& origin) const {
    if (origin.is_shared) return false;
    const Eigen::Vector2d& p = origin.corner_m;
    for (auto it = tree_.qbegin(bg::index::intersects(box_of(p, p, kOffGrid_m)));
         it != tree_.qend(); ++it) {
      const AreaEdge& edge = edges_[it->second];
      if (edge.polygon != origin.polygon &&
          edge.distance_m(p) <= kMaxAreaGap_m + kAreaRounding_m + kOffGrid_m)
        return false;
    }
    return true;
  }

  template <typename Ring>
  CornerRing corners_of(const Ring& ring) const {
    CornerRing corners;
    for (const GridPoint& point : ring) {
      Corner corner{metres(point)};
      if (const auto found = origins_.find(key_of(point)); found != origins_.end()) {
        corner.at_m = found->second.corner_m;
        corner.order = found->second.order;
        corner.is_kept = is_own(found->second);
      }
      if (corners.empty() || corners.back().at_m != corner.at_m) corners.push_back(corner);
    }
    while (corners.size() > 1 && corners.front().at_m == corners.back().at_m) corners.pop_back();
    return corners.size() < 3 ? corners : straightened(std::move(corners));
  }

  static double off_line_m(const Corner& corner, const Corner& from, const Corner& to) {
    return AreaEdge{from.at_m, to.at_m}.distance_m(corner.at_m);
  }

  /// Removes corners that are not kept and lie on a line of others (Douglas and Peucker 1973).
  static CornerRing straightened(CornerRing corners) {
    // Starts with a corner that stays: a kept one, else the lowest of the leftmost.
    const auto begin =
        std::min_element(corners.begin(), corners.end(), [](const Corner& a, const Corner& b) {
          return std::tuple(!a.is_kept, a.at_m.x(), a.at_m.y()) <
                 std::tuple(!b.is_kept, b.at_m.x(), b.at_m.y());
        });
    std::rotate(corners.begin(), begin, corners.end());
    corners.push_back(corners.front());
    std::vector<uint8_t> stays(corners.size(), 0);
    std::vector<std::pair<size_t, size_t>> open;
    size_t last = 0;
    for (size_t i = 1; i < corners.size(); ++i) {
      if (!corners[i].is_kept && i + 1 < corners.size()) continue;
      open.emplace_back(std::exchange(last, i), i);
      stays[i] = 1;
    }
    while (!open.empty()) {
      const auto [from, to] = open.back();
      open.pop_back();
      double farthest_m = kStraight_m;
      size_t farthest = 0;
      for (size_t i = from + 1; i < to; ++i) {
        const double off_m = off_line_m(corners[i], corners[from], corners[to]);
        if (off_m > farthest_m) {
          farthest_m = off_m;
          farthest = i;
        }
      }
      if (farthest == 0) continue;
      stays[farthest] = 1;
      open.emplace_back(from, farthest);
      open.emplace_back(farthest, to);
    }
    CornerRing out;
    for (size_t i = 1; i < corners.size(); ++i)
      if (stays[i] != 0) out.push_back(corners[i]);
    // Without kept corners the start itself may lie on a line.
    if (out.size() > 3 && !out.back().is_kept &&
        off_line_m(out.back(), out[out.size() - 2], out.front()) <= kStraight_m)
      out.pop_back();
    return out;
  }

  const std::vector<Polygon>& polygons_;
  const std::string& where_;
  std::vector<uint32_t> group_;  ///< per polygon: another polygon of its group, or itself
  std::vector<bool> has_slit_;
  std::vector<Eigen::Vector2d> slit_corners_;
  std::vector<AreaEdge> edges_;
  BoxTree tree_;
  size_t pairs_ = 0, visits_ = 0;
  std::vector<std::pair<std::pair<uint32_t, uint32_t>, Seam>> seams_;
  std::unordered_map<uint64_t, Origin> origins_;
};

}  // namespace

std::vector<Polygon> united(const std::vector<Polygon::Ring>& rings) {
  GridSet all;
  for (const Polygon::Ring& ring : rings) {
    Polygon::Ring counter_clockwise = ring;
    if (doubled_area(ring) < 0) std::reverse(counter_clockwise.begin(), counter_clockwise.end());
    all.insert(grid_polygon(counter_clockwise));
  }
  std::vector<GridShape> shapes;
  all.get(shapes);
  return polygons_of(shapes);
}

JoinedArea join(const std::vector<Polygon>& polygons, const std::string& where) {
  return Joiner(polygons, where).join();
}

namespace {

/// Overlap of a strip with the polygons where it does not end in their corners.
constexpr double kOverlap_m = 3 * kAreaUnit_m;
/// Cosine for edges of a gap that are antiparallel within 20 degrees.
constexpr double kOppositeCosine = -0.94;

struct SeamEnd {
  Eigen::Vector2d point;
  bool is_corner = false;
};

}  // namespace

double AreaEdge::distance_m(const Eigen::Vector2d& p) const {
  return distance_to_segment_m(p, from, to);
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
  if (!(-along_a.dot(along_b) < kOppositeCosine)) return std::nullopt;
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
  // The width is linear: keeps the part of the overlap with the width of a gap.
  double low = begin, high = end;
  const double at_begin = width(begin), at_end = width(end);
  const auto keep = [&](double over_begin, double over_end) {
    if (over_begin > 0 && over_end > 0) high = low;
    if (over_begin > 0 && over_end <= 0)
      low = std::max(low, begin + over_begin / (over_begin - over_end) * (end - begin));
    if (over_begin <= 0 && over_end > 0)
      high = std::min(high, begin + over_begin / (over_begin - over_end) * (end - begin));
  };
  const double max_m = kMaxAreaGap_m + kAreaRounding_m;
  keep(at_begin - max_m, at_end - max_m);
  keep(-kOffGrid_m - at_begin, -kOffGrid_m - at_end);
  if (!(high - low > kAreaUnit_m)) return std::nullopt;
  // Facing corners belong together, also if the gap is cut off obliquely.
  const auto ends = [&](double s, bool is_limit, const Eigen::Vector2d& corner_a,
                        const Eigen::Vector2d& corner_b) {
    if (is_limit && (corner_a - corner_b).norm() <= max_m)
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
