// read_mesh() reads mesh files: .tri directly, other formats with assimp in a separate process.
// Invariant: the mesh is finite, welded and in range, in the file's frame and unit (metres unless
// the format states another).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "avatars/mesh/mesh.h"
#include "base/files/sandboxed_parser.h"

namespace throng {

/// Axis of a mesh file that points up.
enum class UpAxis : uint8_t { kX, kY, kZ };

/// Applies node transforms, splits polygons and merges equal vertices; drops colours, normals and
/// lines. `limits`: of assimp's process. `notes`: one line per ignored statement. Throws
/// InputError.
Mesh read_mesh(const std::filesystem::path& file, const SandboxLimits& limits = {},
               std::vector<std::string>* notes = nullptr);

/// Reads a mesh like read_mesh(), turns it upright and multiplies it by `scale`, metres per unit of
/// the file. The file's axis `up` points up. Without `up`, this is the axis that a Collada
/// file states or the format defines (glTF, VRML and X3D: y), otherwise z. Turned as in Collada:
/// with y up, x stays x; with x up, -y becomes x. Throws InputError.
Mesh read_upright_mesh(const std::filesystem::path& file, float scale, std::optional<UpAxis> up);

}  // namespace throng
