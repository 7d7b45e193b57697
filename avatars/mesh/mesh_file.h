// read_mesh() reads mesh files: .tri directly, other formats with assimp in a separate process.
// Invariant: the mesh is finite, welded and in range, in the file's frame and unit (metres unless
// the format states another).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "avatars/mesh/mesh.h"
#include "base/files/sandboxed_parser.h"

namespace throng {

/// Applies node transforms, splits polygons and merges equal vertices; drops colours, normals and
/// lines. `limits`: of assimp's process. `notes`: one line per ignored statement. Throws
/// InputError.
Mesh read_mesh(const std::filesystem::path& file, const SandboxLimits& limits = {},
               std::vector<std::string>* notes = nullptr);

}  // namespace throng
