// Triangles and convex pieces of a polygon. Coordinates are on the grid of 0.1 mm, so that every
// decision is exact.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include "geometry/polygon.h"
#include "geometry/polygon_grid.h"

namespace throng {
namespace {

using Index = uint32_t;

struct Vertex {
  Eigen::Vector2d at_m;
  int64_t x = 0, y = 0;

  bool is_at(const Vertex& other) const { return x == other.x && y == other.y; }
};

/// Twice the signed area of a triangle. Differences of grid coordinates are below 2^31, so that
/// products and their difference fit.
int64_t turn(const Vertex& a, const Vertex& b, const Vertex& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Clips ears off an outline whose holes are joined to it by bridges (Eberly 2008, "Triangulation
/// by Ear Clipping").
class EarClipper {
 public:
  explicit EarClipper(const Polygon& polygon) {
    std::vector<Index> outline = add_ring(polygon.outline, true);
    std::vector<std::vector<Index>> holes;
    for (const Polygon::Ring& hole : polygon.holes) {
      holes.push_back(add_ring(hole, false));
      if (holes.back().size() < 3) holes.pop_back();
    }
    loop_ = joined(std::move(outline), std::move(holes));
  }

  const Vertex& vertex(Index index) const { return vertices_[index]; }

  /// Triangles of vertex indices, counter-clockwise.
  std::vector<std::array<Index, 3>> clip() {
    const auto count = static_cast<Index>(loop_.size());
    before_.resize(count);
    after_.resize(count);
    for (Index i = 0; i < count; ++i) {
      before_[i] = i == 0 ? count - 1 : i - 1;
      after_[i] = i + 1 == count ? 0 : i + 1;
    }
    fill_grid();
    Index left = count, at = 0, failures = 0;
    // Simple polygons always have an ear; the bound guards against loops that overlap themselves.
    while (left > 3 && failures <= left) {
      if (!is_ear(at)) {
        at = after_[at];
        ++failures;
        continue;
      }
      add_triangle(at);
      after_[before_[at]] = after_[at];
      before_[after_[at]] = before_[at];
      is_clipped_[at] = 1;
      at = after_[at];
      failures = 0;
      --left;
    }
    if (left == 3) add_triangle(at);
    return std::move(triangles_);
  }

 private:
  /// Vertices of a ring without repeated ones, in the wanted direction.
  std::vector<Index> add_ring(Polygon::Ring ring, bool counter_clockwise) {
    if ((doubled_area(ring) > 0) != counter_clockwise) std::reverse(ring.begin(), ring.end());
    std::vector<Index> out;
    for (const Eigen::Vector2d& corner : ring) {
      const GridPoint point = grid_point(corner);
      const Vertex vertex{corner, point.x(), point.y()};
      if (!out.empty() && vertices_[out.back()].is_at(vertex)) continue;
      out.push_back(static_cast<Index>(vertices_.size()));
      vertices_.push_back(vertex);
    }
    while (out.size() > 1 && vertices_[out.front()].is_at(vertices_[out.back()])) out.pop_back();
    return out;
  }

  /// Joins holes to the outline, the rightmost hole first, each from its rightmost vertex.
  std::vector<Index> joined(std::vector<Index> loop, std::vector<std::vector<Index>> holes) const {
    const auto is_left_of = [&](Index a, Index b) {
      const Vertex &p = vertices_[a], &q = vertices_[b];
      return p.x < q.x || (p.x == q.x && p.y < q.y);
    };
    for (std::vector<Index>& hole : holes)
      std::rotate(hole.begin(), std::max_element(hole.begin(), hole.end(), is_left_of), hole.end());
    std::sort(holes.begin(), holes.end(),
              [&](const auto& a, const auto& b) { return is_left_of(b.front(), a.front()); });
    for (const std::vector<Index>& hole : holes) {
      const size_t bridge = bridge_from(loop, vertices_[hole.front()]);
      std::vector<Index> detour(hole);
      detour.push_back(hole.front());
      detour.push_back(loop[bridge]);
      loop.insert(loop.begin() + static_cast<ptrdiff_t>(bridge) + 1, detour.begin(), detour.end());
    }
    return loop;
  }

  /// Returns whether `to` lies in the closed interior angle of a vertex of a loop.
  bool is_in_cone(const std::vector<Index>& loop, size_t at, const Vertex& to) const {
    const size_t count = loop.size();
    return is_in_cone(vertices_[loop[(at + count - 1) % count]], vertices_[loop[at]],
                      vertices_[loop[(at + 1) % count]], to);
  }
  static bool is_in_cone(const Vertex& before, const Vertex& at, const Vertex& after,
                         const Vertex& to) {
    if (turn(before, at, after) > 0) return turn(at, after, to) >= 0 && turn(before, at, to) >= 0;
    return !(turn(at, after, to) < 0 && turn(before, at, to) < 0);
  }

  /// Nearest vertex of the loop that `from` sees, for a bridge that crosses no edge.
  size_t bridge_from(const std::vector<Index>& loop, const Vertex& from) const {
    std::vector<std::pair<double, size_t>> candidates;
    for (size_t i = 0; i < loop.size(); ++i) {
      const Vertex& to = vertices_[loop[i]];
      if (to.x < from.x || !is_in_cone(loop, i, from)) continue;
      candidates.emplace_back(
          std::hypot(static_cast<double>(to.x - from.x), static_cast<double>(to.y - from.y)), i);
    }
    std::sort(candidates.begin(), candidates.end());
    for (const auto& [distance, i] : candidates)
      if (!is_crossed(loop, from, vertices_[loop[i]])) return i;
    return candidates.empty() ? 0 : candidates.front().second;
  }

  bool is_crossed(const std::vector<Index>& loop, const Vertex& from, const Vertex& to) const {
    for (size_t i = 0; i < loop.size(); ++i) {
      const Vertex &a = vertices_[loop[i]], &b = vertices_[loop[(i + 1) % loop.size()]];
      const auto side = [](int64_t value) { return value > 0 ? 1 : value < 0 ? -1 : 0; };
      const int of_a = side(turn(from, to, a)), of_b = side(turn(from, to, b));
      const int of_from = side(turn(a, b, from)), of_to = side(turn(a, b, to));
      if (of_a * of_b < 0 && of_from * of_to < 0) return true;
      // A vertex on the bridge that is none of its ends.
      if (of_a == 0 && !a.is_at(from) && !a.is_at(to) && is_between(from, to, a)) return true;
    }
    return false;
  }

  static bool is_between(const Vertex& from, const Vertex& to, const Vertex& p) {
    return std::min(from.x, to.x) <= p.x && p.x <= std::max(from.x, to.x) &&
           std::min(from.y, to.y) <= p.y && p.y <= std::max(from.y, to.y);
  }

  const Vertex& at(Index place) const { return vertices_[loop_[place]]; }

  bool is_ear(Index place) const {
    const Index before = before_[place], after = after_[place];
    const Vertex &a = at(before), &b = at(place), &c = at(after);
    const int64_t area = turn(a, b, c);
    if (area < 0) return false;
    if (area == 0) return true;  // a spike or a vertex on a line
    if (!is_in_cone(at(before_[before]), a, b, c) || !is_in_cone(b, c, at(after_[after]), a))
      return false;
    return !is_any_inside(a, b, c);
  }

  /// Returns whether a vertex lies in the triangle, other than at its corners.
  bool is_any_inside(const Vertex& a, const Vertex& b, const Vertex& c) const {
    const int left = column_of(std::min({a.x, b.x, c.x}));
    const int right = column_of(std::max({a.x, b.x, c.x}));
    const int low = row_of(std::min({a.y, b.y, c.y}));
    const int high = row_of(std::max({a.y, b.y, c.y}));
    for (int row = low; row <= high; ++row)
      for (int column = left; column <= right; ++column)
        for (const Index place : cells_[static_cast<size_t>(row * columns_ + column)]) {
          if (is_clipped_[place] != 0) continue;
          const Vertex& p = at(place);
          if (p.is_at(a) || p.is_at(b) || p.is_at(c)) continue;
          if (turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0) return true;
        }
    return false;
  }

  /// Convex vertices lie in an ear only if a reflex one does; a convex vertex stays convex.
  void fill_grid() {
    is_clipped_.assign(loop_.size(), 0);
    low_x_ = low_y_ = std::numeric_limits<int64_t>::max();
    int64_t high_x = std::numeric_limits<int64_t>::min(), high_y = high_x;
    for (const Index index : loop_) {
      const Vertex& v = vertices_[index];
      low_x_ = std::min(low_x_, v.x);
      low_y_ = std::min(low_y_, v.y);
      high_x = std::max(high_x, v.x);
      high_y = std::max(high_y, v.y);
    }
    const int sides = std::clamp(static_cast<int>(std::sqrt(loop_.size())), 1, 256);
    columns_ = rows_ = sides;
    cell_x_ = (high_x - low_x_) / sides + 1;
    cell_y_ = (high_y - low_y_) / sides + 1;
    cells_.assign(static_cast<size_t>(columns_ * rows_), {});
    for (Index place = 0; place < loop_.size(); ++place) {
      if (turn(at(before_[place]), at(place), at(after_[place])) > 0) continue;
      const int cell = row_of(at(place).y) * columns_ + column_of(at(place).x);
      cells_[static_cast<size_t>(cell)].push_back(place);
    }
  }
  int column_of(int64_t x) const { return static_cast<int>((x - low_x_) / cell_x_); }
  int row_of(int64_t y) const { return static_cast<int>((y - low_y_) / cell_y_); }

  void add_triangle(Index place) {
    const std::array<Index, 3> corners = {loop_[before_[place]], loop_[place],
                                          loop_[after_[place]]};
    if (turn(vertices_[corners[0]], vertices_[corners[1]], vertices_[corners[2]]) > 0)
      triangles_.push_back(corners);
  }

  std::vector<Vertex> vertices_;
  std::vector<Index> loop_;  ///< the outline with bridges to the holes
  std::vector<Index> before_, after_;
  std::vector<uint8_t> is_clipped_;
  std::vector<std::array<Index, 3>> triangles_;
  // Places of vertices that are not convex, by cell.
  std::vector<std::vector<Index>> cells_;
  int64_t low_x_ = 0, low_y_ = 0, cell_x_ = 1, cell_y_ = 1;
  int columns_ = 1, rows_ = 1;
};

/// Merges triangles across edges as long as the pieces stay convex.
class PieceMerger {
 public:
  PieceMerger(const EarClipper& clipper, const std::vector<std::array<Index, 3>>& triangles)
      : clipper_(clipper), parent_(triangles.size()) {
    std::iota(parent_.begin(), parent_.end(), Index{0});
    for (Index piece = 0; piece < triangles.size(); ++piece) {
      pieces_.emplace_back(triangles[piece].begin(), triangles[piece].end());
      for (size_t i = 0; i < 3; ++i)
        edges_[{triangles[piece][i], triangles[piece][(i + 1) % 3]}] = piece;
    }
  }

  std::vector<Polygon::Ring> merge() {
    for (const auto& [edge, piece] : edges_) {
      if (edge.first > edge.second) continue;
      const auto opposite = edges_.find({edge.second, edge.first});
      if (opposite != edges_.end()) try_merge(edge, root(piece), root(opposite->second));
    }
    std::vector<Polygon::Ring> out;
    for (Index piece = 0; piece < pieces_.size(); ++piece) {
      if (root(piece) != piece) continue;
      Polygon::Ring& ring = out.emplace_back();
      for (const Index index : pieces_[piece]) ring.push_back(clipper_.vertex(index).at_m);
    }
    return out;
  }

 private:
  using Edge = std::pair<Index, Index>;

  Index root(Index piece) {
    while (parent_[piece] != piece) piece = parent_[piece] = parent_[parent_[piece]];
    return piece;
  }

  /// `a` has the edge, `b` its opposite.
  void try_merge(const Edge& edge, Index a, Index b) {
    if (a == b) return;
    std::vector<Index>&first = pieces_[a], &second = pieces_[b];
    std::rotate(first.begin(), std::find(first.begin(), first.end(), edge.second), first.end());
    std::rotate(second.begin(), std::find(second.begin(), second.end(), edge.first), second.end());
    // first: to ... from; second: from ... to. Corners at `from` and `to` have to stay convex.
    const auto is_convex = [&](Index before, Index at, Index after) {
      return turn(clipper_.vertex(before), clipper_.vertex(at), clipper_.vertex(after)) >= 0;
    };
    if (first.back() != edge.first || second.back() != edge.second) return;
    if (!is_convex(first[first.size() - 2], edge.first, second[1]) ||
        !is_convex(second[second.size() - 2], edge.second, first[1]))
      return;
    first.insert(first.end(), second.begin() + 1, second.end() - 1);
    second.clear();
    parent_[b] = a;
  }

  const EarClipper& clipper_;
  std::vector<Index> parent_;
  std::vector<std::vector<Index>> pieces_;
  std::map<Edge, Index> edges_;
};

}  // namespace

std::vector<FlatTriangle> triangles_of(const Polygon& polygon) {
  EarClipper clipper(polygon);
  std::vector<FlatTriangle> out;
  for (const auto& [a, b, c] : clipper.clip())
    out.push_back({clipper.vertex(a).at_m, clipper.vertex(b).at_m, clipper.vertex(c).at_m});
  return out;
}

std::vector<Polygon::Ring> convex_pieces_of(const Polygon& polygon) {
  EarClipper clipper(polygon);
  const std::vector<std::array<Index, 3>> triangles = clipper.clip();
  return PieceMerger(clipper, triangles).merge();
}

}  // namespace throng
