// Triangles out of a file by assimp.
// One rule: for child processes only (base/files/sandboxed_parser.h): assimp crashes, hangs and
// reads beyond its arrays on files that are damaged in the right place.
#pragma once

#include "avatars/mesh/mesh.h"
#include "base/files/regular_file.h"

namespace throng {

/// The corners of all triangles, in the file's frame, as they come: repeated, unused, not finite.
/// Node transforms are applied, polygons split; lines and points are left out. `max_bytes` is for
/// the file and those it names. Throws ParseFailure, and whatever assimp throws.
Mesh triangles_by_assimp(const RegularFile& file, uint64_t max_bytes, size_t max_vertices,
                         size_t max_triangles);

/// 'X' or 'Y' where a Collada file states that up axis, of which triangles_by_assimp() takes no
/// notice; otherwise 0.
char ignored_up_axis(const RegularFile& file);

}  // namespace throng
