// mesh_seeds() returns one shape in many formats (tests/avatars/fixtures/meshes).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace throng {

struct MeshSeed {
  std::string name;       ///< "ply_binary"
  std::string extension;  ///< ".ply"
  std::vector<uint8_t> bytes;
};

/// Sorted by name. A tetrahedron and a pyramid: 9 vertices, 10 triangles; "md5mesh": a triangle.
std::vector<MeshSeed> mesh_seeds();

}  // namespace throng
