// Typed reading of a YAML map.
// One rule: every complaint names file:line, what was expected and what was found.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/limits.h"
#include "scenes/file/yaml_tree.h"

namespace throng {

/// What a number must satisfy, and how to say so.
struct Range {
  double min = 0;
  double max = 0;
  bool above_min = false;  ///< min itself is excluded
};

/// One map of the file.
class Fields {
 public:
  /// `what` names the map in messages: "a group".
  Fields(const std::string& file, const YamlNode& node, std::string what);

  /// Throws for the first key that is not among these, with a did-you-mean: a misspelt key is worth
  /// naming before the absence of the right one.
  void expect_keys(const std::vector<std::string>& keys) const;

  /// The value of a key, or null if it is absent.
  const YamlNode* find(const std::string& key) const;
  const YamlNode& require(const std::string& key) const;

  std::string text(const std::string& key) const;
  /// A text that defect_of_name() passes; the fallback is not checked.
  std::string name_or(const std::string& key, const std::string& fallback) const;
  /// Text as one line: breaks and tabs become blanks.
  std::string line_or(const std::string& key, const std::string& fallback) const;
  double number(const std::string& key, const Range& range) const;
  double number_or(const std::string& key, const Range& range, double fallback) const;
  int64_t integer_or(const std::string& key, int64_t min, int64_t max, int64_t fallback) const;
  bool boolean_or(const std::string& key, bool fallback) const;
  /// `count` numbers in a list.
  std::vector<double> numbers(const std::string& key, int count, const Range& range) const;
  /// At least `least` points in a list, each a list of two numbers.
  std::vector<Eigen::Vector2d> points(const std::string& key, size_t min, const Range& range) const;
  /// Which of the words stands there; none if the key is absent.
  std::optional<size_t> word(const std::string& key, const std::vector<std::string>& words) const;
  /// The items of a list; none if the key is absent. A required list has at least one.
  std::vector<const YamlNode*> items(const std::string& key, bool required) const;

  int line() const { return node_.line; }
  /// "file:line" of the map itself.
  std::string where() const { return where(node_); }
  std::string where(const YamlNode& node) const;
  const std::string& file() const { return file_; }
  const YamlNode& node() const { return node_; }

 private:
  double to_number(const std::string& key, const YamlNode& node, const Range& range) const;

  const std::string& file_;
  const YamlNode& node_;
  std::string what_;
};

/// What stands there, for messages: "'abc'", "a list", "nothing".
std::string describe(const YamlNode& node);

/// "a, b or c", "a, b".
std::string list_of(const std::vector<std::string>& words, std::string_view before_last = ", ");

}  // namespace throng
