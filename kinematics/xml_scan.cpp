#include "kinematics/xml_scan.h"

#include <fmt/format.h>

#include <charconv>

#include "base/errors.h"

namespace throng {
namespace {

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

bool ends_name(char c) {
  return is_space(c) || std::string_view(">/=<\"'").find(c) != std::string_view::npos;
}

void append_utf8(std::string& out, uint32_t code) {
  const auto push = [&](uint32_t byte) { out.push_back(static_cast<char>(byte)); };
  if (code < 0x80) {
    push(code);
  } else if (code < 0x800) {
    push(0xc0 | (code >> 6));
    push(0x80 | (code & 0x3f));
  } else if (code < 0x10000) {
    push(0xe0 | (code >> 12));
    push(0x80 | ((code >> 6) & 0x3f));
    push(0x80 | (code & 0x3f));
  } else {
    push(0xf0 | (code >> 18));
    push(0x80 | ((code >> 12) & 0x3f));
    push(0x80 | ((code >> 6) & 0x3f));
    push(0x80 | (code & 0x3f));
  }
}

/// Appends the character of "&entity;"; returns false for an unknown entity.
bool append_entity(std::string& out, std::string_view entity) {
  constexpr std::pair<std::string_view, char> kNamed[] = {
      {"amp", '&'}, {"lt", '<'}, {"gt", '>'}, {"quot", '"'}, {"apos", '\''}};
  for (const auto& [name, character] : kNamed)
    if (entity == name) {
      out.push_back(character);
      return true;
    }
  if (entity.size() < 2 || entity[0] != '#') return false;
  const bool hex = entity[1] == 'x';
  const std::string_view digits = entity.substr(hex ? 2 : 1);
  uint32_t code = 0;
  const auto [end, error] =
      std::from_chars(digits.data(), digits.data() + digits.size(), code, hex ? 16 : 10);
  if (error != std::errc{} || end != digits.data() + digits.size()) return false;
  if (code == 0 || code > 0x10ffff) return false;
  append_utf8(out, code);
  return true;
}

class Scanner {
 public:
  Scanner(std::string_view text, const std::string& file, const XmlLimits& limits)
      : text_(text), file_(file), limits_(limits) {}

  std::vector<XmlElement> run() {
    if (text_.substr(0, 3) == "\xef\xbb\xbf") advance(3);
    while (at_ < text_.size()) {
      if (text_[at_] != '<') {
        advance(1);
      } else if (!skip("<!--", "-->") && !skip("<![CDATA[", "]]>") && !skip("<?", "?>") &&
                 !skip("<!", ">")) {
        text_.substr(at_, 2) == "</" ? close_tag() : open_tag();
      }
    }
    if (!open_.empty()) {
      const XmlElement& unclosed = elements_[static_cast<size_t>(open_.back())];
      fail(unclosed.line, fmt::format("</{}> to close this tag", shown(unclosed.name)),
           "the end of the file");
    }
    if (elements_.empty()) fail(1, "an XML element", "none");
    return std::move(elements_);
  }

 private:
  [[noreturn]] void fail(int line, std::string_view expected, std::string_view found) const {
    throw InputError(at_line(file_, line), expected, found);
  }

  /// Shortens a name from the file for use in an error.
  static std::string shown(std::string_view name) { return std::string(name.substr(0, 60)); }

  char here() const { return at_ < text_.size() ? text_[at_] : '\0'; }

  void advance(size_t count) {
    for (const size_t end = std::min(at_ + count, text_.size()); at_ < end; ++at_)
      if (text_[at_] == '\n') ++line_;
  }

  void skip_spaces() {
    while (is_space(here())) advance(1);
  }

  bool skip(std::string_view start, std::string_view end) {
    if (text_.substr(at_, start.size()) != start) return false;
    const size_t found = text_.find(end, at_ + start.size());
    if (found == std::string_view::npos)
      fail(line_, fmt::format("'{}' to close '{}'", end, start), "the end of the file");
    advance(found + end.size() - at_);
    return true;
  }

  std::string_view name() {
    const size_t start = at_;
    while (at_ < text_.size() && !ends_name(text_[at_])) ++at_;
    const std::string_view found = text_.substr(start, at_ - start);
    if (found.size() > limits_.name_bytes)
      fail(line_, fmt::format("names of at most {} bytes", limits_.name_bytes),
           fmt::format("'{}...' of {}", shown(found), found.size()));
    return found;
  }

  void close_tag() {
    const int line = line_;
    advance(2);
    const std::string_view closed = name();
    skip_spaces();
    if (here() != '>') fail(line, "'>' after the name of a closing tag", "something else");
    advance(1);
    if (open_.empty()) fail(line, "no closing tag here", fmt::format("</{}>", shown(closed)));
    const XmlElement& opened = elements_[static_cast<size_t>(open_.back())];
    if (opened.name != closed)
      fail(line, fmt::format("</{}>, which closes line {}", shown(opened.name), opened.line),
           fmt::format("</{}>", shown(closed)));
    elements_[static_cast<size_t>(open_.back())].end = at_;
    open_.pop_back();
  }

  void open_tag() {
    XmlElement element;
    element.line = line_;
    advance(1);
    element.name = name();
    if (element.name.empty()) fail(line_, "a tag name after '<'", "none");
    if (static_cast<int>(elements_.size()) >= limits_.elements)
      fail(line_, fmt::format("at most {} elements", limits_.elements), "more");
    attributes(element);
    const bool empty = here() == '/';
    if (empty) advance(1);
    if (here() != '>')
      fail(line_, fmt::format("'>' to end <{}", shown(element.name)), "something else");
    advance(1);
    element.end = at_;
    push(std::move(element), empty);
  }

  void attributes(XmlElement& element) {
    for (skip_spaces(); here() != '>' && here() != '/'; skip_spaces()) {
      const std::string_view attribute_name = name();
      if (attribute_name.empty())
        fail(line_, fmt::format("an attribute or '>' in <{}", shown(element.name)),
             at_ < text_.size() ? "something else" : "the end of the file");
      if (element.attributes.size() == limits_.attributes)
        fail(line_,
             fmt::format("at most {} attributes in <{}>", limits_.attributes, shown(element.name)),
             "more");
      skip_spaces();
      if (here() != '=')
        fail(line_, fmt::format("'=' after the attribute '{}'", shown(attribute_name)),
             "something else");
      advance(1);
      skip_spaces();
      element.attributes.emplace_back(attribute_name, value(attribute_name));
    }
  }

  std::string value(std::string_view of) {
    const char quote = here();
    if (quote != '"' && quote != '\'')
      fail(line_, fmt::format("a quoted value for '{}'", shown(of)), "none");
    const size_t end = text_.find(quote, at_ + 1);
    if (end == std::string_view::npos)
      fail(line_, fmt::format("a closing quote for '{}'", shown(of)), "the end of the file");
    const std::string_view raw = text_.substr(at_ + 1, end - at_ - 1);
    if (raw.size() > limits_.value_bytes)
      fail(line_,
           fmt::format("at most {} bytes in the value of '{}'", limits_.value_bytes, shown(of)),
           fmt::format("{}", raw.size()));
    std::string decoded;
    for (size_t i = 0; i < raw.size(); ++i) {
      if (raw[i] == '<') fail(line_, fmt::format("no '<' in the value of '{}'", shown(of)), "one");
      const size_t semicolon = raw[i] == '&' ? raw.find(';', i) : std::string_view::npos;
      if (semicolon != std::string_view::npos &&
          append_entity(decoded, raw.substr(i + 1, semicolon - i - 1)))
        i = semicolon;
      else
        decoded.push_back(is_space(raw[i]) ? ' ' : raw[i]);  // as in XML 1.0, 3.3.3
    }
    advance(end + 1 - at_);
    return decoded;
  }

  void push(XmlElement element, bool empty) {
    const int index = static_cast<int>(elements_.size());
    if (open_.empty() && index > 0)
      fail(element.line, "one outermost element",
           fmt::format("a second: <{}>", shown(element.name)));
    if (!open_.empty()) {
      element.parent = open_.back();
      int& youngest = youngest_child_[static_cast<size_t>(element.parent)];
      XmlElement& parent = elements_[static_cast<size_t>(element.parent)];
      (youngest < 0 ? parent.first_child : elements_[static_cast<size_t>(youngest)].next_sibling) =
          index;
      youngest = index;
    }
    const int line = element.line;
    elements_.push_back(std::move(element));
    youngest_child_.push_back(-1);
    if (empty) return;
    open_.push_back(index);
    if (static_cast<int>(open_.size()) > limits_.depth)
      fail(line, fmt::format("tags nested at most {} deep", limits_.depth), "deeper nesting");
  }

  std::string_view text_;
  const std::string& file_;
  const XmlLimits& limits_;
  size_t at_ = 0;
  int line_ = 1;
  std::vector<XmlElement> elements_;
  std::vector<int> youngest_child_;
  std::vector<int> open_;
};

}  // namespace

const std::string* XmlElement::attribute(std::string_view attribute_name) const {
  for (const auto& [its_name, value] : attributes)
    if (its_name == attribute_name) return &value;
  return nullptr;
}

std::vector<XmlElement> scan_xml(std::string_view text, const std::string& file,
                                 const XmlLimits& limits) {
  if (text.size() > limits.bytes)
    throw InputError(file, fmt::format("at most {} bytes", limits.bytes),
                     fmt::format("{}", text.size()));
  if (text.find('\0') != std::string_view::npos)
    throw InputError(file, "XML text in UTF-8", "a binary or UTF-16 file (it holds a zero byte)");
  return Scanner(text, file, limits).run();
}

std::string_view root_tag_of(std::string_view text) {
  const auto skip = [&text](std::string_view start, std::string_view end) {
    if (!text.starts_with(start)) return false;
    const size_t found = text.find(end, start.size());
    text.remove_prefix(found == std::string_view::npos ? text.size() : found + end.size());
    return true;
  };
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  do {
    while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  } while (skip("<!--", "-->") || skip("<?", "?>") || skip("<!", ">"));
  if (!text.starts_with("<")) return {};
  text.remove_prefix(1);
  size_t end = 0;
  while (end < text.size() && !ends_name(text[end])) ++end;
  return end < text.size() ? text.substr(0, end) : std::string_view();
}

int child_of(const std::vector<XmlElement>& elements, int parent, std::string_view name) {
  int child = elements[static_cast<size_t>(parent)].first_child;
  while (child >= 0 && elements[static_cast<size_t>(child)].name != name)
    child = elements[static_cast<size_t>(child)].next_sibling;
  return child;
}

}  // namespace throng
