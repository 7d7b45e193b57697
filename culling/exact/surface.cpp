#include "culling/exact/surface.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <numeric>
#include <tuple>

namespace throng {
namespace {

using Corners = std::array<Eigen::Vector3f, 3>;
using Face = std::array<uint32_t, 3>;

bool before(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

/// The triangles by the ranks of their distinct corners.
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

/// Sets that grow together.
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

/// The edges between different corners, and the faces that use them; faces can be taken off.
class Edges {
 public:
  explicit Edges(const std::vector<Face>& faces)
      : of_face_(faces.size()), is_forward_(faces.size()) {
    std::vector<Side> sides;
    for (uint32_t f = 0; f < faces.size(); ++f) {
      of_face_[f].fill(kNone);
      for (uint32_t c = 0; c < 3; ++c) {
        const uint32_t u = faces[f][c], v = faces[f][(c + 1) % 3];
        // A triangle that shrank to a segment has only that edge, both ways.
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

  /// Takes off whatever has an edge that nothing else uses, until there is no such thing. Returns
  /// by face whether it is left.
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
  /// Of a face: the edge from each corner to the next, or kNone.
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
    uint32_t users = 0;   ///< all of them, exclusive or: the face itself where there is one
  };
  std::vector<Edge> edges_;
  std::vector<std::array<uint32_t, 3>> of_face_;
  std::vector<std::array<bool, 3>> is_forward_;
};

/// By face, see Surface::solids(); not numbered yet: faces of one solid have the same number.
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

}  // namespace throng
