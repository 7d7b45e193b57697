#include "recordings/readers/header_comments.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "base/text.h"
#include "recordings/readers/column_name.h"
#include "recordings/readers/text_lines.h"

namespace throng {
namespace {

bool is_letter(char c) { return c >= 'a' && c <= 'z'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_word(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), is_letter);
}

std::string_view content_of(std::string_view line) {
  while (!line.empty() && (is_blank(line.front()) ||
                           std::string_view("#*$%/;").find(line.front()) != std::string_view::npos))
    line.remove_prefix(1);
  // Spreadsheets pad the line to their last column.
  while (!line.empty() && (is_blank(line.back()) || line.back() == ',' || line.back() == ';'))
    line.remove_suffix(1);
  return trimmed(line);
}

/// Text up to the next statement of a line. Statements end at a semicolon, or at a comma and a
/// blank unless a number follows: that is a second rate.
std::string_view statement(std::string_view text) {
  const size_t end = std::min({text.find(';'), text.find(", "), text.size()});
  const std::string_view rest = trimmed(text.substr(std::min(end + 1, text.size())));
  return trimmed(!rest.empty() && is_digit(rest.front()) ? text : text.substr(0, end));
}

bool has_one_word(std::string_view text) {
  return text.find_first_of(" \t") == std::string_view::npos;
}

/// Unit at the end without brackets: "positions in cm".
std::string unit_at_end(std::string_view text) {
  while (text.ends_with('.')) text.remove_suffix(1);
  const size_t in = text.rfind(" in ");
  if (in == std::string_view::npos) return "";
  const std::string unit = bare_unit(text.substr(in + 4));
  return unit_named(unit) ? unit : "";
}

/// "in" between words is no inch.
bool is_plain_unit(std::string_view unit) { return unit != "in" && unit_named(unit).has_value(); }

/// Quantity of all columns that a word names; empty for other words.
std::optional<Quantity> quantity_of_all(std::string_view word) {
  for (const std::string_view article : {"all ", "the "})
    if (word.starts_with(article)) word = trimmed(word.substr(article.size()));
  for (const std::string_view length :
       {"length", "lengths", "distance", "distances", "coordinate", "coordinates", "position",
        "positions", "trajectory", "trajectories", "values", "data", "measurement"})
    if (word == length) return Quantity::kLength;
  return word == "time" || word == "times" ? std::optional(Quantity::kTime) : std::nullopt;
}

/// Unit that a whole text states for all columns: "positions are given in cm", "lengths: cm", "all
/// coordinates [cm]". Longer texts state something else: "position error (cm): 2".
std::optional<std::string> unit_of_all(std::string_view text) {
  while (text.ends_with('.')) text.remove_suffix(1);
  const size_t end = std::min(text.find_first_of(":="), text.find_first_of(kOpeningBrackets));
  const size_t cut = std::min(end, text.rfind(" in "));
  if (cut == std::string_view::npos) return std::nullopt;
  std::string_view subject = trimmed(text.substr(0, cut));
  for (const std::string_view verb : {" given", " measured", " are", " is"})
    if (subject.ends_with(verb)) subject = trimmed(subject.substr(0, subject.size() - verb.size()));
  const std::optional<Quantity> found = quantity_of_all(subject);
  if (!found) return std::nullopt;
  std::string_view rest = text.substr(cut);
  if (rest.front() == ':' || rest.front() == '=') rest.remove_prefix(1);
  const std::string unit = bare_unit(rest);
  const std::optional<Unit> known = unit_named(unit);
  if (!known || known->quantity != *found || !(is_plain_unit(unit) || end == cut))
    return std::nullopt;
  return unit;
}

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

/// Roles of "x,y,z", "X and Y"; empty if a word has no role.
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
    // "X,Y,v" also describes speeds.
    if (role)
      out.push_back(*role);
    else if (word != "v" && word != "a" && word != "b")
      return {};
  }
  return out;
}

/// Returns whether the words before "frame rate" mean that of the file; "playback fps" and
/// "original frame rate" do not.
bool is_own_rate(std::string_view before) {
  before = trimmed(before);
  const size_t blank = before.find_last_of(" \t");
  const std::string_view word = blank == std::string_view::npos ? before : before.substr(blank + 1);
  if (word.empty() || !is_letter(word.back())) return true;
  for (const std::string_view own :
       {"the", "camera", "video", "recording", "data", "with", "for", "at"})
    if (word == own) return true;
  return false;
}

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
    // Round brackets may also contain prose.
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
    builder.note("a frame rate of the file that --fps overrides", 1, std::string(source));
  return given;
}

void HeaderComments::state_rate(RecordingBuilder& builder) const {
  builder.state_rate(stated_rate(),
                     rate_ ? fmt::format("{} {}", rate_->place, in_quotes(rate_->text)) : "");
}

void HeaderComments::read_rate_in_name(const TableColumns& columns, int64_t number) {
  const std::string& text = columns.units[static_cast<size_t>(ColumnRole::kFrame)];
  if (!std::any_of(text.begin(), text.end(), is_letter)) return;
  if (const std::optional<double> rate = frame_rate_named(text))
    add_rate({text, rate, number, "the name of the frames' column"});
}

void HeaderComments::add_rate(Rate rate) {
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
    if (!is_own_rate(std::string_view(text).substr(0, at))) continue;
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
    // Prose also mentions rates: "recorded with 50 fps".
    if (!is_stated && (at != 0 || rest.empty() || !is_digit(rest.front()))) continue;
    const std::string_view value = statement(rest);
    if (is_missing(value)) continue;
    const bool has_unit = value.find_first_not_of("+-0123456789.,/") != std::string_view::npos;
    const std::string whole =
        unit.empty() || has_unit ? std::string(value) : fmt::format("{} {}", value, unit);
    add_rate({whole, frame_rate_named(whole), number});
    return;
  }
}

std::optional<double> HeaderComments::rate(RecordingBuilder& builder) const {
  const std::string source = rate_ ? in_quotes(rate_->text) : "";
  if (builder.options().fps || !rate_)
    return overruled_rate(builder, rate_ ? rate_->per_s : std::nullopt, source);
  if (!rate_->per_s)
    builder.reject(rate_->line, kFrameRateForms, source + "; --fps overrides the file");
  if (other_rate_)
    builder.reject(other_rate_->line, fmt::format("one frame rate, {:g}", *rate_->per_s),
                   in_quotes(other_rate_->text) + "; --fps overrides the file");
  return rate_->per_s;
}

void HeaderComments::read_names(std::string_view text, int64_t number) {
  // "columns: id frame x y" has the names after the colon.
  if (const size_t colon = text.rfind(':'); colon != std::string_view::npos)
    text = trimmed(text.substr(colon + 1));
  std::string names(text);
  std::replace_if(
      names.begin(), names.end(), [](char c) { return c == ',' || c == ';' || c == '|'; }, ' ');
  const std::vector<std::string> all = names_between_blanks(names, true);
  if (all.empty() || !role_named(all.front()) || is_prose(all)) return;
  const TableColumns columns = columns_by_name(all, {}, "");
  if (const size_t id = columns[ColumnRole::kId], frame = columns[ColumnRole::kFrame];
      id + frame == 1)
    has_ids_first_ = id == 0;
  if (!columns.missing().empty()) return;
  if (!names_.empty()) {
    const std::vector<std::string> before = names_between_blanks(names_, true);
    units_.state(columns_by_name(before, {}, ""), before, names_line_);
  }
  names_ = std::move(names);
  names_line_ = number;
}

/// Reads "X,Y,Z: the agents coordinates (in metres)", "COORDCENTX: coordinate of the centre [m]",
/// "x in cm".
void HeaderComments::read_description(std::string_view text, int64_t number) {
  const std::string source = "the comment " + in_quotes(text);
  if (const std::optional<std::string> unit = unit_of_all(text)) {
    units_.state_all(*unit, source, number);
    return;
  }
  const size_t colon = text.find_first_of(":=");
  const size_t end = colon != std::string_view::npos
                         ? colon
                         : std::min(text.find_first_of(kOpeningBrackets), text.rfind(" in "));
  if (end == std::string_view::npos) return;
  const std::string_view rest = text.substr(std::min(end + 1, text.size()));
  const auto unit_of = [&](Quantity quantity) -> std::string {
    const std::string bare = bare_unit(rest);
    if (colon == std::string_view::npos) {
      // The unit ends the statement; more text makes it prose, as in "x in [0, 10]".
      const bool is_bracket = text[end] != ' ';
      if (is_bracket && text.substr(end).find_first_of(kClosingBrackets) + 1 != text.size() - end)
        return "";
      if (!is_bracket) return is_word(bare) || unit_named(bare) ? bare : "";
      return unit_in_description(text, quantity);
    }
    if (is_plain_unit(bare)) return bare;
    // A number makes it a value: "time: 14 [h]", but not in "3d".
    for (size_t i = 0; i < rest.size(); ++i)
      if (is_digit(rest[i]) && (i + 1 == rest.size() || rest[i + 1] != 'd')) return "";
    return unit_in_description(text, quantity);
  };
  for (const ColumnRole role : roles_of(text.substr(0, end)))
    if (const std::optional<Quantity> quantity = quantity_of(role))
      units_.state(role, unit_of(*quantity), source, number);
}

/// Units in an item of a list: "cm", "meters (m)", "1 m", "id frame m m"; empty: none known.
std::vector<std::string> units_in(std::string_view item) {
  const std::string whole = bare_unit(item);
  if (unit_named(whole)) return {whole};
  const size_t bracket = whole.find_first_of(kOpeningBrackets);
  const std::string before = bare_unit(whole.substr(0, bracket));
  if (bracket != std::string::npos && unit_named(before)) return {before};
  if (const std::string inner = unit_in_description(whole, Quantity::kLength); unit_named(inner))
    return {inner};
  std::vector<std::string> out;
  for (const std::string_view word : words_of(whole))
    if (is_plain_unit(word)) out.emplace_back(word);
  return out;
}

/// Reads "unit: cm", "units: m, s", "length unit = m".
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
  if (list.empty()) return;
  // The quantity stands before or after: "length unit", "unit of length". Other quantities are not
  // read.
  if (subject.starts_with("of ")) subject.remove_prefix(3);
  if (subject.empty()) subject = trimmed(text.substr(0, at));
  while (subject.starts_with('_')) subject.remove_prefix(1);
  while (subject.ends_with('_')) subject.remove_suffix(1);
  const std::optional<Quantity> only = quantity_of_all(trimmed(subject));
  if (!subject.empty() && !only) return;
  bool is_first = true;
  while (!list.empty()) {
    const size_t end = list.find_first_of(",;");
    const std::string_view item = trimmed(list.substr(0, end));
    list.remove_prefix(end == std::string_view::npos ? list.size() : end + 1);
    // Another statement follows: "unit: cm, fps: 25".
    if (item.find_first_of(":=") != std::string_view::npos) return;
    const std::vector<std::string> units = units_in(item);
    for (const std::string& unit : units)
      if (const std::optional<Unit> found = unit_named(unit); !only || found->quantity == *only)
        units_.state_all(unit, source, number);
    // A word that is no unit is rejected, unless it states that there is none.
    const std::string word = bare_unit(item);
    const bool says_none = word == "none" || word == "unknown" || word == "si" || word == "metric";
    if (units.empty() && is_first && is_word(word) && !says_none && only != Quantity::kTime)
      units_.state_all(word, source, number);
    is_first = false;
  }
}

void HeaderComments::read_list(std::string_view line, int64_t number) {
  constexpr size_t kMaxLists = 1000, kMaxListBytes = 4096;
  if (line.size() > kMaxListBytes || lists_.size() >= kMaxLists ||
      line.find_first_of(":=") != std::string_view::npos)
    return;
  while (!line.empty() && std::string_view("#*%/").find(line.front()) != std::string_view::npos)
    line.remove_prefix(1);
  const std::string spelt = without_capitals_throughout(line);
  const std::string_view text = spelt;
  const bool has_bars = text.find_first_of(",;\t") == std::string_view::npos &&
                        text.find('|') != std::string_view::npos;
  const char separator = has_bars ? '|' : separator_of(text);
  std::vector<std::string_view> fields;
  if (!split(text, separator, fields)) return;
  List list{std::string(trimmed(line)), {}, separator != ' ', number};
  for (const std::string_view field : fields) list.fields.push_back(bare_unit(field));
  const bool has_units =
      std::any_of(list.fields.begin(), list.fields.end(),
                  [](const std::string& field) { return unit_named(field).has_value(); });
  if (has_units) lists_.push_back(std::move(list));
}

namespace {

bool is_no_unit(const std::string& field) { return is_missing(field) || field == "1"; }

/// Returns whether ids and frames have units, which numbers lack.
bool counts_have_units(const std::vector<std::string>& fields,
                       std::span<const std::optional<ColumnRole>> roles) {
  for (size_t column = 0; column < roles.size() && fields.size() == roles.size(); ++column)
    if (roles[column] && !quantity_of(*roles[column]) && is_plain_unit(fields[column])) return true;
  return false;
}

/// Units with one field per column; empty if the list does not fit.
std::vector<std::string> fitted(std::vector<std::string> fields, bool has_separators,
                                std::span<const std::optional<ColumnRole>> roles) {
  const auto is_measured = [&](size_t column) {
    return roles[column] && quantity_of(*roles[column]);
  };
  size_t measured = 0;
  for (size_t column = 0; column < roles.size(); ++column) measured += is_measured(column) ? 1 : 0;
  while (fields.size() > roles.size() && fields.back().empty()) fields.pop_back();
  // The comment sign may be a field, and fields of ids and frames may be missing.
  if (fields.size() == roles.size() + 1 && fields.front().empty()) fields.erase(fields.begin());
  if (fields.size() == measured && measured < roles.size() &&
      std::all_of(fields.begin(), fields.end(),
                  [](const std::string& field) { return unit_named(field).has_value(); }))
    for (size_t column = 0; column < roles.size(); ++column)
      if (!is_measured(column))
        fields.insert(fields.begin() + static_cast<std::ptrdiff_t>(column), "");
  if (fields.size() != roles.size() || counts_have_units(fields, roles)) return {};
  size_t units = 0, plain = 0, others = 0;
  for (size_t column = 0; column < roles.size(); ++column) {
    if (!is_measured(column)) {
      fields[column].clear();
      continue;
    }
    plain += is_plain_unit(fields[column]) ? 1 : 0;
    if (unit_named(fields[column]))
      ++units;
    else if (is_no_unit(fields[column]))
      fields[column].clear();
    else
      ++others;
  }
  // Prose may have a word in the place of a unit.
  const bool is_list = units > 0 && (others == 0 || plain > 1 || (has_separators && plain > 0));
  return is_list ? fields : std::vector<std::string>();
}

}  // namespace

void HeaderComments::state_lists(StatedUnits& units,
                                 std::span<const std::optional<ColumnRole>> roles) const {
  for (const List& list : lists_) {
    const std::string source = "the comment " + in_quotes(list.text);
    const std::vector<std::string> fields = fitted(list.fields, list.has_separators, roles);
    for (size_t column = 0; column < fields.size(); ++column)
      if (roles[column]) units.state(*roles[column], fields[column], source, list.line);
    if (!fields.empty()) continue;
    const auto plain = std::count_if(list.fields.begin(), list.fields.end(), is_plain_unit);
    const bool is_alone = list.fields.size() == 1 && plain == 1;
    if (const auto unit = unit_named(list.fields.front());
        is_alone && unit->quantity == Quantity::kLength && list.fields.front().size() > 1)
      units.state_all(list.fields.front(), source, list.line);
    const bool has_words_alone =
        std::all_of(list.fields.begin(), list.fields.end(), [&](const std::string& field) {
          return is_no_unit(field) || is_plain_unit(field) ||
                 (list.has_separators && has_one_word(field));
        });
    const bool is_si =
        std::all_of(list.fields.begin(), list.fields.end(), [](const std::string& field) {
          const std::optional<Unit> unit = unit_named(field);
          return !unit || unit->in_si == 1;
        });
    if (is_si && !counts_have_units(list.fields, roles))
      continue;  // "# m, s" are the default units
    if ((plain < 2 && !counts_have_units(list.fields, roles)) || !has_words_alone) continue;
    const std::string unfit = fmt::format("{} for {} columns", list.text, roles.size());
    for (const std::optional<ColumnRole>& role : roles)
      if (role && quantity_of(*role)) units.state(*role, unfit, source, list.line);
  }
}

void reject_contradiction(RecordingBuilder& builder, const HeaderComments& later,
                          const StatedUnits& now, const StatedUnits& then, int64_t number) {
  const double per_s = builder.header().per_s;
  if (const std::optional<double> rate = later.stated_rate(); rate && *rate != per_s)
    builder.reject(number, fmt::format("one frame rate, {:g}", per_s),
                   fmt::format("{:g}; split the file there", *rate));
  if (!now.agrees_with(then))
    builder.reject(number, "one unit of length", "another one; split the file there");
}

void HeaderComments::read(std::string_view line, int64_t number) {
  // JSON has quotes and braces around its keys.
  std::string text = folded(without_capitals_throughout(content_of(line)));
  std::erase(text, '"');
  if (text.starts_with('{') && text.ends_with('}')) text = text.substr(1, text.size() - 2);
  text = std::string(trimmed(text));
  if (text.empty()) return;
  read_rate(text, number);
  // Capitals separate words: "xCm".
  read_names(content_of(line), number);
  if (names_line_ == number && !names_.empty()) return;
  read_list(line, number);
  const auto read_statement = [&](std::string_view statement) {
    read_description(statement, number);
    read_units(statement, number);
  };
  // "X, Y, Z: in cm" is one statement, "X: in cm, Y: in m" are two.
  if (std::count(text.begin(), text.end(), ':') <= 1) read_statement(text);
  for_each_clause(text, read_statement);
}

}  // namespace throng
