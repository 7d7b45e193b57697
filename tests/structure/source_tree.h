// The files of the repository as text, for tests about the code itself.
// One rule: paths are relative to the repository and sorted, so that messages are the same
// everywhere.
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace throng {

struct SourceFile {
  std::string path;  ///< "culling/volumes/slabs.cpp"
  std::string text;

  std::string folder() const;  ///< "culling"; of "tests/culling/culler_test.cpp" too
  bool is_test() const { return path.starts_with("tests/"); }
  bool has_extension(const std::set<std::string_view>& extensions) const;
};

/// All text files of the folders that the project consists of; build outputs are none of them.
std::vector<SourceFile> read_source_tree();

struct Line {
  int number = 0;  ///< from 1
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
