// triangles_by_assimp() reads triangles from a file with assimp.
// Invariant: called in child processes only (base/files/sandboxed_parser.h). On damaged files
// assimp may crash, hang or read beyond its arrays.
#pragma once

#include "avatars/mesh/mesh.h"
#include "base/files/regular_file.h"

namespace throng {

/// Returns the corners of all triangles in the file's frame, unprocessed: maybe repeated, unused or
/// not finite. Node transforms are applied, polygons split; lines and points are dropped.
/// `max_bytes` limits the file plus those it names. Throws ParseFailure and any exception of
/// assimp.
Mesh triangles_by_assimp(const RegularFile& file, uint64_t max_bytes, size_t max_vertices,
                         size_t max_triangles);

/// Returns 'X' or 'Y' for an up axis that a Collada file states and that is ignored; otherwise 0.
char ignored_up_axis(const RegularFile& file);

}  // namespace throng
