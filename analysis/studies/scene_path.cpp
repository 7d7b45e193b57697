#include "analysis/studies/scene_path.h"

#include <fmt/format.h>

#include <charconv>
#include <string_view>
#include <vector>

#include "base/errors.h"
#include "scenes/file/scene_fields.h"

namespace throng {
namespace {

const YamlNode* name_of_item(const YamlNode& item) {
  for (const YamlEntry& entry : item.entries)
    if (entry.key == "name" && entry.value.kind == YamlNode::Kind::kScalar) return &entry.value;
  return nullptr;
}

/// With all lines where it is put, so that the scene's reader names those.
YamlNode moved_to(YamlNode value, int line) {
  value.line = line;
  for (YamlNode& item : value.items) item = moved_to(std::move(item), line);
  for (YamlEntry& entry : value.entries) {
    entry.line = line;
    entry.value = moved_to(std::move(entry.value), line);
  }
  return value;
}

class Setter {
 public:
  Setter(const std::string& path, const YamlNode& value, const std::string& where)
      : path_(path), value_(value), where_(where) {}

  void set(YamlNode& node, size_t from) const {
    if (from > path_.size()) {
      node = moved_to(value_, node.line);
      return;
    }
    const size_t dot = std::min(path_.find('.', from), path_.size());
    const std::string step = path_.substr(from, dot - from);
    if (node.kind == YamlNode::Kind::kNull) node.kind = YamlNode::Kind::kMap;
    if (node.kind == YamlNode::Kind::kMap)
      set(entry(node, step), dot + 1);
    else if (node.kind == YamlNode::Kind::kList)
      set_items(node, step, dot + 1);
    else
      throw InputError(where_, fmt::format("a map or a list before '{}' of '{}'", step, path_),
                       describe(node));
  }

 private:
  static YamlNode& entry(YamlNode& map, const std::string& key) {
    for (YamlEntry& entry : map.entries)
      if (entry.key == key) return entry.value;
    YamlNode fresh;
    fresh.line = map.line;
    return map.entries.emplace_back(YamlEntry{key, map.line, fresh}).value;
  }

  void set_items(YamlNode& list, const std::string& step, size_t from) const {
    bool found = false;
    size_t number = 0;
    const auto [end, error] = std::from_chars(step.data(), step.data() + step.size(), number);
    const bool is_number = error == std::errc() && end == step.data() + step.size();
    for (size_t i = 0; i < list.items.size(); ++i) {
      const YamlNode* name = name_of_item(list.items[i]);
      const bool is_named = name != nullptr && name->scalar == step;
      if (step != "*" && !is_named && !(is_number && number == i + 1)) continue;
      set(list.items[i], from);
      found = true;
    }
    if (!found) refuse(list, step);
  }

  [[noreturn]] void refuse(const YamlNode& list, const std::string& step) const {
    std::vector<std::string> names;
    for (const YamlNode& item : list.items)
      if (const YamlNode* name = name_of_item(item)) names.push_back(name->scalar);
    throw InputError(
        where_,
        fmt::format("in '{}' the number of an item, 1 to {}, '*' for all{}{}", path_,
                    list.items.size(), names.empty() ? "" : ", or one of ", list_of(names)),
        fmt::format("'{}'{}", step, did_you_mean(step, names)));
  }

  const std::string& path_;
  const YamlNode& value_;
  const std::string& where_;
};

}  // namespace

void set_value(YamlNode& root, const std::string& path, const YamlNode& value,
               const std::string& where) {
  Setter(path, value, where).set(root, 0);
}

}  // namespace throng
