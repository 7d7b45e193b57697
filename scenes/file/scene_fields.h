// Typed reading of a YAML map: every key is asked for once, what nobody asked for is an error.
// One rule: every complaint names file:line, what was expected and what was found.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/limits.h"
#include "scenes/file/scene.h"
#include "scenes/file/yaml_tree.h"

namespace throng {

/// What a number must satisfy, and how to say so.
struct Range {
  double min = 0;
  double max = 0;
  bool above_min = false;  ///< min itself is excluded
};

/// One map of the file. Read the keys, then call done().
class Fields {
 public:
  /// `what` names the map in messages: "a group".
  Fields(const std::string& file, const YamlNode& node, std::string what);

  /// Throws for the first key that is not among these, with a did-you-mean: a misspelt key is worth
  /// naming before the absence of the right one.
  void expect_keys(const std::vector<std::string>& keys) const;

  /// The value of a key, or null if it is absent. Marks the key as known.
  const YamlNode* find(const std::string& key);
  const YamlNode& require(const std::string& key);

  std::string text(const std::string& key);
  std::string text_or(const std::string& key, const std::string& fallback);
  /// A text that defect_of_name() passes; the fallback is not checked.
  std::string name_or(const std::string& key, const std::string& fallback);
  /// Text as one line: breaks and tabs become blanks.
  std::string line_or(const std::string& key, const std::string& fallback);
  double number(const std::string& key, const Range& range);
  double number_or(const std::string& key, const Range& range, double fallback);
  int64_t integer_or(const std::string& key, int64_t min, int64_t max,
                     std::optional<int64_t> fallback);
  bool boolean_or(const std::string& key, bool fallback);
  /// `count` numbers in a list.
  std::vector<double> numbers(const std::string& key, int count, const Range& range);

  /// Throws for the first key that nobody asked for, with a did-you-mean.
  void done() const;

  int line() const { return node_.line; }
  std::string where(const YamlNode& node) const;
  const std::string& file() const { return file_; }

 private:
  double to_number(const std::string& key, const YamlNode& node, const Range& range) const;

  const std::string& file_;
  const YamlNode& node_;
  std::string what_;
  std::vector<std::string> known_;
};

/// What stands there, for messages: "'abc'", "a list", "nothing".
std::string describe(const YamlNode& node);

/// {min_m: [x, y], max_m: [x, y]} with min below max, coordinates within kMaxCoordinate_m.
Rectangle read_rectangle(const std::string& file, const YamlNode& node, const std::string& what);

/// The same from a map that has other keys, too.
Rectangle read_rectangle(Fields& fields, const std::string& what);

/// {mean, deviation, min, max}, each optional, or one number for everybody.
Distribution read_distribution(const std::string& file, const YamlNode& node,
                               const std::string& what, const Distribution& fallback,
                               const Range& range);

}  // namespace throng
