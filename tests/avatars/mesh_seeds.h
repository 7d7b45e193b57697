// One shape in many formats (tests/avatars/fixtures/meshes), written by hand or by assimp's
// exporter: what tests of mesh files read, and damage.
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

/// In order of their names. A tetrahedron and a pyramid beside it: 9 vertices, 10 triangles; but
/// "md5mesh" is a triangle.
std::vector<MeshSeed> mesh_seeds();

}  // namespace throng
