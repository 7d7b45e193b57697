// A YAML file as a tree in which every node knows its line.
// One rule: what a scene never needs (anchors, aliases, tags, several documents, duplicate keys,
// deep nesting, huge files) is refused while parsing, so that a small file cannot become a big
// tree.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace throng {

/// A scene is some kilobytes; ten thousand written-out obstacles are about 1 MiB.
inline constexpr size_t kMaxYamlBytes = size_t{4} << 20;
/// A scene nests five deep (groups, group, goals, goal, corner).
inline constexpr int kMaxYamlDepth = 16;
/// The longest map of a scene has a dozen keys; the search for a duplicate is quadratic in them.
inline constexpr size_t kMaxYamlKeys = 64;

struct YamlEntry;

struct YamlNode {
  enum class Kind { kNull, kScalar, kList, kMap };
  Kind kind = Kind::kNull;
  int line = 0;                    ///< counted from 1
  std::string scalar;              ///< kScalar
  bool quoted = false;             ///< kScalar: quoted text is never a number
  std::vector<YamlNode> items;     ///< kList
  std::vector<YamlEntry> entries;  ///< kMap, in the file's order, no key twice
};

struct YamlEntry {
  std::string key;
  int line = 0;
  YamlNode value;
};

/// Throws InputError "name:line: expected ..., found ...".
YamlNode parse_yaml(const std::string& text, const std::string& name);

/// Reads the file first: a directory, a missing or an oversized file is an InputError too.
std::string read_text_file(const std::filesystem::path& file, size_t max_bytes);

}  // namespace throng
