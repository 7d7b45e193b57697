#include "scenes/file/scene_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/errors.h"
#include "base/text.h"

namespace throng {
namespace {

std::optional<double> parse_decimal(std::string_view text) {
  double value = 0;
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

/// Parses a decimal or a fraction: 1/60 s has no short decimal.
std::optional<double> parse_number(std::string_view text) {
  const size_t slash = text.find('/');
  if (slash == std::string_view::npos) return parse_decimal(text);
  const auto above = parse_decimal(text.substr(0, slash));
  const auto below = parse_decimal(text.substr(slash + 1));
  if (!above || !below || *below == 0) return std::nullopt;
  return *above / *below;
}

std::string describe_range(const Range& range) {
  if (range.above_min) return fmt::format("above {} and at most {}", range.min, range.max);
  return fmt::format("from {} to {}", range.min, range.max);
}

}  // namespace

std::string describe(const YamlNode& node) {
  switch (node.kind) {
    case YamlNode::Kind::kNull:
      return "nothing";
    case YamlNode::Kind::kScalar:
      return node.scalar.size() <= 60 ? fmt::format("'{}'", node.scalar)
                                      : fmt::format("'{}...'", escaped(node.scalar.substr(0, 60)));
    case YamlNode::Kind::kList:
      return fmt::format("a list of {}", node.items.size());
    case YamlNode::Kind::kMap:
      return "a map";
  }
  return "nothing";
}

Fields::Fields(const std::string& file, const YamlNode& node, std::string what)
    : file_(file), node_(node), what_(std::move(what)) {
  if (node.kind != YamlNode::Kind::kMap)
    throw InputError(where(node), fmt::format("{} (a map of keys)", what_), describe(node));
}

std::string Fields::where(const YamlNode& node) const { return at_line(file_, node.line); }

const YamlNode* Fields::find(const std::string& key) const {
  for (const YamlEntry& entry : node_.entries)
    if (entry.key == key) return &entry.value;
  return nullptr;
}

const YamlNode& Fields::require(const std::string& key) const {
  const YamlNode* node = find(key);
  if (node != nullptr) return *node;
  throw InputError(where(node_), fmt::format("the key '{}' in {}", key, what_), "none");
}

std::string Fields::text(const std::string& key) const {
  const YamlNode& node = require(key);
  if (node.kind != YamlNode::Kind::kScalar || node.scalar.empty())
    throw InputError(where(node), fmt::format("a text for '{}'", key), describe(node));
  return node.scalar;
}

std::string Fields::name_or(const std::string& key, const std::string& fallback) const {
  const YamlNode* node = find(key);
  if (node == nullptr) return fallback;
  std::string name = text(key);
  const std::string defect = defect_of_name(name);
  if (!defect.empty())
    throw InputError(where(*node),
                     fmt::format("a name of 1 to {} printable bytes for '{}'", kMaxNameBytes, key),
                     defect);
  return name;
}

std::string Fields::line_or(const std::string& key, const std::string& fallback) const {
  if (find(key) == nullptr) return fallback;
  std::string line = text(key);
  while (!line.empty() && line.back() == '\n') line.pop_back();
  for (char& c : line)
    if (c == '\n' || c == '\t') c = ' ';
  return line;
}

double Fields::to_number(const std::string& key, const YamlNode& node, const Range& range) const {
  std::optional<double> value;
  if (node.kind == YamlNode::Kind::kScalar && !node.quoted) value = parse_number(node.scalar);
  if (!value) throw InputError(where(node), fmt::format("a number for '{}'", key), describe(node));
  if (*value > range.max || *value < range.min || (range.above_min && *value == range.min))
    throw InputError(where(node), fmt::format("'{}' {}", key, describe_range(range)), node.scalar);
  return *value;
}

double Fields::number(const std::string& key, const Range& range) const {
  return to_number(key, require(key), range);
}

double Fields::number_or(const std::string& key, const Range& range, double fallback) const {
  const YamlNode* node = find(key);
  return node == nullptr ? fallback : to_number(key, *node, range);
}

int64_t Fields::integer_or(const std::string& key, int64_t min, int64_t max,
                           int64_t fallback) const {
  const YamlNode* node = find(key);
  if (node == nullptr) return fallback;
  int64_t value = 0;
  const std::string& text = node->scalar;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_integer = node->kind == YamlNode::Kind::kScalar && !node->quoted &&
                          end == text.data() + text.size() && !text.empty() &&
                          error != std::errc::invalid_argument;
  if (!is_integer || error == std::errc::result_out_of_range || value < min || value > max)
    throw InputError(where(*node),
                     fmt::format("a whole number from {} to {} for '{}'", min, max, key),
                     describe(*node));
  return value;
}

bool Fields::boolean_or(const std::string& key, bool fallback) const {
  const YamlNode* node = find(key);
  if (node == nullptr) return fallback;
  if (node->scalar == "true" && !node->quoted) return true;
  if (node->scalar == "false" && !node->quoted) return false;
  throw InputError(where(*node), fmt::format("true or false for '{}'", key), describe(*node));
}

std::vector<double> Fields::numbers(const std::string& key, int count, const Range& range) const {
  const YamlNode& node = require(key);
  if (node.kind != YamlNode::Kind::kList || node.items.size() != static_cast<size_t>(count))
    throw InputError(where(node), fmt::format("a list of {} numbers for '{}'", count, key),
                     describe(node));
  std::vector<double> values;
  for (const YamlNode& item : node.items) values.push_back(to_number(key, item, range));
  return values;
}

std::vector<Eigen::Vector2d> Fields::points(const std::string& key, size_t min,
                                            const Range& range) const {
  return to_points(key, require(key), min, range);
}

std::vector<Eigen::Vector3d> Fields::triples(const std::string& key, size_t min,
                                             const Range& range) const {
  const YamlNode& node = require(key);
  if (node.kind != YamlNode::Kind::kList || node.items.size() < min)
    throw InputError(where(node),
                     fmt::format("a list of at least {} times three numbers for '{}'", min, key),
                     describe(node));
  std::vector<Eigen::Vector3d> triples;
  for (const YamlNode& item : node.items) {
    if (item.kind != YamlNode::Kind::kList || item.items.size() != 3)
      throw InputError(where(item), fmt::format("three numbers in each item of '{}'", key),
                       describe(item));
    Eigen::Vector3d& triple = triples.emplace_back();
    for (int i = 0; i < 3; ++i)
      triple[i] = to_number(key, item.items[static_cast<size_t>(i)], range);
  }
  return triples;
}

std::vector<std::vector<Eigen::Vector2d>> Fields::rings(const std::string& key,
                                                        const Range& range) const {
  const YamlNode& node = require(key);
  if (node.kind != YamlNode::Kind::kList)
    throw InputError(where(node), fmt::format("a list of rings for '{}'", key), describe(node));
  std::vector<std::vector<Eigen::Vector2d>> rings;
  for (const YamlNode& item : node.items) rings.push_back(to_points(key, item, 3, range));
  return rings;
}

std::vector<Eigen::Vector2d> Fields::to_points(const std::string& key, const YamlNode& node,
                                               size_t min, const Range& range) const {
  if (node.kind != YamlNode::Kind::kList || node.items.size() < min)
    throw InputError(where(node), fmt::format("a list of at least {} points for '{}'", min, key),
                     describe(node));
  std::vector<Eigen::Vector2d> points;
  for (const YamlNode& item : node.items) {
    if (item.kind != YamlNode::Kind::kList || item.items.size() != 2)
      throw InputError(where(item), fmt::format("a point [x, y] in '{}'", key), describe(item));
    points.emplace_back(to_number(key, item.items[0], range), to_number(key, item.items[1], range));
  }
  return points;
}

void Fields::expect_keys(const std::vector<std::string>& keys) const {
  for (const YamlEntry& entry : node_.entries)
    if (std::find(keys.begin(), keys.end(), entry.key) == keys.end())
      throw InputError(at_line(file_, entry.line), fmt::format("a key of {}", what_),
                       fmt::format("'{}'{}", entry.key, did_you_mean(entry.key, keys)));
}

std::optional<size_t> Fields::word(const std::string& key,
                                   const std::vector<std::string>& words) const {
  const YamlNode* node = find(key);
  if (node == nullptr) return std::nullopt;
  const auto found = std::find(words.begin(), words.end(), node->scalar);
  if (node->kind != YamlNode::Kind::kScalar || found == words.end())
    throw InputError(where(*node), fmt::format("{}: {}", key, list_of(words, " or ")),
                     describe(*node) + did_you_mean(node->scalar, words));
  return static_cast<size_t>(found - words.begin());
}

std::vector<const YamlNode*> Fields::items(const std::string& key, bool required) const {
  std::vector<const YamlNode*> items;
  const YamlNode* node = required ? &require(key) : find(key);
  if (node == nullptr) return items;
  if (node->kind != YamlNode::Kind::kList || (required && node->items.empty()))
    throw InputError(where(*node), fmt::format("a list for '{}'", key), describe(*node));
  for (const YamlNode& item : node->items) items.push_back(&item);
  return items;
}

std::string list_of(const std::vector<std::string>& words, std::string_view before_last) {
  std::string text;
  for (size_t i = 0; i < words.size(); ++i) {
    if (i > 0) text += i + 1 < words.size() ? ", " : before_last;
    text += words[i];
  }
  return text;
}

}  // namespace throng
