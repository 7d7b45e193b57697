// The .tri format: a body part as vertex and triangle lists in a text file.
// One rule: reads every dialect that is out there, writes only one, never returns half a mesh.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "avatars/mesh/mesh.h"

namespace throng {

/// Which of the forms a .tri file was written in; `throng info` prints it.
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

/// Throws InputError "file:line: expected ..., found ...".
TriFile read_tri(const std::filesystem::path& file);
TriFile parse_tri(std::string_view text, const std::string& file_name);

/// Counts-then-lists, 0-based, no comments: the form Throng writes. Same mesh, same bytes.
std::string format_tri(const Mesh& mesh);

}  // namespace throng
