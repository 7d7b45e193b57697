#include "scenes/file/yaml_tree.h"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "base/errors.h"
#include "base/text.h"

namespace throng {
namespace {

/// Collects the parser's events into nodes. Open lists and maps lie on a stack by value and move
/// into their parent when they close.
class TreeBuilder : public YAML::EventHandler {
 public:
  explicit TreeBuilder(const std::string& name) : name_(name) {}

  YamlNode take_root() { return std::move(root_); }

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    reject_anchor(mark, anchor);
    YamlNode node;
    node.line = mark.line + 1;
    close(std::move(node));
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    throw InputError(at(mark), "a value", "a YAML alias ('*'), which scene files do not use");
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    reject_anchor(mark, anchor);
    reject_tag(mark, tag);
    reject_control_characters(mark, value);
    YamlNode node;
    node.kind = YamlNode::Kind::kScalar;
    node.line = mark.line + 1;
    node.scalar = value;
    node.quoted = tag == "!";
    close(std::move(node));
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open(mark, tag, anchor, YamlNode::Kind::kList);
  }
  void OnSequenceEnd() override { close_top(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open(mark, tag, anchor, YamlNode::Kind::kMap);
  }
  void OnMapEnd() override { close_top(); }

 private:
  struct Open {
    YamlNode node;
    bool key_waits = false;
  };

  std::string at(const YAML::Mark& mark) const { return at_line(name_, mark.line + 1); }

  void reject_anchor(const YAML::Mark& mark, YAML::anchor_t anchor) const {
    if (anchor != 0)
      throw InputError(at(mark), "a value", "a YAML anchor ('&'), which scene files do not use");
  }
  void reject_tag(const YAML::Mark& mark, const std::string& tag) const {
    // yaml-cpp reports "?" for plain and "!" for quoted scalars.
    if (!tag.empty() && tag != "?" && tag != "!")
      throw InputError(at(mark), "a value without a tag", fmt::format("the tag '{}'", tag));
  }

  /// Escape sequences can produce control characters from plain text.
  void reject_control_characters(const YAML::Mark& mark, std::string_view text) const {
    for (size_t at = 0; at < text.size();) {
      const size_t bytes = printable_character(text.substr(at));
      if (bytes == 0 && text[at] != '\n' && text[at] != '\t')
        throw InputError(this->at(mark), "text without control characters",
                         fmt::format("'{}'", escaped(text.substr(0, 60))));
      at += std::max<size_t>(bytes, 1);
    }
  }

  void open(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
            YamlNode::Kind kind) {
    reject_anchor(mark, anchor);
    reject_tag(mark, tag);
    if (static_cast<int>(stack_.size()) >= kMaxYamlDepth)
      throw InputError(at(mark), fmt::format("at most {} levels of nesting", kMaxYamlDepth),
                       "a deeper level");
    Open fresh;
    fresh.node.kind = kind;
    fresh.node.line = mark.line + 1;
    stack_.push_back(std::move(fresh));
  }

  void close_top() {
    YamlNode done = std::move(stack_.back().node);
    stack_.pop_back();
    close(std::move(done));
  }

  void close(YamlNode node) {
    if (stack_.empty()) {
      root_ = std::move(node);
      return;
    }
    Open& parent = stack_.back();
    if (parent.node.kind == YamlNode::Kind::kList) {
      parent.node.items.push_back(std::move(node));
    } else if (!parent.key_waits) {
      add_key(parent, node);
    } else {
      parent.node.entries.back().value = std::move(node);
      parent.key_waits = false;
    }
  }

  void add_key(Open& parent, const YamlNode& node) const {
    const std::string where = at_line(name_, node.line);
    if (node.kind != YamlNode::Kind::kScalar)
      throw InputError(where, "a key", "a list, a map or nothing in its place");
    if (parent.node.entries.size() >= kMaxYamlKeys)
      throw InputError(where, fmt::format("at most {} keys in a map", kMaxYamlKeys), "more");
    for (const YamlEntry& earlier : parent.node.entries)
      if (earlier.key == node.scalar)
        throw InputError(where, "every key once",
                         fmt::format("'{}' again (first on line {})", node.scalar, earlier.line));
    parent.node.entries.push_back({node.scalar, node.line, {}});
    parent.node.entries.back().value.line = node.line;
    parent.key_waits = true;
  }

  std::string name_;
  std::vector<Open> stack_;
  YamlNode root_;
};

}  // namespace

YamlNode parse_yaml(const std::string& text, const std::string& name) {
  if (text.size() > kMaxYamlBytes)
    throw InputError(name, fmt::format("at most {} bytes", kMaxYamlBytes),
                     fmt::format("{}", text.size()));
  if (text.find('\0') != std::string::npos) throw InputError(name, "text", "a binary file");
  if (const size_t at = find_invalid_utf8(text); at != std::string::npos)
    throw InputError(
        at_line(name, 1 + static_cast<int>(std::count(
                              text.begin(), text.begin() + static_cast<ptrdiff_t>(at), '\n'))),
        "text in UTF-8", fmt::format("'{}'", escaped(std::string_view(text).substr(at, 1))));
  std::istringstream stream(text);
  TreeBuilder builder(name);
  try {
    YAML::Parser parser(stream);
    if (!parser.HandleNextDocument(builder)) throw InputError(name, "a scene", "an empty file");
    YamlNode root = builder.take_root();
    TreeBuilder surplus(name);
    if (parser.HandleNextDocument(surplus))
      throw InputError(at_line(name, surplus.take_root().line), "one document in the file",
                       "a second one");
    return root;
  } catch (const YAML::Exception& error) {
    throw InputError(at_line(name, error.mark.line + 1), "YAML", error.msg);
  }
}

std::string read_text_file(const std::filesystem::path& file, size_t max_bytes) {
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) throw InputError(file.string(), "a file", "nothing there");
  if (!std::filesystem::is_regular_file(status))
    throw InputError(file.string(), "a file",
                     std::filesystem::is_directory(status) ? "a directory" : "something else");
  const auto size = std::filesystem::file_size(file, error);
  if (error) throw InputError(file.string(), "a readable file", error.message());
  if (size > max_bytes)
    throw InputError(file.string(), fmt::format("at most {} bytes", max_bytes),
                     fmt::format("{}", size));
  std::ifstream stream(file, std::ios::binary);
  std::string text(static_cast<size_t>(size), '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!stream) throw InputError(file.string(), "a readable file", "one that cannot be read");
  return text;
}

}  // namespace throng
