#include "culling/triangles/triangle_bvh.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <span>
#include <tuple>
#include <vector>

#include "base/checksum.h"
#include "culling/triangles/touching_triangles.h"

namespace throng {

// Surface finds the closed solids and connected pieces of a triangle soup.
// Invariant: corners at exactly the same position are one corner, regardless of their indices.

class Surface {
 public:
  explicit Surface(std::span<const std::array<Eigen::Vector3f, 3>> triangles);

  /// Value of a triangle that bounds no solid.
  static constexpr uint32_t kOpen = UINT32_MAX;

  /// By triangle: index of the solid that it bounds, in order of first occurrence, or kOpen.
  /// Triangles that end in a rim are removed first (loose triangles, fins, sheets). A solid is a
  /// component connected by edges that uses each edge equally often in both directions.
  const std::vector<uint32_t>& solids() const { return solids_; }
  uint32_t solid_count() const { return solid_count_; }
  /// One corner of each piece connected by corners, in order of first occurrence.
  const std::vector<Eigen::Vector3f>& pieces() const { return pieces_; }

 private:
  std::vector<uint32_t> solids_;
  uint32_t solid_count_ = 0;
  std::vector<Eigen::Vector3f> pieces_;
};

namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using Corners = std::array<Vector3f, 3>;

struct Bounds {
  Vector3f low = Vector3f::Constant(std::numeric_limits<float>::infinity());
  Vector3f high = Vector3f::Constant(-std::numeric_limits<float>::infinity());

  void add(const Corners& corners) {
    for (const Vector3f& p : corners) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  }
  double half_area() const {
    const Vector3d e = (high.cast<double>() - low.cast<double>());
    return e.x() * e.y() + e.y() * e.z() + e.z() * e.x();
  }
};

TriangleBvh::Node node_around(const Bounds& bounds) {
  TriangleBvh::Node node{};
  for (int i = 0; i < 3; ++i) {
    const double low = static_cast<double>(bounds.low[i]);
    const double high = static_cast<double>(bounds.high[i]);
    const float centre = static_cast<float>(0.5 * (low + high));
    const double half =
        std::max(high - static_cast<double>(centre), static_cast<double>(centre) - low);
    node.centre_m[static_cast<size_t>(i)] = centre;
    node.half_m[static_cast<size_t>(i)] =
        std::nextafter(static_cast<float>(half), std::numeric_limits<float>::max());
  }
  return node;
}

class Builder {
 public:
  Builder(std::span<const Corners> corners, std::vector<TriangleBvh::Node>& nodes)
      : corners_(corners), nodes_(nodes), order_(corners.size()), area_(corners.size()) {
    for (uint32_t i = 0; i < order_.size(); ++i) order_[i] = i;
    build(0, static_cast<uint32_t>(order_.size()), 0);
  }
  const std::vector<uint32_t>& order() const { return order_; }

 private:
  void build(uint32_t begin, uint32_t end, int depth) {
    Bounds bounds;
    for (uint32_t i = begin; i < end; ++i) bounds.add(corners_[order_[i]]);
    const size_t at = nodes_.size();
    nodes_.push_back(node_around(bounds));
    if (end - begin <= TriangleBvh::kLeafTriangles) {
      nodes_[at].first = begin;
      nodes_[at].count = end - begin;
      return;
    }
    const uint32_t middle =
        depth < TriangleBvh::kFreeDepth ? cheapest_split(begin, end) : (begin + end) / 2;
    build(begin, middle, depth + 1);
    nodes_[at].first = static_cast<uint32_t>(nodes_.size());
    build(middle, end, depth + 1);
  }

  void sort(uint32_t begin, uint32_t end, int axis) {
    std::sort(order_.begin() + begin, order_.begin() + end, [&](uint32_t a, uint32_t b) {
      const double ca = middle_of(a, axis), cb = middle_of(b, axis);
      return ca != cb ? ca < cb : a < b;
    });
  }

  double middle_of(uint32_t triangle, int axis) const {
    const Corners& c = corners_[triangle];
    return static_cast<double>(c[0][axis]) + static_cast<double>(c[1][axis]) +
           static_cast<double>(c[2][axis]);
  }

  /// Full sweep of the surface area heuristic over three axes; splits `order_` at the result.
  uint32_t cheapest_split(uint32_t begin, uint32_t end) {
    double min_cost = std::numeric_limits<double>::infinity();
    int best_axis = 0;
    uint32_t best = (begin + end) / 2;
    for (int axis = 0; axis < 3; ++axis) {
      sort(begin, end, axis);
      Bounds right;
      for (uint32_t i = end; i-- > begin + 1;) {
        right.add(corners_[order_[i]]);
        area_[i] = right.half_area();
      }
      Bounds left;
      for (uint32_t i = begin + 1; i < end; ++i) {
        left.add(corners_[order_[i - 1]]);
        const double cost = left.half_area() * (i - begin) + area_[i] * (end - i);
        if (cost < min_cost) {
          min_cost = cost;
          best_axis = axis;
          best = i;
        }
      }
    }
    sort(begin, end, best_axis);
    return best;
  }

  std::span<const Corners> corners_;
  std::vector<TriangleBvh::Node>& nodes_;
  std::vector<uint32_t> order_;
  /// surface area of the box of all triangles from this one to the end of the sweep
  std::vector<double> area_;
};

/// Number of crossings of the ray from `p` along +x through the triangle from behind, minus those
/// from the front. The winding of the y, z projection is summed by edge, each edge from its lower
/// end. Two triangles with a common edge thus agree on it, and no ray passes between them.
int crossing(const Corners& corners, const Vector3d& p) {
  const Vector3d c[3] = {corners[0].cast<double>(), corners[1].cast<double>(),
                         corners[2].cast<double>()};
  int winding = 0;
  for (int i = 0; i < 3; ++i) {
    const Vector3d& u = c[i];
    const Vector3d& v = c[(i + 1) % 3];
    const bool up = u.z() <= p.z() && p.z() < v.z();
    const bool down = v.z() <= p.z() && p.z() < u.z();
    if (!up && !down) continue;
    const Vector3d& lower = up ? u : v;
    const Vector3d& upper = up ? v : u;
    const double left = (upper.y() - lower.y()) * (p.z() - lower.z()) -
                        (upper.z() - lower.z()) * (p.y() - lower.y());
    if (left > 0) winding += up ? 1 : -1;
  }
  if (winding == 0) return 0;
  if (std::max({c[0].x(), c[1].x(), c[2].x()}) < p.x()) return 0;
  if (std::min({c[0].x(), c[1].x(), c[2].x()}) > p.x()) return winding;
  const Vector3d normal = (c[1] - c[0]).cross(c[2] - c[0]);
  return normal.dot(c[0] - p) * winding > 0 ? winding : 0;
}

/// Weight of a turn around a solid; 0 if open. One sum shows whether any solid winds around a
/// point: few turns of 64 well mixed bits cancel with a probability of about 2^-60.
uint64_t weight_of(uint32_t solid) {
  if (solid == Surface::kOpen) return 0;
  return mixed(uint64_t{solid} + 1);
}

}  // namespace

TriangleBvh::TriangleBvh(std::span<const Eigen::Vector3f> points,
                         std::span<const Eigen::Vector3i> triangles) {
  assert(!triangles.empty());
  std::vector<Corners> corners(triangles.size());
  for (size_t i = 0; i < triangles.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      const int index = triangles[i][c];
      assert(index >= 0 && static_cast<size_t>(index) < points.size());
      corners[i][static_cast<size_t>(c)] = points[static_cast<size_t>(index)];
    }
  const Surface surface(corners);
  solid_count_ = surface.solid_count();
  pieces_ = surface.pieces();
  nodes_.reserve(2 * corners.size());
  const Builder builder(corners, nodes_);
  triangles_.reserve(corners.size());
  for (uint32_t i : builder.order()) triangles_.push_back(corners[i]);
  const std::vector<uint32_t>& solids = surface.solids();
  const bool is_one = std::all_of(solids.begin(), solids.end(), [](uint32_t s) { return s == 0; });
  if (is_one || solid_count_ == 0) return;
  solids_.reserve(corners.size());
  for (uint32_t i : builder.order()) solids_.push_back(solids[i]);
}

bool TriangleBvh::contains(const Eigen::Vector3d& point_m) const {
  if (solid_count_ == 0) return false;
  uint32_t stack[kMaxDepth + 1];
  int top = 0;
  stack[top++] = 0;
  uint64_t winding = 0;
  while (top > 0) {
    const uint32_t at = stack[--top];
    const Node& node = nodes_[at];
    const auto offset = [&](size_t i) {
      return point_m[static_cast<Eigen::Index>(i)] - static_cast<double>(node.centre_m[i]);
    };
    if (offset(0) > static_cast<double>(node.half_m[0]) ||
        std::fabs(offset(1)) > static_cast<double>(node.half_m[1]) ||
        std::fabs(offset(2)) > static_cast<double>(node.half_m[2]))
      continue;
    if (node.count == 0) {
      stack[top++] = node.first;
      stack[top++] = at + 1;
      continue;
    }
    for (uint32_t i = node.first; i < node.first + node.count; ++i) {
      const auto times = static_cast<uint64_t>(int64_t{crossing(triangles_[i], point_m)});
      if (times == 0) continue;
      winding += solids_.empty() ? times : times * weight_of(solids_[i]);
    }
  }
  return winding != 0;
}

namespace {

using Corners = std::array<Eigen::Vector3f, 3>;
using Face = std::array<uint32_t, 3>;

bool before(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

/// Triangles as ranks of their distinct corners.
std::vector<Face> welded(std::span<const Corners> triangles) {
  std::vector<Eigen::Vector3f> distinct;
  for (const Corners& t : triangles) distinct.insert(distinct.end(), t.begin(), t.end());
  std::sort(distinct.begin(), distinct.end(), before);
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  std::vector<Face> faces(triangles.size());
  for (size_t i = 0; i < triangles.size(); ++i)
    for (size_t c = 0; c < 3; ++c)
      faces[i][c] = static_cast<uint32_t>(
          std::lower_bound(distinct.begin(), distinct.end(), triangles[i][c], before) -
          distinct.begin());
  return faces;
}

/// Disjoint sets (union-find).
class Groups {
 public:
  explicit Groups(size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), uint32_t{0});
  }
  uint32_t of(uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(uint32_t a, uint32_t b) { parent_[of(a)] = of(b); }

 private:
  std::vector<uint32_t> parent_;
};

/// Edges between different corners, and the faces that use them. Faces can be removed.
class Edges {
 public:
  explicit Edges(const std::vector<Face>& faces)
      : of_face_(faces.size()), is_forward_(faces.size()) {
    std::vector<Side> sides;
    for (uint32_t f = 0; f < faces.size(); ++f) {
      of_face_[f].fill(kNone);
      for (uint32_t c = 0; c < 3; ++c) {
        const uint32_t u = faces[f][c], v = faces[f][(c + 1) % 3];
        // A degenerate triangle that is a segment has only this edge, in both directions.
        if (u != v) sides.push_back({std::min(u, v), std::max(u, v), f, c, u < v});
      }
    }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
      return std::tie(a.low, a.high, a.face, a.corner) < std::tie(b.low, b.high, b.face, b.corner);
    });
    for (size_t i = 0; i < sides.size(); ++i) {
      const Side& side = sides[i];
      if (i == 0 || side.low != sides[i - 1].low || side.high != sides[i - 1].high)
        edges_.emplace_back();
      Edge& edge = edges_.back();
      ++edge.uses;
      edge.balance += side.is_forward ? 1 : -1;
      edge.users ^= side.face;
      of_face_[side.face][side.corner] = static_cast<uint32_t>(edges_.size() - 1);
      is_forward_[side.face][side.corner] = side.is_forward;
    }
  }

  /// Removes faces with an edge that no other face uses. Returns by face whether it remains.
  std::vector<bool> peel() {
    std::vector<bool> is_left(of_face_.size());
    for (size_t f = 0; f < of_face_.size(); ++f) is_left[f] = any_of(f) != kNone;
    std::vector<uint32_t> rim;
    for (const Edge& edge : edges_)
      if (edge.uses == 1) rim.push_back(edge.users);
    while (!rim.empty()) {
      const uint32_t face = rim.back();
      rim.pop_back();
      if (!is_left[face]) continue;
      is_left[face] = false;
      for (size_t c = 0; c < 3; ++c) {
        if (of_face_[face][c] == kNone) continue;
        Edge& edge = edges_[of_face_[face][c]];
        edge.balance -= is_forward_[face][c] ? 1 : -1;
        edge.users ^= face;
        if (--edge.uses == 1) rim.push_back(edge.users);
      }
    }
    return is_left;
  }

  static constexpr uint32_t kNone = UINT32_MAX;
  /// Edges of a face from each corner to the next, or kNone.
  const std::array<uint32_t, 3>& of(size_t face) const { return of_face_[face]; }
  uint32_t any_of(size_t face) const {
    return *std::min_element(of_face_[face].begin(), of_face_[face].end());
  }
  size_t count() const { return edges_.size(); }
  bool is_balanced(uint32_t edge) const { return edges_[edge].balance == 0; }

 private:
  struct Side {
    uint32_t low, high, face, corner;
    bool is_forward;
  };
  struct Edge {
    uint32_t uses = 0;
    int32_t balance = 0;  ///< uses from low to high minus the others
    uint32_t users = 0;   ///< exclusive or of all users: the face itself if there is one
  };
  std::vector<Edge> edges_;
  std::vector<std::array<uint32_t, 3>> of_face_;
  std::vector<std::array<bool, 3>> is_forward_;
};

/// By face, see Surface::solids(); not yet numbered, but faces of one solid have the same number.
std::vector<uint32_t> solids_among(const std::vector<Face>& faces) {
  Edges edges(faces);
  const std::vector<bool> is_left = edges.peel();
  Groups groups(edges.count());
  for (size_t f = 0; f < faces.size(); ++f)
    for (const uint32_t edge : edges.of(f))
      if (is_left[f] && edge != Edges::kNone) groups.join(edge, edges.any_of(f));
  std::vector<bool> is_open(edges.count());
  for (uint32_t edge = 0; edge < edges.count(); ++edge)
    if (!edges.is_balanced(edge)) is_open[groups.of(edge)] = true;
  std::vector<uint32_t> solids(faces.size(), Surface::kOpen);
  for (size_t f = 0; f < faces.size(); ++f) {
    if (!is_left[f]) continue;
    const uint32_t group = groups.of(edges.any_of(f));
    if (!is_open[group]) solids[f] = group;
  }
  return solids;
}

}  // namespace

Surface::Surface(std::span<const Corners> triangles) {
  const std::vector<Face> faces = welded(triangles);
  solids_ = solids_among(faces);
  std::map<uint32_t, uint32_t> numbers;
  for (uint32_t& solid : solids_)
    if (solid != kOpen) solid = numbers.emplace(solid, numbers.size()).first->second;
  solid_count_ = static_cast<uint32_t>(numbers.size());
  Groups corners(3 * faces.size());
  for (const Face& f : faces)
    for (size_t c = 1; c < 3; ++c) corners.join(f[c], f[0]);
  std::vector<bool> named(3 * faces.size());
  for (size_t i = 0; i < faces.size(); ++i) {
    const uint32_t group = corners.of(faces[i][0]);
    if (!named[group]) pieces_.push_back(triangles[i][0]);
    named[group] = true;
  }
}

std::optional<Eigen::Vector3d> piece_inside(const TriangleBvh& a, const TriangleBvh& b,
                                            const RelativeFrame& a_from_b) {
  for (const Eigen::Vector3f& p : b.pieces()) {
    const Eigen::Vector3d in_a = a_from_b.linear * p.cast<double>() + a_from_b.offset;
    if (a.contains(in_a)) return in_a;
  }
  for (const Eigen::Vector3f& p : a.pieces())
    if (b.contains(a_from_b.inverse * (p.cast<double>() - a_from_b.offset)))
      return p.cast<double>();
  return std::nullopt;
}

bool solids_touch(const TriangleBvh& a, const PartPose& pose_a, float scale_a, const TriangleBvh& b,
                  const PartPose& pose_b, float scale_b, const Eigen::Vector3f& a_to_b_m,
                  TriangleCounters& counters) {
  assert(scale_a > 0 && scale_b > 0);
  const RelativeFrame a_from_b(pose_a, scale_a, pose_b, scale_b, a_to_b_m);
  const double ratio = static_cast<double>(scale_b) / static_cast<double>(scale_a);
  const TouchingTriangles triangles(a, b, a_from_b, ratio, counters);
  if (triangles.visit([](const Triangle&, const Triangle&) { return true; })) return true;
  return piece_inside(a, b, a_from_b).has_value();
}

}  // namespace throng
