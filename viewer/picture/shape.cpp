#include "viewer/picture/shape.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

namespace throng {
namespace {

/// An edge is sharp from this angle between its faces (cosine).
constexpr float kSharpEdge = 0.77F;  // 40 degrees
constexpr float kEqual = 0.98F;      // cosine of normals whose light looks equal: 11 degrees

Eigen::Vector3f face_normal(const Mesh& mesh, const Eigen::Vector3i& t) {
  const auto at = [&](int i) { return mesh.vertices[static_cast<size_t>(t[i])]; };
  return (at(1) - at(0)).cross(at(2) - at(0));
}

/// Angle of a triangle at its corner i.
float angle_at(const Mesh& mesh, const Eigen::Vector3i& t, int i) {
  const auto at = [&](int corner) { return mesh.vertices[static_cast<size_t>(t[corner % 3])]; };
  const Eigen::Vector3f u = at(i + 1) - at(i), v = at(i + 2) - at(i);
  return std::atan2(u.cross(v).norm(), u.dot(v));
}

/// Normals weighted by the angle of each triangle at a vertex: how a flat face is divided changes
/// nothing (Thuermer and Wuethrich 1998).
using WeightedNormals = std::vector<Eigen::Vector3f>;

std::vector<WeightedNormals> normals_by_vertex(const Mesh& mesh) {
  std::vector<WeightedNormals> normals(mesh.vertices.size());
  for (const Eigen::Vector3i& t : mesh.triangles)
    for (int i = 0; i < 3; ++i)
      normals[static_cast<size_t>(t[i])].push_back(angle_at(mesh, t, i) *
                                                   face_normal(mesh, t).normalized());
  return normals;
}

/// Returns the mean of the normals that differ from `face` by less than a sharp edge.
Eigen::Vector3f smooth_normal(const WeightedNormals& normals, const Eigen::Vector3f& face,
                              Edges edges) {
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (const Eigen::Vector3f& normal : normals)
    if (edges == Edges::kSmooth || face.dot(normal) >= kSharpEdge * normal.norm()) sum += normal;
  return sum.normalized();
}

Eigen::AlignedBox3f box_of(const std::vector<Eigen::Vector3f>& points) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& p : points) box.extend(p);
  return box;
}

/// Gives each corner its normal. A vertex has copies for normals that differ.
void add_corners(const Mesh& mesh, Edges edges, Shape& shape) {
  const std::vector<WeightedNormals> normals = normals_by_vertex(mesh);
  std::vector<std::vector<int>> copies(mesh.vertices.size());
  for (Eigen::Vector3i t : mesh.triangles) {
    const Eigen::Vector3f face = face_normal(mesh, t).normalized();
    for (int i = 0; i < 3; ++i) {
      const auto vertex = static_cast<size_t>(t[i]);
      const Eigen::Vector3f normal = smooth_normal(normals[vertex], face, edges);
      const auto same = std::find_if(copies[vertex].begin(), copies[vertex].end(), [&](int copy) {
        return shape.normals[static_cast<size_t>(copy)].dot(normal) > kEqual;
      });
      t[i] = same != copies[vertex].end() ? *same : static_cast<int>(shape.vertices.size());
      if (same != copies[vertex].end()) continue;
      copies[vertex].push_back(t[i]);
      shape.vertices.push_back(mesh.vertices[vertex]);
      shape.normals.push_back(normal);
    }
    shape.triangles.push_back(t);
  }
}

/// Width of a mesh across an axis, one per ring along it.
std::vector<Eigen::AlignedBox3f> spans_of(const Mesh& mesh, const Eigen::AlignedBox3f& box,
                                          int along, int rings) {
  std::vector<Eigen::AlignedBox3f> spans(static_cast<size_t>(rings));
  const float length = std::max(1e-9F, box.sizes()[along]);
  for (const Eigen::Vector3f& p : mesh.vertices) {
    const float share = (p[along] - box.min()[along]) / length;
    spans[static_cast<size_t>(std::lround(share * static_cast<float>(rings - 1)))].extend(p);
  }
  // A ring without a vertex repeats the previous one; both end rings have vertices.
  for (size_t ring = 1; ring < spans.size(); ++ring)
    if (spans[ring].isEmpty()) spans[ring] = spans[ring - 1];
  return spans;
}

std::vector<Eigen::Vector3i> sleeve_triangles(int rings, int sides) {
  std::vector<Eigen::Vector3i> triangles;
  for (int ring = 0; ring + 1 < rings; ++ring)
    for (int side = 0; side < sides; ++side) {
      const int a = ring * sides + side, b = ring * sides + (side + 1) % sides;
      triangles.emplace_back(a, b, b + sides);
      triangles.emplace_back(a, b + sides, a + sides);
    }
  const int last = (rings - 1) * sides;
  for (int side = 1; side + 1 < sides; ++side) {
    triangles.emplace_back(0, side + 1, side);
    triangles.emplace_back(last, last + side, last + side + 1);
  }
  return triangles;
}

}  // namespace

Shape shape_of(const Mesh& mesh, Edges edges) {
  Shape shape;
  if (mesh.is_point_cloud()) return shape;
  add_corners(mesh, edges, shape);
  shape.centre = box_of(mesh.vertices).center();
  for (const Eigen::Vector3f& p : mesh.vertices)
    shape.radius = std::max(shape.radius, (p - shape.centre).norm());
  return shape;
}

Mesh simplified(const Mesh& mesh, float cell_m) {
  Mesh coarse;
  std::map<std::array<int64_t, 3>, int> cells;
  std::vector<int> cell_of;
  std::vector<float> counts;
  for (const Eigen::Vector3f& p : mesh.vertices) {
    std::array<int64_t, 3> key;
    for (int i = 0; i < 3; ++i) key[static_cast<size_t>(i)] = std::llround(p[i] / cell_m);
    const auto [at, is_new] = cells.try_emplace(key, static_cast<int>(cells.size()));
    if (is_new) coarse.vertices.emplace_back(Eigen::Vector3f::Zero());
    if (is_new) counts.push_back(0);
    coarse.vertices[static_cast<size_t>(at->second)] += p;
    ++counts[static_cast<size_t>(at->second)];
    cell_of.push_back(at->second);
  }
  for (size_t cell = 0; cell < counts.size(); ++cell) coarse.vertices[cell] /= counts[cell];
  std::set<std::array<int, 3>> seen;
  for (const Eigen::Vector3i& t : mesh.triangles) {
    std::array<int, 3> cell;
    for (int i = 0; i < 3; ++i) cell[static_cast<size_t>(i)] = cell_of[static_cast<size_t>(t[i])];
    if (cell[0] == cell[1] || cell[1] == cell[2] || cell[2] == cell[0]) continue;
    std::rotate(cell.begin(), std::min_element(cell.begin(), cell.end()), cell.end());
    if (seen.insert(cell).second) coarse.triangles.emplace_back(cell[0], cell[1], cell[2]);
  }
  return coarse;
}

Mesh sleeve(const Mesh& mesh, int rings, int sides) {
  assert(rings >= 2 && sides >= 3);
  const Eigen::AlignedBox3f box = box_of(mesh.vertices);
  int along = 0;
  box.sizes().maxCoeff(&along);
  const int u = (along + 1) % 3, v = (along + 2) % 3;
  const std::vector<Eigen::AlignedBox3f> spans = spans_of(mesh, box, along, rings);
  // The polygon has the area of the ellipse that it replaces.
  const double turn = 2 * std::numbers::pi / sides;
  const auto wider = static_cast<float>(std::sqrt(turn / std::sin(turn)));
  Mesh tube;
  for (int ring = 0; ring < rings; ++ring) {
    const Eigen::AlignedBox3f& span = spans[static_cast<size_t>(ring)];
    const float share = static_cast<float>(ring) / static_cast<float>(rings - 1);
    for (int side = 0; side < sides; ++side) {
      const auto angle = static_cast<float>(turn * (side + 0.5));
      Eigen::Vector3f p = span.center();
      p[along] = box.min()[along] + share * box.sizes()[along];
      p[u] += 0.5F * wider * std::cos(angle) * span.sizes()[u];
      p[v] += 0.5F * wider * std::sin(angle) * span.sizes()[v];
      tube.vertices.push_back(p);
    }
  }
  tube.triangles = sleeve_triangles(rings, sides);
  return tube;
}

}  // namespace throng
