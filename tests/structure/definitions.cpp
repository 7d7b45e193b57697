#include "tests/structure/definitions.h"

#include <algorithm>
#include <cctype>
#include <set>
#include <span>
#include <string_view>

namespace throng {
namespace {

struct Token {
  std::string text;
  int line = 0;
};
using Tokens = std::span<const Token>;

const std::set<std::string_view> kTypeWords = {"struct", "class", "union", "enum"};
/// Words that cannot be parameter names.
const std::set<std::string_view> kBuiltIn = {"bool",   "char",     "short",  "int",
                                             "long",   "unsigned", "signed", "float",
                                             "double", "void",     "auto"};
/// Words before a bracket that does not hold parameters.
const std::set<std::string_view> kNotFunctions = {"alignas", "decltype", "noexcept", "requires",
                                                  "__attribute__"};

bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }
bool is_word(const Token& token) { return is_word(token.text[0]); }

/// Splits a source into words and punctuation; "::" is one token. Comments and directives are
/// skipped, literals become "".
class Lexer {
 public:
  explicit Lexer(std::string_view text) : text_(text) {}

  std::vector<Token> tokens() {
    bool at_line_start = true;
    while (at_ < text_.size()) {
      const char c = text_[at_];
      if (c == '\n') {
        ++line_, ++at_;
        at_line_start = true;
        continue;
      }
      if (std::isspace(static_cast<unsigned char>(c)) != 0) {
        ++at_;
        continue;
      }
      if (c == '#' && at_line_start) {
        skip_directive();
        continue;
      }
      at_line_start = false;
      read_token(c);
    }
    return std::move(tokens_);
  }

 private:
  bool starts(std::string_view with) const { return text_.substr(at_).starts_with(with); }

  void skip_to(std::string_view end, size_t from) {
    const size_t found = text_.find(end, from);
    const size_t stop = found == std::string_view::npos ? text_.size() : found + end.size();
    line_ += static_cast<int>(std::count(text_.begin() + static_cast<std::ptrdiff_t>(at_),
                                         text_.begin() + static_cast<std::ptrdiff_t>(stop), '\n'));
    at_ = stop;
  }

  void skip_directive() {
    while (at_ < text_.size() && text_[at_] != '\n') {
      if (text_[at_] == '\\' && at_ + 1 < text_.size() && text_[at_ + 1] == '\n') ++line_, ++at_;
      ++at_;
    }
  }

  void skip_quoted(char quote) {
    for (++at_; at_ < text_.size() && text_[at_] != quote; ++at_)
      if (text_[at_] == '\\') ++at_;
    ++at_;
    tokens_.push_back({"\"\"", line_});
  }

  void read_token(char c) {
    if (starts("//")) {
      at_ = std::min(text_.find('\n', at_), text_.size());
    } else if (starts("/*")) {
      skip_to("*/", at_ + 2);
    } else if (starts("R\"")) {
      const size_t open = text_.find('(', at_);
      const std::string end = ")" + std::string(text_.substr(at_ + 2, open - at_ - 2)) + "\"";
      tokens_.push_back({"\"\"", line_});
      skip_to(end, open);
    } else if (c == '"' || c == '\'') {
      skip_quoted(c);
    } else if (is_word(c)) {
      size_t end = at_;
      // A quote between digits separates them.
      while (end < text_.size() &&
             (is_word(text_[end]) || (text_[end] == '\'' && std::isdigit(c) != 0)))
        ++end;
      tokens_.push_back({std::string(text_.substr(at_, end - at_)), line_});
      at_ = end;
    } else {
      const size_t length = starts("::") ? 2 : 1;
      tokens_.push_back({std::string(text_.substr(at_, length)), line_});
      at_ += length;
    }
  }

  std::string_view text_;
  size_t at_ = 0;
  int line_ = 1;
  std::vector<Token> tokens_;
};

std::string joined(Tokens tokens) {
  std::string text;
  for (const Token& token : tokens) {
    if (!text.empty() && is_word(text.back()) && is_word(token)) text += ' ';
    text += token.text;
  }
  return text;
}

/// Index after the bracket that closes the one at `open`.
size_t behind_closing(Tokens tokens, size_t open) {
  const std::string& opening = tokens[open].text;
  const std::string closing = opening == "("   ? ")"
                              : opening == "[" ? "]"
                              : opening == "{" ? "}"
                                               : ">";
  int depth = 0;
  for (size_t i = open; i < tokens.size(); ++i) {
    if (tokens[i].text == opening) ++depth;
    if (tokens[i].text == closing && --depth == 0) return i + 1;
  }
  return tokens.size();
}

/// Removes leading `template <...>` and attributes.
Tokens without_prefix(Tokens head) {
  for (;;) {
    if (head.size() > 1 && head[0].text == "template" && head[1].text == "<") {
      head = head.subspan(behind_closing(head, 1));
    } else if (head.size() > 1 && head[0].text == "[" && head[1].text == "[") {
      head = head.subspan(behind_closing(head, 0));
    } else {
      return head;
    }
  }
}

std::string parameter_type(Tokens parameter) {
  const auto equals = std::find_if(parameter.begin(), parameter.end(),
                                   [](const Token& token) { return token.text == "="; });
  parameter = parameter.first(static_cast<size_t>(equals - parameter.begin()));
  if (parameter.size() > 1 && is_word(parameter.back()) &&
      !kBuiltIn.contains(parameter.back().text)) {
    const std::string& before = parameter[parameter.size() - 2].text;
    if (before != "::" && before != "const") parameter = parameter.first(parameter.size() - 1);
  }
  return joined(parameter);
}

/// "(const Sphere&,float)"
std::string signature(Tokens parameters) {
  std::string text = "(";
  for (size_t begin = 0, i = 0, depth = 0; i <= parameters.size(); ++i) {
    if (i < parameters.size()) {
      const std::string& mark = parameters[i].text;
      if (mark == "(" || mark == "<" || mark == "[" || mark == "{") ++depth;
      if (mark == ")" || mark == ">" || mark == "]" || mark == "}") --depth;
      if (mark != "," || depth > 0) continue;
    }
    if (begin > 0) text += ',';
    text += parameter_type(parameters.subspan(begin, i - begin));
    begin = i + 1;
  }
  return text + ")";
}

class Reader {
 public:
  explicit Reader(const SourceFile& file)
      : outermost_(file.path.ends_with("-inl.h") ? "(lanes)" : "(global)"),
        tokens_(Lexer(file.text).tokens()) {}

  std::vector<Definition> read() {
    while (at_ < tokens_.size()) {
      const std::string& mark = tokens_[at_].text;
      if (mark == "}") {
        if (!scopes_.empty()) scopes_.pop_back();
        start_over();
      } else if (mark == ";") {
        end_statement();
        start_over();
      } else if (mark == "(" || mark == "[") {
        at_ = behind_closing(tokens_, at_);
      } else if (mark == "{") {
        open_brace();
      } else {
        ++at_;
      }
    }
    return std::move(found_);
  }

 private:
  Tokens head() const { return Tokens(tokens_).subspan(begin_, at_ - begin_); }
  void start_over() { begin_ = ++at_; }

  void add(std::string name, const Token& where) {
    std::string scope;
    for (const std::string& part : scopes_) {
      if (part == "(unnamed)") return;
      if (!part.empty()) scope += (scope.empty() ? "" : "::") + part;
    }
    found_.push_back({scope.empty() ? outermost_ : scope, std::move(name), where.line});
  }

  void open_brace() {
    Tokens words = without_prefix(head());
    if (!words.empty() && words[0].text == "inline" && words.size() > 1 &&
        words[1].text == "namespace")
      words = words.subspan(1);
    if (!words.empty() && words[0].text == "namespace") {
      scopes_.push_back(words.size() == 1 ? "(unnamed)" : joined(words.subspan(1)));
      start_over();
      return;
    }
    if (words.size() == 2 && words[0].text == "extern") {
      scopes_.emplace_back();
      start_over();
      return;
    }
    const bool is_whole = add_type(words) || add_function(words);
    at_ = behind_closing(tokens_, at_);
    if (is_whole) {
      // Variables may follow a type, nothing follows a function.
      if (at_ < tokens_.size() && tokens_[at_].text == ";") ++at_;
      begin_ = at_;
    }
  }

  bool add_type(Tokens words) {
    size_t i = 0;
    while (i < words.size() && (words[i].text == "inline" || words[i].text == "typedef")) ++i;
    if (i == words.size() || !kTypeWords.contains(words[i].text)) return false;
    Tokens name = words.subspan(i + 1);
    if (!name.empty() && (name[0].text == "class" || name[0].text == "struct"))
      name = name.subspan(1);
    while (name.size() > 1 &&
           (name[0].text == "alignas" || name[0].text == "[" || name[0].text == "HWY_ALIGN"))
      name = name.subspan(
          name[0].text == "HWY_ALIGN" ? 1 : behind_closing(name, name[0].text == "[" ? 0 : 1));
    size_t end = 0;  // a base or an underlying type may follow
    while (end < name.size() && name[end].text != ":" && name[end].text != "final") {
      if (name[end].text == "(") return false;  // function returning the type
      ++end;
    }
    if (end == 0) return true;
    if (end > 1 && name[1].text == "::") return true;  // a member
    add(joined(name.first(end)), name[0]);
    return true;
  }

  bool add_function(Tokens words) {
    bool is_static = false;
    for (size_t i = 0; i < words.size(); ++i) {
      const std::string& word = words[i].text;
      if (word == "=") return false;
      is_static = is_static || word == "static";
      if (word != "(") continue;
      const size_t behind = behind_closing(words, i);
      if (i == 0 || kNotFunctions.contains(words[i - 1].text)) {
        i = behind - 1;
        continue;
      }
      size_t first = i - 1;
      while (first > 0 && words[first - 1].text != "operator" && !is_word(words[first])) --first;
      if (first > 0 && words[first - 1].text == "operator") --first;
      if (first > 0 && words[first - 1].text == "::") return true;  // a member
      if (!is_static)
        add(joined(words.subspan(first, i - first)) +
                signature(words.subspan(i + 1, behind - i - 2)),
            words[first]);
      return true;
    }
    return false;
  }

  /// Handles variables and aliases; declarations define nothing.
  void end_statement() {
    const Tokens words = without_prefix(head());
    // A namespace alias is local to its file.
    if (words.size() < 2 || words[0].text == "extern" || words[0].text == "namespace") return;
    if (words[0].text == "using") {
      if (words.size() > 3 && words[2].text == "=") add(words[1].text, words[1]);
      return;
    }
    for (size_t i = 1; i < words.size(); ++i) {
      const std::string& mark = words[i].text;
      if (mark == "(" || mark == "static") return;
      if (mark != "=" && mark != "{" && mark != "[") continue;
      if (!is_word(words[i - 1]) || words[0].text == "static") return;
      if (i > 1 && words[i - 2].text == "::") return;  // a member
      add(words[i - 1].text, words[i - 1]);
      return;
    }
  }

  std::string outermost_;
  std::vector<Token> tokens_;
  size_t at_ = 0, begin_ = 0;
  std::vector<std::string> scopes_;
  std::vector<Definition> found_;
};

}  // namespace

std::vector<Definition> read_definitions(const SourceFile& file) { return Reader(file).read(); }

}  // namespace throng
