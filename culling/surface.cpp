#include "culling/surface.h"

#include <algorithm>
#include <cstdint>
#include <utility>

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

bool closed(const std::vector<Face>& faces) {
  using Edge = std::pair<uint32_t, uint32_t>;
  std::vector<Edge> forward, backward;
  for (const Face& f : faces) {
    for (size_t c = 0; c < 3; ++c) {
      const uint32_t u = f[c], v = f[(c + 1) % 3];
      if (u == v) continue;  // a triangle that shrank to a segment has only that edge, both ways
      forward.push_back({u, v});
      backward.push_back({v, u});
    }
  }
  std::sort(forward.begin(), forward.end());
  std::sort(backward.begin(), backward.end());
  return forward == backward;
}

uint32_t root_of(std::vector<uint32_t>& parent, uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

}  // namespace

Surface::Surface(std::span<const Corners> triangles) {
  const std::vector<Face> faces = welded(triangles);
  is_closed_ = closed(faces);
  std::vector<uint32_t> parent(3 * faces.size());
  for (uint32_t i = 0; i < parent.size(); ++i) parent[i] = i;
  for (const Face& f : faces)
    for (size_t c = 1; c < 3; ++c) parent[root_of(parent, f[c])] = root_of(parent, f[0]);
  std::vector<bool> named(parent.size());
  for (size_t i = 0; i < faces.size(); ++i) {
    const uint32_t root = root_of(parent, faces[i][0]);
    if (!named[root]) pieces_.push_back(triangles[i][0]);
    named[root] = true;
  }
}

}  // namespace throng
