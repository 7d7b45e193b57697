// Mesh files of any format: .tri by our own reader, the rest by assimp in a process of its own.
// One rule: what comes back is finite, welded and in range, in the file's own frame and unit
// (metres unless the format states another).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "avatars/mesh/mesh.h"
#include "base/files/sandboxed_parser.h"

namespace throng {

/// Applies the file's node transforms, splits polygons into triangles and joins equal vertices;
/// drops colours, normals, lines. `limits` are those of assimp's process. What the file states and
/// is not honoured is added to `notes`, a line each. Throws InputError naming the file, whatever
/// its bytes are.
Mesh read_mesh(const std::filesystem::path& file, const SandboxLimits& limits = {},
               std::vector<std::string>* notes = nullptr);

}  // namespace throng
