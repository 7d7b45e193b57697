// Key describes a key of a map in a scene file: meaning, allowed values, reader and content hash.
// Invariant: a key is one row of one table; reader, content hash, JSON Schema and documentation
// follow from it.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/checksum.h"
#include "scenes/file/scene.h"
#include "scenes/file/scene_fields.h"

namespace throng {

struct Rule {
  enum class Kind : uint8_t {
    kText,
    kWhole,
    kNumber,
    kFlag,
    kWord,
    kNumbers,
    kPoints,
    kRings,
    kVertices,
    kTriangles,
    kMap,
    kList
  };
  Kind kind = Kind::kText;
  Range range{};  ///< kNumber; each number of kNumbers; coordinates of the following
  /// kWhole: the value; each of kRings, and other lists: the length, `max` 0: unlimited.
  int64_t min = 0, max = 0;
  std::vector<std::string> words = {};
  std::string map = {};      ///< kMap, each item of kList: name of the map in scene_maps()
  std::string pattern = {};  ///< kText: regular expression, empty: any text
};

/// Documentation of a key, in Markdown, for the reference pages and the JSON Schema.
struct KeyText {
  std::string name;
  std::string meaning;
  std::string fallback;  ///< value without the key: "10", "by age", "required"
  bool required = false;
  Rule rule;
};

struct MapText {
  std::string name;
  std::string meaning;  ///< "Agents with one body model"
  std::vector<KeyText> keys = {};
  /// Alternative sets of keys, one of which has to be complete; empty: no such condition.
  std::vector<std::vector<std::string>> choices = {};
  bool or_number = false;                  ///< a single number may replace the map
  bool or_points = false;                  ///< a list of points may replace the map
  std::vector<std::string> or_words = {};  ///< words that may replace the map
  std::vector<std::string> any_key = {};   ///< values that any other key accepts
  bool at_least_one = false;               ///< an empty map is an error
};

using LoadedModels = std::map<std::string, std::shared_ptr<const Model>>;

/// State shared by the readers of keys: the scene read so far and its models.
struct ReadContext {
  std::filesystem::path folder;
  Scene scene;
  LoadedModels bodies;
  std::set<std::string> group_names;
  std::set<std::string> obstacle_names;
  std::set<std::string> door_names;
  /// Meshes of obstacles by file, scale and up axis: a file is parsed once for many chairs.
  std::map<std::string, Mesh> meshes;
  /// Triggers and their places in the file ("file:line").
  std::vector<std::pair<std::string, TriggerRule>> triggers;
  /// Goals with a queue and their places in the file ("file:line").
  std::vector<std::pair<std::string, Goal>> queued_goals;
  int64_t people = 0;
  /// Locates points on the floor; made when an area first needs it.
  std::optional<PolygonLocator> floor_locator;
  /// Pieces of polygons and walls after the first.
  std::vector<Obstacle> more_obstacles;
  uint32_t surfaces = 0;  ///< numbers of Obstacle::surface in use
};

inline void add_value(Hasher& hash, bool value) { hash.add(uint64_t{value}); }
inline void add_value(Hasher& hash, int value) { hash.add(static_cast<uint64_t>(value)); }
inline void add_value(Hasher& hash, uint64_t value) { hash.add(value); }
inline void add_value(Hasher& hash, double value) { hash.add(value); }
inline void add_value(Hasher& hash, const std::string& value) { hash.add(value); }
inline void add_value(Hasher& hash, const std::vector<Polygon>& polygons) {
  const auto add = [&](const Polygon::Ring& ring) {
    hash.add(uint64_t{ring.size()});
    for (const Eigen::Vector2d& corner : ring) hash.add(corner.x()).add(corner.y());
  };
  hash.add(uint64_t{polygons.size()});
  for (const Polygon& polygon : polygons) {
    add(polygon.outline);
    hash.add(uint64_t{polygon.holes.size()});
    for (const Polygon::Ring& hole : polygon.holes) add(hole);
  }
}
inline void add_value(Hasher& hash, const Rectangle& r) {
  hash.add(r.min_m.x()).add(r.min_m.y()).add(r.max_m.x()).add(r.max_m.y());
}
/// A rectangle adds its corners only, as scenes without polygons do.
inline void add_value(Hasher& hash, const Area& area) {
  if (area.is_rectangle())
    add_value(hash, area.bounds());
  else
    add_value(hash.add("polygons"), area.polygons());
}
inline void add_value(Hasher& hash, const Distribution& d) {
  hash.add(d.mean).add(d.std_dev).add(d.min).add(d.max);
}

/// Row of a key table: a key of a map that is read into a T.
template <typename T>
struct Key {
  KeyText text;
  std::function<void(ReadContext&, Fields&, T&)> read;
  std::function<void(Hasher&, const T&)> hash;    ///< empty: the key changes no frame
  std::function<bool(const T&)> is_default = {};  ///< only needed in KeyTable::later

  Key required() && { return std::move(*this).with_fallback("required", true); }
  Key with_fallback(std::string fallback, bool required = false) && {
    text.fallback = std::move(fallback);
    text.required = required;
    return std::move(*this);
  }
  Key with_reader(std::function<void(ReadContext&, Fields&, T&)> other) && {
    read = std::move(other);
    return std::move(*this);
  }
  Key with_hash(std::function<void(Hasher&, const T&)> other) && {
    hash = std::move(other);
    return std::move(*this);
  }
  template <typename Value, typename Owner>
  Key with_hash(Value Owner::*member) && {
    hash = [member](Hasher& hasher, const T& value) { add_value(hasher, value.*member); };
    return std::move(*this);
  }
  Key without_hash() && { return std::move(*this).with_hash({}); }
};

template <typename T>
struct KeyTable {
  MapText text;       ///< without keys, see text_of()
  std::string title;  ///< name in messages: "a group"
  /// Each of these keys adds its value to the content hash, in this order.
  std::vector<Key<T>> keys;
  /// Each of these keys adds its name and value to the content hash only if it differs from the
  /// default. New keys go here: scenes without them keep their hash.
  std::vector<Key<T>> later = {};
  /// Derives values from several keys and checks that the keys fit each other.
  std::function<void(ReadContext&, const Fields&, T&)> complete = {};

  template <typename Visit>
  void for_each(const Visit& visit) const {
    for (const Key<T>& key : keys) visit(key);
    for (const Key<T>& key : later) visit(key);
  }
  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for_each([&](const Key<T>& key) { all.push_back(key.text.name); });
    return all;
  }
};

template <typename T>
MapText text_of(const KeyTable<T>& table) {
  MapText text = table.text;
  table.for_each([&](const Key<T>& key) { text.keys.push_back(key.text); });
  return text;
}

/// Reads a map. Throws InputError; unknown keys are reported before missing ones.
template <typename T>
void read_keys(const KeyTable<T>& table, ReadContext& context, Fields& fields, T& out) {
  fields.expect_keys(table.names());
  table.for_each([&](const Key<T>& key) {
    if (key.text.required) fields.require(key.text.name);
    if (key.read) key.read(context, fields, out);
  });
  if (table.complete) table.complete(context, fields, out);
}

/// Throws InputError for an unknown key, or one of `absent`, which this map does not allow.
template <typename T>
void expect_keys_without(const std::vector<std::string>& absent, const KeyTable<T>& table,
                         const Fields& fields) {
  std::vector<std::string> keys = table.names();
  std::erase_if(keys, [&](const std::string& key) {
    return std::find(absent.begin(), absent.end(), key) != absent.end();
  });
  fields.expect_keys(keys);
}

template <typename T>
void add_keys(const KeyTable<T>& table, Hasher& hash, const T& value) {
  for (const Key<T>& key : table.keys)
    if (key.hash) key.hash(hash, value);
  for (const Key<T>& key : table.later) {
    if (!key.hash || key.is_default(value)) continue;
    hash.add(key.text.name);
    key.hash(hash, value);
  }
}

template <typename T, typename Value>
Key<T> key_of(std::string name, std::string meaning, Value T::*member, Rule rule) {
  Key<T> key;
  key.text = {std::move(name), std::move(meaning), fmt::format("{}", T{}.*member), false,
              std::move(rule)};
  key.is_default = [member](const T& value) { return value.*member == T{}.*member; };
  return std::move(key).with_hash(member);
}

template <typename T>
Key<T> number(const std::string& name, std::string meaning, double T::*member, Range range) {
  Rule rule{.kind = Rule::Kind::kNumber, .range = range};
  return key_of(name, std::move(meaning), member, std::move(rule))
      .with_reader([name, member, range](ReadContext&, Fields& fields, T& out) {
        out.*member = fields.number_or(name, range, out.*member);
      });
}

template <typename T, typename Whole>
Key<T> whole(const std::string& name, std::string meaning, Whole T::*member, int64_t min,
             int64_t max) {
  Rule rule{.kind = Rule::Kind::kWhole, .min = min, .max = max};
  return key_of(name, std::move(meaning), member, std::move(rule))
      .with_reader([name, member, min, max](ReadContext&, Fields& fields, T& out) {
        out.*member = static_cast<Whole>(
            fields.integer_or(name, min, max, static_cast<int64_t>(out.*member)));
      });
}

template <typename T>
Key<T> flag(const std::string& name, std::string meaning, bool T::*member) {
  return key_of(name, std::move(meaning), member, {.kind = Rule::Kind::kFlag})
      .with_reader([name, member](ReadContext&, Fields& fields, T& out) {
        out.*member = fields.boolean_or(name, out.*member);
      });
}

/// Key that accepts one of several words, each of which stands for a value.
template <typename T, typename Value>
Key<T> word(const std::string& name, std::string meaning, Value T::*member,
            std::vector<std::pair<std::string, Value>> values) {
  Key<T> key;
  key.text = {name, std::move(meaning), "", false, {.kind = Rule::Kind::kWord}};
  for (const auto& [word, value] : values) {
    key.text.rule.words.push_back(word);
    if (value == T{}.*member) key.text.fallback = fmt::format("`{}`", word);
  }
  key.read = [name, member, values, words = key.text.rule.words](ReadContext&, Fields& fields,
                                                                 T& out) {
    if (const auto found = fields.word(name, words)) out.*member = values[*found].second;
  };
  key.hash = [member](Hasher& hash, const T& value) {
    hash.add(static_cast<uint64_t>(value.*member));
  };
  key.is_default = [member](const T& value) { return value.*member == T{}.*member; };
  return key;
}

template <typename T>
Key<T> custom_key(std::string name, std::string meaning, std::string fallback, Rule rule) {
  Key<T> key;
  key.text = {std::move(name), std::move(meaning), std::move(fallback), false, std::move(rule)};
  return key;
}

inline constexpr const char* kChannelPattern = "^(?!THRONG_)[A-Za-z0-9_]{1,63}$";
/// Reads the name of an LCM channel that is not one of Throng's. Throws InputError.
std::string read_channel(const Fields& fields, const std::string& key);

inline Rule map_rule(std::string map) { return {.kind = Rule::Kind::kMap, .map = std::move(map)}; }
inline Rule list_rule(std::string map, int64_t min = 0, int64_t max = 0) {
  return {.kind = Rule::Kind::kList, .min = min, .max = max, .map = std::move(map)};
}

}  // namespace throng
