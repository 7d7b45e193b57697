// Mesh files of any format: .tri by our own reader, the rest by assimp.
// One rule: what comes back is finite, welded and in range, in the file's own frame and unit
// (metres unless the format states another).
#pragma once

#include <filesystem>

#include "avatars/mesh.h"

namespace throng {

/// Applies the file's node transforms, splits polygons into triangles and joins equal vertices;
/// drops colours, normals, lines. Throws InputError naming the file.
Mesh read_mesh(const std::filesystem::path& file);

}  // namespace throng
