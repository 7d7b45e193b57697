// The .tri format stores a body part as vertex and triangle lists in a text file.
// Invariant: all known dialects are read, one is written, and an incomplete mesh is never returned.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "avatars/mesh/mesh.h"

namespace throng {

/// Dialect of a .tri file; printed by `throng info`.
struct TriDialect {
  bool keyword = false;  ///< starts with TRI
  bool counts_on_one_line = false;
  bool one_based = false;
  bool comments = false;
  bool crlf = false;
  bool byte_order_mark = false;
};

struct TriFile {
  Mesh mesh;
  TriDialect dialect;
};

/// Both throw InputError "file:line: expected ..., found ...".
TriFile read_tri(const std::filesystem::path& file);
TriFile parse_tri(std::string_view text, const std::string& file_name);

/// Returns the written dialect: counts before lists, 0-based, no comments. Same mesh, same bytes.
std::string format_tri(const Mesh& mesh);

}  // namespace throng
