#include "scenes/recorded/readers/header_comments.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <initializer_list>
#include <utility>
#include <vector>

#include "base/text.h"
#include "scenes/recorded/readers/column_name.h"
#include "scenes/recorded/readers/text_lines.h"

namespace throng {
namespace {

/// Of "unit of length": prose is longer.
constexpr size_t kLongestSubject = 24;

bool is_letter(char c) { return c >= 'a' && c <= 'z'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Without signs of comments and blanks.
std::string_view content_of(std::string_view line) {
  while (!line.empty() && (is_blank(line.front()) ||
                           std::string_view("#*$%/;").find(line.front()) != std::string_view::npos))
    line.remove_prefix(1);
  return trimmed(line);
}

/// Up to where the next statement of a line begins: a semicolon, or a comma and a blank.
std::string_view statement(std::string_view text) {
  return trimmed(text.substr(0, std::min(text.find(';'), text.find(", "))));
}

bool has_one_word(std::string_view text) {
  return text.find_first_of(" \t") == std::string_view::npos;
}

/// A unit that stands without brackets at the end: "positions in cm".
std::string unit_at_end(std::string_view text) {
  while (text.ends_with('.')) text.remove_suffix(1);
  const size_t in = text.rfind(" in ");
  if (in == std::string_view::npos) return "";
  const std::string unit = bare_unit(text.substr(in + 4));
  return unit_named(unit) ? unit : "";
}

/// What a description is about as a whole; none if it is about something else.
std::optional<Quantity> subject_of(std::string_view text) {
  for (const std::string_view article : {"all ", "the "})
    if (text.starts_with(article)) text = trimmed(text.substr(article.size()));
  for (const std::string_view word :
       {"coordinate", "position", "length", "trajector", "data", "value", "distance"})
    if (text.starts_with(word)) return Quantity::kLength;
  return text.starts_with("time") ? std::optional(Quantity::kTime) : std::nullopt;
}

/// Calls `take` for each of the statements in a line: "x in cm, y in m".
template <typename Take>
void for_each_clause(std::string_view text, const Take& take) {
  while (!text.empty()) {
    size_t end = text.size(), next = text.size();
    for (const std::string_view sign : {", ", ";", " and "})
      if (const size_t at = text.find(sign); at < end) {
        end = at;
        next = at + sign.size();
      }
    if (const std::string_view clause = trimmed(text.substr(0, end)); !clause.empty()) take(clause);
    text.remove_prefix(next);
  }
}

/// Roles of "x,y,z", "X and Y"; empty if a word of it is none.
std::vector<ColumnRole> roles_of(std::string_view list) {
  std::string words(list);
  std::replace_if(
      words.begin(), words.end(),
      [](char c) { return c == ',' || c == ';' || c == '&' || c == '/'; }, ' ');
  std::vector<ColumnRole> out;
  for (const std::string_view word : words_of(words)) {
    if (word == "and") continue;
    if (word == "xyz" || word == "xy") {
      out = {ColumnRole::kX, ColumnRole::kY};
      if (word == "xyz") out.push_back(ColumnRole::kZ);
      continue;
    }
    const std::optional<ColumnRole> role = role_named(word);
    // "X,Y,v" describes speeds as well.
    if (role)
      out.push_back(*role);
    else if (word != "v" && word != "a" && word != "b")
      return {};
  }
  return out;
}

/// True for words that no column is called by.
bool is_prose(const std::vector<std::string>& names) {
  return std::any_of(names.begin(), names.end(), [](const std::string& name) {
    const std::string word = lower(name);
    return word == "and" || word == "of" || word == "the" || word == "each" || word == "is" ||
           word == "are" || word == "for" || word == "with";
  });
}

}  // namespace

std::string unit_in_description(std::string_view text, Quantity quantity) {
  std::string unknown;
  for (size_t at = text.find_first_of(kOpeningBrackets); at != std::string_view::npos;
       at = text.find_first_of(kOpeningBrackets, at + 1)) {
    const std::string_view inner = text.substr(at + 1);
    const std::string_view whole = trimmed(inner.substr(0, inner.find_first_of(kClosingBrackets)));
    const std::string unit = bare_unit(whole);
    if (const std::optional<Unit> found = unit_named(unit); found && found->quantity == quantity)
      return unit;
    // Prose stands in round brackets as well.
    const bool is_meant = text[at] == '[' || lower(whole).starts_with("in ");
    // "[1]" is a reference.
    const bool has_letter = std::any_of(unit.begin(), unit.end(), is_letter);
    if (is_meant && has_letter && has_one_word(unit) && unknown.empty()) unknown = unit;
  }
  return unknown.empty() ? unit_at_end(text) : unknown;
}

std::optional<double> overruled_rate(RecordingBuilder& builder, std::optional<double> stated,
                                     std::string_view source) {
  const std::optional<double> given = builder.options().fps;
  if (!given) return stated;
  if (stated && *stated != *given)
    builder.note("a frame rate of the file that --fps overrules", 1, std::string(source));
  return given;
}

void HeaderComments::add_rate(std::string_view text, int64_t number) {
  Rate rate{std::string(text), frame_rate_named(text), number};
  if (!rate_)
    rate_ = std::move(rate);
  else if (!other_rate_ && (rate.per_s != rate_->per_s || !rate.per_s))
    other_rate_ = std::move(rate);
}

void HeaderComments::read_rate(const std::string& text, int64_t number) {
  for (const std::string_view word :
       {"framerate", "frame rate", "frame_rate", "frame-rate", "frames per second", "fps"}) {
    const size_t at = text.find(word);
    if (at == std::string::npos || (at > 0 && is_letter(text[at - 1]))) continue;
    std::string_view rest = trimmed(std::string_view(text).substr(at + word.size()));
    std::string unit;
    if (rest.starts_with("in ")) rest = trimmed(rest.substr(3));
    if (rest.starts_with("fps") || rest.starts_with("hz")) {
      unit = rest.substr(0, rest.find_first_of(" \t:="));
      rest = trimmed(rest.substr(unit.size()));
    }
    if (!rest.empty() && kOpeningBrackets.find(rest.front()) != std::string_view::npos) {
      const size_t end = rest.find_first_of(kClosingBrackets);
      if (end == std::string_view::npos) continue;
      unit = rest.substr(1, end - 1);
      rest = trimmed(rest.substr(end + 1));
    }
    const bool is_stated = !rest.empty() && (rest.front() == ':' || rest.front() == '=');
    if (is_stated) rest = trimmed(rest.substr(1));
    // Prose speaks of rates as well: "recorded with 50 fps".
    if (!is_stated && (at != 0 || rest.empty() || !is_digit(rest.front()))) continue;
    const std::string_view value = statement(rest);
    if (is_missing(value)) continue;
    const bool has_unit = value.find_first_not_of("+-0123456789.,/") != std::string_view::npos;
    add_rate(unit.empty() || has_unit ? std::string(value) : fmt::format("{} {}", value, unit),
             number);
    return;
  }
}

std::optional<double> HeaderComments::rate(RecordingBuilder& builder) const {
  const std::string source = rate_ ? in_quotes(rate_->text) : "";
  if (builder.options().fps || !rate_)
    return overruled_rate(builder, rate_ ? rate_->per_s : std::nullopt, source);
  if (!rate_->per_s)
    builder.refuse(rate_->line, kFrameRateForms, source + "; --fps overrules the file");
  if (other_rate_)
    builder.refuse(other_rate_->line, fmt::format("one frame rate, {:g}", *rate_->per_s),
                   in_quotes(other_rate_->text) + "; --fps overrules the file");
  return rate_->per_s;
}

void HeaderComments::read_names(std::string_view text, int64_t number) {
  // "columns: id frame x y" names them behind the colon.
  if (const size_t colon = text.rfind(':'); colon != std::string_view::npos)
    text = trimmed(text.substr(colon + 1));
  std::string names(text);
  std::replace_if(
      names.begin(), names.end(), [](char c) { return c == ',' || c == ';' || c == '|'; }, ' ');
  const std::vector<std::string> all = names_between_blanks(names, true);
  if (all.empty() || !role_named(all.front()) || is_prose(all)) return;
  const TableColumns columns = columns_by_name(all, {}, "");
  if (!columns.missing().empty()) return;
  names_ = std::move(names);
  names_line_ = number;
}

/// "X,Y,Z: the agents coordinates (in metres)", "COORDCENTX: coordinate of the centre [m]", "x in
/// cm".
void HeaderComments::read_description(std::string_view text, int64_t number) {
  const size_t colon = text.find_first_of(":=");
  const size_t end = colon != std::string_view::npos
                         ? colon
                         : std::min(text.find_first_of(kOpeningBrackets), text.rfind(" in "));
  if (end == std::string_view::npos) return;
  const std::string source = "the comment " + in_quotes(text);
  const auto unit_of = [&](Quantity quantity) {
    const std::string rest = bare_unit(text.substr(std::min(end + 1, text.size())));
    const bool is_unit = colon != std::string_view::npos ? unit_named(rest).has_value()
                                                         : text[end] == ' ' && has_one_word(rest);
    return is_unit ? rest : unit_in_description(text, quantity);
  };
  for (const ColumnRole role : roles_of(text.substr(0, end)))
    if (const std::optional<Quantity> quantity = quantity_of(role))
      units_.state(role, unit_of(*quantity), source, number);
  if (const std::optional<Quantity> quantity = subject_of(text)) {
    const std::string unit = unit_of(*quantity);
    const std::optional<Unit> found = unit_named(unit);
    if (found && found->quantity == *quantity) units_.state_all(unit, source, number);
  }
}

/// "unit: cm", "units: m, s", "length unit = m".
void HeaderComments::read_units(std::string_view text, int64_t number) {
  const std::string source = "the comment " + in_quotes(text);
  const size_t at = text.find("unit");
  if (at == std::string::npos || (at > 0 && is_letter(text[at - 1]))) return;
  std::string_view rest = text.substr(at + 4);
  if (rest.starts_with('s')) rest.remove_prefix(1);
  const size_t sign = rest.find_first_of(":=");
  std::string_view subject = trimmed(rest.substr(0, sign)), list;
  if (sign != std::string_view::npos)
    list = trimmed(rest.substr(sign + 1));
  else if (at == 0 && unit_named(bare_unit(rest)))
    list = std::exchange(subject, "");  // "unit (cm)"
  if (list.empty() || subject.size() > kLongestSubject) return;
  // What the unit is of stands before it or behind: "length unit", "unit of length".
  if (subject.starts_with("of ")) subject.remove_prefix(3);
  if (subject.empty()) subject = trimmed(text.substr(0, at));
  while (subject.starts_with('_')) subject.remove_prefix(1);
  // Others may be units of what is not read.
  const bool is_about_lengths = subject.empty() || subject_of(subject) == Quantity::kLength;
  while (!list.empty()) {
    const size_t end = list.find_first_of(",;");
    const std::string unit = bare_unit(list.substr(0, end));
    list.remove_prefix(end == std::string_view::npos ? list.size() : end + 1);
    // Another statement: "unit: cm, fps: 25".
    if (unit.find_first_of(":=") != std::string::npos) return;
    if (!unit.empty() && (is_about_lengths || unit_named(unit)))
      units_.state_all(unit, source, number);
  }
}

void HeaderComments::read(std::string_view line, int64_t number) {
  // JSON says it in quotes and braces.
  std::string text = lower(content_of(line));
  std::erase(text, '"');
  if (text.starts_with('{') && text.ends_with('}')) text = text.substr(1, text.size() - 2);
  text = std::string(trimmed(text));
  if (text.empty()) return;
  read_rate(text, number);
  // Capitals tell words apart: "xCm".
  read_names(content_of(line), number);
  if (names_line_ == number && !names_.empty()) return;
  const auto read_statement = [&](std::string_view statement) {
    read_description(statement, number);
    read_units(statement, number);
  };
  // "X, Y, Z: in cm" is one statement, "X: in cm, Y: in m" are two.
  if (std::count(text.begin(), text.end(), ':') <= 1) read_statement(text);
  for_each_clause(text, read_statement);
}

}  // namespace throng
