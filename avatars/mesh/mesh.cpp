#include "avatars/mesh/mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>

namespace throng {

bool is_closed(const Mesh& mesh) {
  if (mesh.triangles.empty()) return false;
  // Directed edges, sorted: in a closed mesh each edge and its reverse occur exactly once.
  std::vector<uint64_t> edges;
  edges.reserve(mesh.triangles.size() * 3);
  const auto key = [](int from, int to) {
    return static_cast<uint64_t>(static_cast<uint32_t>(from)) << 32 | static_cast<uint32_t>(to);
  };
  for (const Eigen::Vector3i& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i) {
      const int from = t[i];
      const int to = t[(i + 1) % 3];
      if (from == to) return false;
      edges.push_back(key(from, to));
    }
  }
  std::sort(edges.begin(), edges.end());
  if (std::adjacent_find(edges.begin(), edges.end()) != edges.end()) return false;
  return std::all_of(edges.begin(), edges.end(), [&](uint64_t edge) {
    return std::binary_search(edges.begin(), edges.end(), edge << 32 | edge >> 32);
  });
}

double signed_volume_m3(const Mesh& mesh) {
  if (mesh.triangles.empty()) return 0;
  // Tetrahedra from the first vertex: the sum is independent of the apex, and accurate near it.
  const Eigen::Vector3d apex = mesh.vertices[0].cast<double>();
  const auto corner = [&](int i) -> Eigen::Vector3d {
    return mesh.vertices[static_cast<size_t>(i)].cast<double>() - apex;
  };
  double six_volumes = 0;
  for (const Eigen::Vector3i& t : mesh.triangles)
    six_volumes += corner(t[0]).dot(corner(t[1]).cross(corner(t[2])));
  return six_volumes / 6;
}

}  // namespace throng
