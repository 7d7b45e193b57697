#include "analysis/trajectories/walkable_area.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

#include "base/errors.h"
#include "base/text.h"
#include "crowd/crowd_plan.h"
#include "crowd/navigation/footprints.h"
#include "geometry/polygon_grid.h"

namespace throng {
namespace {

namespace bp = boost::polygon;

/// Smaller pieces cannot hold the smallest disc.
constexpr double kMinPiece_m2 = std::numbers::pi * kMinRadius_m * kMinRadius_m;
/// Number of corners of a disc's outline: within 0.1 mm of the circle.
constexpr int kDiscCorners = 64;

std::vector<Eigen::Vector2d> inflated(std::vector<Eigen::Vector2d> corners) {
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& corner : corners)
    middle += corner / static_cast<double>(corners.size());
  for (Eigen::Vector2d& corner : corners)
    for (int axis = 0; axis < 2; ++axis)
      corner[axis] += std::copysign(kAreaUnit_m, corner[axis] - middle[axis]);
  return corners;
}

/// The whole ground, or its floor.
GridSet ground_of(const Scene& scene) {
  GridSet ground;
  const Eigen::Vector2d &low = scene.ground.min_m, &high = scene.ground.max_m;
  if (!(low.minCoeff() >= -kMaxOnGrid_m && high.maxCoeff() <= kMaxOnGrid_m))
    throw InputError(scene.name,
                     fmt::format("a ground within {:g} km of the origin for its walkable area",
                                 kMaxOnGrid_m / 1000),
                     "a larger one");
  if (scene.floor.empty())
    ground.insert(grid_polygon({low, {high.x(), low.y()}, high, {low.x(), high.y()}}));
  for (const Polygon& polygon : scene.floor) add_to(ground, grid_set(polygon));
  return ground;
}

template <typename Ring>
std::vector<Eigen::Vector2d> ring_of(const Ring& ring, bool counter_clockwise) {
  std::vector<Eigen::Vector2d> corners;
  for (const GridPoint& point : ring) corners.push_back(metres(point));
  if (corners.size() > 1 && corners.front() == corners.back()) corners.pop_back();
  if ((doubled_area(corners) > 0) != counter_clockwise)
    std::reverse(corners.begin(), corners.end());
  // Rings start at their leftmost corner, to make the text unique.
  const auto first = std::min_element(corners.begin(), corners.end(),
                                      [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
                                        return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
                                      });
  std::rotate(corners.begin(), first, corners.end());
  return corners;
}

std::string text_of(const std::vector<Eigen::Vector2d>& ring) {
  std::string text = "(";
  for (size_t i = 0; i <= ring.size(); ++i) {
    const Eigen::Vector2d& corner = ring[i % ring.size()];
    // Four digits express the unit exactly; adding zero turns -0 into 0.
    append(text, "{}{:.4f} {:.4f}", i == 0 ? "" : ", ", corner.x() + 0.0, corner.y() + 0.0);
  }
  return text + ")";
}

/// Corner i of a ring with its neighbours; the walkable side is on the left.
struct Corner {
  Eigen::Vector2d before, at, after;

  Eigen::Vector2d inward() const {
    const Eigen::Vector2d along = (after - at).normalized();
    return {-along.y(), along.x()};
  }
  bool is_reflex() const {
    const Eigen::Vector2d in = at - before, out = after - at;
    return in.x() * out.y() - in.y() * out.x() < 0;
  }
};

std::vector<Corner> corners_of(const Polygon& polygon) {
  std::vector<Corner> corners;
  const auto add = [&](const std::vector<Eigen::Vector2d>& ring) {
    for (size_t i = 0, n = ring.size(); i < n; ++i)
      corners.push_back({ring[(i + n - 1) % n], ring[i], ring[(i + 1) % n]});
  };
  add(polygon.outline);
  for (const auto& hole : polygon.holes) add(hole);
  return corners;
}

/// True if the smallest disc fits at the middle of an edge. Fast answer for large pieces: usually
/// one of the first edges fits.
bool fits_disc_at_edge(const std::vector<Corner>& corners) {
  constexpr size_t kMaxEdges = 64;
  const auto distance_m = [](const Eigen::Vector2d& p, const Corner& edge) {
    const Eigen::Vector2d along = edge.after - edge.at;
    const double t = std::clamp((p - edge.at).dot(along) / along.squaredNorm(), 0.0, 1.0);
    return (p - edge.at - t * along).norm();
  };
  const auto fits = [&](const Corner& edge) {
    const Eigen::Vector2d p = 0.5 * (edge.at + edge.after) + kMinRadius_m * edge.inward();
    return std::all_of(corners.begin(), corners.end(), [&](const Corner& other) {
      return distance_m(p, other) >= kMinRadius_m - kAreaUnit_m;
    });
  };
  const auto end =
      corners.begin() + static_cast<std::ptrdiff_t>(std::min(kMaxEdges, corners.size()));
  return std::any_of(corners.begin(), end, fits);
}

/// True if the smallest disc fits: the polygon minus a strip along its edges is not empty.
bool fits_disc(const Polygon& polygon) {
  if (area_m2(polygon) < kMinPiece_m2) return false;
  const std::vector<Corner> corners = corners_of(polygon);
  if (fits_disc_at_edge(corners)) return true;
  GridSet interior, rim;
  add_to(interior, grid_set(polygon));
  for (const Corner& corner : corners) {
    const Eigen::Vector2d in = kMinRadius_m * corner.inward();
    rim.insert(grid_polygon({corner.at, corner.after, corner.after + in, corner.at + in}));
    if (!corner.is_reflex()) continue;
    std::vector<Eigen::Vector2d> disc;
    for (int i = 0; i < kDiscCorners; ++i) {
      const double angle_rad = 2 * std::numbers::pi * i / kDiscCorners;
      disc.emplace_back(corner.at +
                        kMinRadius_m * Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad)));
    }
    rim.insert(grid_polygon(disc));
  }
  using namespace bp::operators;
  std::vector<GridShape> left;
  GridSet(interior - rim).get(left);
  return !left.empty();
}

std::string text_of(const Polygon& polygon) {
  std::string text = fmt::format("({}", text_of(polygon.outline));
  for (const auto& hole : polygon.holes) text += fmt::format(", {}", text_of(hole));
  return text + ")";
}

}  // namespace

std::vector<Polygon> walkable_area(const Scene& scene) {
  GridSet ground = ground_of(scene);
  GridSet solid;
  for (const Footprint& footprint : footprints_of(scene))
    solid.insert(grid_polygon(inflated(footprint.corners)));
  using namespace bp::operators;
  std::vector<GridShape> shapes;
  const GridSet left(ground - solid);
  left.get(shapes);
  std::sort(shapes.begin(), shapes.end(),
            [](const GridShape& a, const GridShape& b) { return bp::area(a) > bp::area(b); });
  std::vector<Polygon> area;
  for (const GridShape& shape : shapes) {
    Polygon& polygon = area.emplace_back();
    polygon.outline = ring_of(shape, true);
    for (auto hole = shape.begin_holes(); hole != shape.end_holes(); ++hole)
      polygon.holes.push_back(ring_of(*hole, false));
  }
  return area;
}

TrajectoryArea trajectory_area(const Scene& scene, std::optional<int64_t> piece,
                               std::string_view option) {
  std::vector<Polygon> pieces = walkable_area(scene);
  if (pieces.empty()) throw InputError(scene.name, "walkable ground for the trajectory", "none");
  if (pieces.size() > 1) {
    // If no piece can hold a disc, the largest piece, which comes first, represents the area.
    const auto narrow = std::stable_partition(pieces.begin(), pieces.end(), fits_disc);
    pieces.erase(std::max(narrow, pieces.begin() + 1), pieces.end());
  }
  if (!piece && pieces.size() > 1)
    throw InputError(
        option, "the piece of the walkable area for the trajectory, as SQLite holds only one",
        fmt::format("{} pieces, the largest of {:.1f} and {:.1f} m2; choose 'largest', or a number "
                    "from 1 in order of size",
                    pieces.size(), area_m2(pieces[0]), area_m2(pieces[1])));
  const auto count = static_cast<int64_t>(pieces.size());
  if (piece.value_or(1) > count)
    throw InputError(
        option,
        fmt::format("a piece of the walkable area of '{}', from 1 to {}", scene.name, count),
        fmt::format("{}", *piece));
  const auto chosen = static_cast<size_t>(piece.value_or(1));
  return {fmt::format("POLYGON {}", text_of(pieces[chosen - 1])), chosen, pieces.size()};
}

std::optional<int64_t> trajectory_piece(std::string_view word) {
  if (word == "largest") return 1;
  int64_t number = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (error != std::errc() || end != word.data() + word.size() || number < 1) return std::nullopt;
  return number;
}

}  // namespace throng
