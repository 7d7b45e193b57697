// Files named in comments and documents exist.
#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "tests/structure/source_tree.h"

namespace throng::named_files_test {
namespace {

using Names = std::set<std::string, std::less<>>;

const std::set<std::string_view> kCode = {".cpp", ".h"};
const std::set<std::string_view> kRead = {".cpp", ".h",  ".md", ".sh",   ".py",
                                          ".lcm", ".ts", ".js", ".cmake"};
const std::set<std::string_view> kNamed = {".cpp",   ".h",  ".md", ".sh",   ".py",   ".lcm",
                                           ".cmake", ".ts", ".js", ".yaml", ".urdf", ".tri"};
const Names kFolders = {"analysis",   "apps",       "avatars", "base",     "bench",
                        "cmake",      "crowd",      "culling", "docs",     "examples",
                        "geometry",   "kinematics", "lcm_io",  "lcmtypes", "python",
                        "recordings", "scenes",     "scripts", "tests",    "viewer"};
/// Files that a build generates.
const Names kMade = {"base/version.cpp"};

bool is_of_a_path(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
         std::string_view("_./+-").find(c) != std::string_view::npos;
}

/// "culling/culler.h" of "[it](../culling/culler.h)." and "culler.h" of "see culler.h".
std::vector<std::string_view> paths_in(std::string_view text) {
  std::vector<std::string_view> paths;
  for (size_t begin = 0; begin < text.size();) {
    size_t end = begin;
    while (end < text.size() && is_of_a_path(text[end])) ++end;
    std::string_view path = text.substr(begin, end - begin);
    // Patterns, placeholders and files that programs write do not name a file.
    const bool whole =
        path.find("NAME") == std::string_view::npos &&
        (begin == 0 || std::string_view("*<{}$%>").find(text[begin - 1]) == std::string_view::npos);
    begin = end + 1;
    while (path.starts_with("../")) path.remove_prefix(3);
    while (path.ends_with('.')) path.remove_suffix(1);
    if (whole && kNamed.contains(std::filesystem::path(path).extension().string()))
      paths.push_back(path);
  }
  return paths;
}

/// Comments in code; the whole line in other files.
std::string_view read_part(const SourceFile& file, std::string_view line) {
  if (!file.has_extension(kCode)) return line;
  const size_t comment = line.find("//");
  return comment == std::string_view::npos ? std::string_view() : line.substr(comment);
}

/// Whether the path exists from the top of the tree or from the folder of `from`.
bool exists(std::string_view path, const SourceFile& from) {
  const std::filesystem::path top(THRONG_SOURCE_DIR);
  return kMade.contains(path) || std::filesystem::exists(top / path) ||
         std::filesystem::exists((top / from.path).parent_path() / path);
}

TEST(NamedFiles, Exist) {
  const std::vector<SourceFile> files = read_source_tree();
  Names names;
  for (const SourceFile& file : files)
    names.insert(std::filesystem::path(file.path).filename().string());
  int seen = 0;
  for (const SourceFile& file : files) {
    // The changelog may name removed files.
    if (!file.has_extension(kRead) || file.path == "CHANGELOG.md") continue;
    for (const Line& line : lines_of(file))
      for (const std::string_view path : paths_in(read_part(file, line.text))) {
        const size_t slash = path.find('/');
        if (slash != std::string_view::npos && kFolders.contains(path.substr(0, slash))) {
          ++seen;
          EXPECT_TRUE(exists(path, file))
              << file.path << ":" << line.number << ": no file " << path;
        } else if (slash == std::string_view::npos && file.has_extension(kCode) &&
                   kCode.contains(std::filesystem::path(path).extension().string())) {
          ++seen;
          EXPECT_TRUE(names.contains(path))
              << file.path << ":" << line.number << ": no file of that name: " << path;
        }
      }
  }
  EXPECT_GT(seen, 200) << "the test no longer finds the sources";
}

TEST(NamedFiles, AreFoundInProse) {
  const std::vector<std::string_view> expected = {"culling/culler.h", "culler.cpp"};
  EXPECT_EQ(paths_in("see [it](../culling/culler.h) and culler.cpp. Not x.json, base/simd*.h"),
            expected);
}

}  // namespace
}  // namespace throng::named_files_test
