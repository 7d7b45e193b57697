// Defects of polygons, found and mended on the grid of 0.1 mm with exact arithmetic.
#include <fmt/format.h>

#include <algorithm>
#include <boost/geometry/geometries/box.hpp>
#include <boost/geometry/geometries/point.hpp>
#include <boost/geometry/index/rtree.hpp>
#include <cmath>
#include <cstdint>
#include <utility>

#include "geometry/polygon.h"
#include "geometry/polygon_grid.h"

namespace throng {
namespace {

namespace bg = boost::geometry;
using GridBoxPoint = bg::model::point<int, 2, bg::cs::cartesian>;
using GridBox = bg::model::box<GridBoxPoint>;

struct GridEdge {
  GridPoint from, to;
  uint32_t ring = 0, place = 0;  ///< number of the edge within its ring

  GridBox box() const {
    return {GridBoxPoint(std::min(from.x(), to.x()), std::min(from.y(), to.y())),
            GridBoxPoint(std::max(from.x(), to.x()), std::max(from.y(), to.y()))};
  }
};

int side(const GridPoint& a, const GridPoint& b, const GridPoint& p) {
  const int64_t turn = (int64_t{b.x()} - a.x()) * (int64_t{p.y()} - a.y()) -
                       (int64_t{b.y()} - a.y()) * (int64_t{p.x()} - a.x());
  return turn > 0 ? 1 : turn < 0 ? -1 : 0;
}

std::string to_text(const Eigen::Vector2d& p) {
  return fmt::format("[{:.4f}, {:.4f}]", p.x(), p.y());
}

bool is_on(const GridEdge& edge, const GridPoint& p) {
  return side(edge.from, edge.to, p) == 0 && std::min(edge.from.x(), edge.to.x()) <= p.x() &&
         p.x() <= std::max(edge.from.x(), edge.to.x()) &&
         std::min(edge.from.y(), edge.to.y()) <= p.y() &&
         p.y() <= std::max(edge.from.y(), edge.to.y());
}

/// Returns whether edges cross in their insides.
bool do_cross(const GridEdge& a, const GridEdge& b) {
  return side(a.from, a.to, b.from) * side(a.from, a.to, b.to) < 0 &&
         side(b.from, b.to, a.from) * side(b.from, b.to, a.to) < 0;
}

Eigen::Vector2d crossing_m(const GridEdge& a, const GridEdge& b) {
  const Eigen::Vector2d p = metres(a.from), r = metres(a.to) - p, q = metres(b.from),
                        s = metres(b.to) - q;
  const double slope = r.x() * s.y() - r.y() * s.x();
  return slope == 0 ? q : p + ((q - p).x() * s.y() - (q - p).y() * s.x()) / slope * r;
}

/// Two edges on one line that share more than a point: one end inside the other, or equal edges.
bool overlap(const GridEdge& a, const GridEdge& b) {
  if (side(a.from, a.to, b.from) != 0 || side(a.from, a.to, b.to) != 0) return false;
  const auto along = [&](const GridPoint& p) {
    return (int64_t{a.to.x()} - a.from.x()) * (int64_t{p.x()} - a.from.x()) +
           (int64_t{a.to.y()} - a.from.y()) * (int64_t{p.y()} - a.from.y());
  };
  const int64_t end = along(a.to), first = along(b.from), last = along(b.to);
  return std::max(first, last) > 0 && std::min(first, last) < end;
}

class FaultSearch {
 public:
  std::optional<PolygonFault> add_ring(const Polygon::Ring& ring) {
    if (ring.size() < 3)
      return PolygonFault{"rings of three vertices or more", fmt::format("{}", ring.size())};
    std::vector<GridPoint> points;
    for (const Eigen::Vector2d& corner : ring) {
      if (!(corner.cwiseAbs().maxCoeff() <= kMaxOnGrid_m))
        return PolygonFault{
            fmt::format("vertices at most {:g} km from the origin", kMaxOnGrid_m / 1000),
            fmt::format("[{:g}, {:g}]", corner.x(), corner.y())};
      const GridPoint point = grid_point(corner);
      if (points.empty() || points.back() != point) points.push_back(point);
    }
    while (points.size() > 1 && points.front() == points.back()) points.pop_back();
    if (points.size() < 3)
      return PolygonFault{"rings of three different vertices or more",
                          fmt::format("{} near {}", points.size(), to_text(ring.front()))};
    for (size_t i = 0; i < points.size(); ++i)
      edges_.push_back(
          {points[i], points[(i + 1) % points.size()], rings_, static_cast<uint32_t>(i)});
    counts_.push_back(static_cast<uint32_t>(points.size()));
    ++rings_;
    return std::nullopt;
  }

  std::optional<PolygonFault> crossing() const {
    std::vector<std::pair<GridBox, uint32_t>> boxes;
    for (uint32_t i = 0; i < edges_.size(); ++i) boxes.emplace_back(edges_[i].box(), i);
    const bg::index::rtree<std::pair<GridBox, uint32_t>, bg::index::quadratic<16>> tree(boxes);
    for (uint32_t i = 0; i < edges_.size(); ++i)
      for (auto it = tree.qbegin(bg::index::intersects(boxes[i].first)); it != tree.qend(); ++it)
        if (it->second > i)
          if (std::optional<PolygonFault> fault = between(edges_[i], edges_[it->second]))
            return fault;
    return std::nullopt;
  }

 private:
  bool are_neighbours(const GridEdge& a, const GridEdge& b) const {
    if (a.ring != b.ring) return false;
    const uint32_t count = counts_[a.ring];
    return (a.place + 1) % count == b.place || (b.place + 1) % count == a.place;
  }

  std::optional<PolygonFault> between(const GridEdge& a, const GridEdge& b) const {
    const auto fault = [&](const char* what, const Eigen::Vector2d& at) {
      return PolygonFault{"edges that do not cross or overlap",
                          fmt::format("{} at {}", what, to_text(at))};
    };
    if (overlap(a, b))
      return fault(
          are_neighbours(a, b) ? "an edge that turns back" : "two edges on top of each other",
          metres(is_on(a, b.from) ? b.from
                 : is_on(a, b.to) ? b.to
                                  : a.from));
    if (are_neighbours(a, b)) return std::nullopt;
    if (do_cross(a, b)) return fault("a crossing", crossing_m(a, b));
    return std::nullopt;
  }

  std::vector<GridEdge> edges_;
  std::vector<uint32_t> counts_;  ///< edges by ring
  uint32_t rings_ = 0;
};

/// Removes vertices at which the ring turns back on itself, and repeated ones. Returns how many
/// turned back.
int64_t drop_spikes(Polygon::Ring& ring, Eigen::Vector2d& at_m) {
  int64_t spikes = 0;
  const auto is_spike = [&](size_t i) {
    const size_t count = ring.size();
    const GridPoint before = grid_point(ring[(i + count - 1) % count]), tip = grid_point(ring[i]),
                    after = grid_point(ring[(i + 1) % count]);
    if (before == tip || tip == after) return true;
    return overlap({tip, before}, {tip, after});
  };
  for (size_t i = 0; i < ring.size() && ring.size() >= 3;) {
    if (!is_spike(i)) {
      ++i;
      continue;
    }
    const Eigen::Vector2d tip_m = ring[i];
    ring.erase(ring.begin() + static_cast<ptrdiff_t>(i));
    if (grid_point(ring[i % ring.size()]) != grid_point(tip_m)) {
      ++spikes;
      at_m = tip_m;
    }
    i = i >= 2 ? i - 2 : 0;  // a spike may have had another one at its foot
  }
  return spikes;
}

bool is_on_grid(const Polygon::Ring& ring) {
  return std::all_of(ring.begin(), ring.end(), [](const Eigen::Vector2d& corner) {
    return corner.cwiseAbs().maxCoeff() <= kMaxOnGrid_m;
  });
}

double on_grid_m2(const GridSet& set) {
  return static_cast<double>(boost::polygon::area(set)) * kAreaUnit_m * kAreaUnit_m;
}

double perimeter_m(const Polygon& polygon) {
  double sum_m = 0;
  for_each_edge({&polygon, 1}, [&](const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
    sum_m += (to - from).norm();
  });
  return sum_m;
}

std::optional<PolygonFault> outside_fault(const std::vector<GridShape>& outside) {
  return PolygonFault{"holes inside the outline",
                      "a hole outside of it near " + to_text(metres(*outside.front().begin()))};
}

}  // namespace

std::optional<PolygonFault> fault_of(const Polygon& polygon) {
  FaultSearch search;
  std::optional<PolygonFault> fault = search.add_ring(polygon.outline);
  for (size_t i = 0; i < polygon.holes.size() && !fault; ++i)
    fault = search.add_ring(polygon.holes[i]);
  if (!fault) fault = search.crossing();
  if (fault) return fault;
  // Edges that pass through vertices of other edges are found by what the grid makes of the rings.
  using namespace boost::polygon::operators;
  const GridSet outline = grid_set(polygon.outline), holes = grid_set_of_holes(polygon);
  std::vector<GridShape> outside;
  GridSet(holes - outline).get(outside);
  if (!outside.empty()) return outside_fault(outside);
  const double rings_m2 = area_m2(polygon), whole_m2 = on_grid_m2(GridSet(outline - holes));
  if (!(whole_m2 > 0) ||
      std::abs(whole_m2 - rings_m2) > 2 * kAreaUnit_m * perimeter_m(polygon) + 1e-9 * rings_m2)
    return PolygonFault{"rings that do not cross or overlap",
                        fmt::format("a polygon of {:.6g} m2 whose rings enclose {:.6g} m2, near {}",
                                    whole_m2, rings_m2, to_text(polygon.outline.front()))};
  return std::nullopt;
}

MendedPolygon mended(Polygon polygon) {
  MendedPolygon out;
  const std::optional<PolygonFault> fault = fault_of(polygon);
  if (!fault) {
    out.polygons.push_back(std::move(polygon));
    return out;
  }
  // The outline has to enclose an area; a hole that does not is a sliver.
  if (is_on_grid(polygon.outline)) out.slivers = drop_spikes(polygon.outline, out.sliver_at_m);
  std::erase_if(polygon.holes, [&](Polygon::Ring& hole) {
    if (hole.size() < 3 || !is_on_grid(hole)) return false;  // reported below
    Eigen::Vector2d at_m = hole.front();
    const int64_t spikes = drop_spikes(hole, at_m);
    const bool is_sliver = hole.size() < 3 || boost::polygon::area(grid_set(hole)) == 0;
    if (out.slivers == 0 && (is_sliver || spikes > 0)) out.sliver_at_m = at_m;
    out.slivers += is_sliver ? 1 : spikes;
    return is_sliver;
  });
  out.fault = fault_of({polygon.outline, {}});
  for (size_t i = 0; i < polygon.holes.size() && !out.fault; ++i)
    out.fault = fault_of({polygon.holes[i], {}});
  if (out.fault) return out;

  using namespace boost::polygon::operators;
  const GridSet outline = grid_set(polygon.outline), holes = grid_set_of_holes(polygon);
  const GridSet outside(holes - outline);
  // Where edges lie on each other, rounding moves the ends of a hole out by up to a unit.
  if (on_grid_m2(outside) > 2 * kAreaUnit_m * perimeter_m(polygon)) {
    out.fault = fault;
    return out;
  }
  std::vector<GridShape> shapes;
  GridSet(outline - holes).get(shapes);
  out.polygons = polygons_of(shapes);
  // Pieces narrower than rounding may have faults; a wide one must not be lost.
  std::erase_if(out.polygons, [&](const Polygon& piece) {
    if (!fault_of(piece)) return false;
    if (area_m2(piece) > 2 * kAreaUnit_m * perimeter_m(piece)) out.fault = fault;
    return true;
  });
  if (out.polygons.empty()) out.fault = fault;
  if (out.fault) out.polygons.clear();
  return out;
}

std::string slivers_text(const MendedPolygon& polygon) {
  return fmt::format("{} without area left out, one near {}",
                     polygon.slivers == 1 ? "1 sliver" : fmt::format("{} slivers", polygon.slivers),
                     to_text(polygon.sliver_at_m));
}

}  // namespace throng
