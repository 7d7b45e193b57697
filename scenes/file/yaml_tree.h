// parse_yaml() reads a YAML file into a tree of nodes with line numbers.
// Anchors, aliases, tags, several documents, duplicate keys, deep nesting and large files are
// rejected: a small file cannot become a large tree.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace throng {

/// A scene takes some kilobytes; ten thousand obstacles take about 1 MiB.
inline constexpr size_t kMaxYamlBytes = size_t{4} << 20;
/// Scenes nest five levels deep (groups, group, goals, goal, corner).
inline constexpr int kMaxYamlDepth = 16;
/// The longest map has about twenty keys; the search for duplicates is quadratic in their number.
inline constexpr size_t kMaxYamlKeys = 64;

struct YamlEntry;

struct YamlNode {
  enum class Kind { kNull, kScalar, kList, kMap };
  Kind kind = Kind::kNull;
  int line = 0;
  std::string scalar;              ///< kScalar
  bool quoted = false;             ///< kScalar: quoted text is not parsed as a number
  std::vector<YamlNode> items;     ///< kList
  std::vector<YamlEntry> entries;  ///< kMap: in the order of the file, without duplicates
};

struct YamlEntry {
  std::string key;
  int line = 0;
  YamlNode value;
};

/// Throws InputError "name:line: expected ..., found ...".
YamlNode parse_yaml(const std::string& text, const std::string& name);

/// Reads a text file. Throws InputError for a directory, a missing file or one above `max_bytes`.
std::string read_text_file(const std::filesystem::path& file, size_t max_bytes);

}  // namespace throng
