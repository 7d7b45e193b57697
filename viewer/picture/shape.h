// Shape is a mesh prepared for drawing; simplified() and sleeve() make coarser meshes of it.
// Invariant: a coarser mesh stays near its original, and a sleeve is closed.
#pragma once

#include <cstdint>
#include <vector>

#include "avatars/mesh/mesh.h"

namespace throng {

/// Mesh with a unit normal per vertex and a bounding sphere, in metres.
struct Shape {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<Eigen::Vector3f> normals;
  std::vector<Eigen::Vector3i> triangles;  ///< counter-clockwise seen from outside
  std::vector<uint8_t>
      is_second;  ///< per vertex: whether it has the second colour; empty: none has
  Eigen::Vector3f centre = Eigen::Vector3f::Zero();
  float radius = 0;
};

enum class Edges {
  kSharp,  ///< the faces at a sharp edge do not share their light
  kSmooth
};

/// A point cloud gives an empty shape.
Shape shape_of(const Mesh& mesh, Edges edges = Edges::kSharp);

/// Clusters vertices (Rossignac and Borrel 1993): those of a cubic cell become their mean, and
/// collapsed triangles are omitted.
Mesh simplified(const Mesh& mesh, float cell_m);

/// Returns a closed tube around the mesh, along the longest axis of its box: `rings` polygons of
/// `sides` corners each; rings >= 2, sides >= 3. Clustering tears limbs apart that are as thin
/// as a cell; a sleeve stays whole.
Mesh sleeve(const Mesh& mesh, int rings, int sides);

}  // namespace throng
