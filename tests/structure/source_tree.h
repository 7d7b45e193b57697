// read_source_tree() reads the files of the repository as text, for tests about the code.
// Invariant: paths are relative to the repository and sorted; messages are the same everywhere.
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace throng {

struct SourceFile {
  std::string path;  ///< "culling/volumes/slabs.cpp"
  std::string text;

  std::string folder() const;  ///< "culling", for "tests/culling/culler_test.cpp" as well
  bool is_test() const { return path.starts_with("tests/"); }
  bool has_extension(const std::set<std::string_view>& extensions) const;
};

/// All text files of the project's folders, without build outputs.
std::vector<SourceFile> read_source_tree();

struct Line {
  int number = 0;  ///< counted from 1
  std::string_view text;
};
std::vector<Line> lines_of(const SourceFile& file);

struct Include {
  int line = 0;
  std::string path;     ///< between the brackets or quotes
  bool angled = false;  ///< <...>
};
std::vector<Include> includes_of(const SourceFile& file);

}  // namespace throng
