// Fields reads typed values from a YAML map.
// Invariant: errors name file:line, the expected and the found value.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/limits.h"
#include "scenes/file/yaml_tree.h"

namespace throng {

struct Range {
  double min = 0;
  double max = 0;
  bool above_min = false;  ///< min is excluded
};

/// A map of a scene file. Keeps references to the file name and the node.
class Fields {
 public:
  /// `what` names the map in messages: "a group".
  Fields(const std::string& file, const YamlNode& node, std::string what);

  /// Throws InputError for the first unknown key, with a suggestion. Called before require(),
  /// because a misspelt key explains a missing one.
  void expect_keys(const std::vector<std::string>& keys) const;

  const YamlNode* find(const std::string& key) const;
  const YamlNode& require(const std::string& key) const;

  std::string text(const std::string& key) const;
  /// Text that defect_of_name() accepts; the fallback is not checked.
  std::string name_or(const std::string& key, const std::string& fallback) const;
  /// Text as one line: line breaks and tabs become blanks.
  std::string line_or(const std::string& key, const std::string& fallback) const;
  double number(const std::string& key, const Range& range) const;
  double number_or(const std::string& key, const Range& range, double fallback) const;
  int64_t integer_or(const std::string& key, int64_t min, int64_t max, int64_t fallback) const;
  bool boolean_or(const std::string& key, bool fallback) const;
  std::vector<double> numbers(const std::string& key, int count, const Range& range) const;
  /// List of at least `min` points, each a list of two numbers.
  std::vector<Eigen::Vector2d> points(const std::string& key, size_t min, const Range& range) const;
  /// List of at least `min` lists of three numbers.
  std::vector<Eigen::Vector3d> triples(const std::string& key, size_t min,
                                       const Range& range) const;
  /// List of lists of at least three points.
  std::vector<std::vector<Eigen::Vector2d>> rings(const std::string& key, const Range& range) const;
  /// Index of the word at this key; empty if the key is absent.
  std::optional<size_t> word(const std::string& key, const std::vector<std::string>& words) const;
  /// Items of a list; empty if the key is absent. A required list has at least one item.
  std::vector<const YamlNode*> items(const std::string& key, bool required) const;

  int line() const { return node_.line; }
  std::string where() const { return where(node_); }
  std::string where(const YamlNode& node) const;
  const std::string& file() const { return file_; }
  const YamlNode& node() const { return node_; }

 private:
  std::vector<Eigen::Vector2d> to_points(const std::string& key, const YamlNode& node, size_t min,
                                         const Range& range) const;
  double to_number(const std::string& key, const YamlNode& node, const Range& range) const;

  const std::string& file_;
  const YamlNode& node_;
  std::string what_;
};

/// Value of a node for messages: "'abc'", "a list of 3", "nothing".
std::string describe(const YamlNode& node);

std::string list_of(const std::vector<std::string>& words, std::string_view before_last = ", ");

}  // namespace throng
