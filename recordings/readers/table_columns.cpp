#include "recordings/readers/table_columns.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/errors.h"
#include "base/text.h"
#include "recordings/readers/column_name.h"
#include "recordings/readers/text_lines.h"

namespace throng {
namespace {

constexpr const char* kExample = "--columns id=pedID,t=time,x=posX,y=posY";

/// Column names of other programs, in lower case, without units, blanks and underscores.
const std::array<std::vector<std::string_view>, kColumnRoles>& known_names() {
  static const std::array<std::vector<std::string_view>, kColumnRoles> names = {{
      {"id", "pedid", "pedestrianid", "persid", "personid", "person", "agentid", "agent", "trackid",
       "no", "number"},
      {"frame", "fr", "frameid", "framenumber", "frameno"},
      {"t", "time", "simtime", "simsec", "seconds", "timestamp"},
      {"x", "posx", "positionx", "xpos", "coordcentx", "centerx", "centrex"},
      {"y", "posy", "positiony", "ypos", "coordcenty", "centery", "centrey"},
      {"z", "posz", "positionz", "zpos", "coordcentz"},
      {"heading"},
      {"active"},
  }};
  return names;
}

std::string unit_of(const ColumnName& name, ColumnRole role) {
  if (!name.unit.empty()) return name.unit;
  return name.has_suffix_of(quantity_of(role)) ? name.suffix : "";
}

bool is_usable(const std::string& unit, ColumnRole role) {
  if (unit.empty()) return true;
  const std::optional<Unit> found = unit_named(unit);
  return found && found->in_si > 0 && found->quantity == quantity_of(role);
}

bool is_called(const ColumnName& name, ColumnRole role, std::string_view known) {
  return name.plain == known ||
         (name.plain_before_suffix == known && name.has_suffix_of(quantity_of(role)));
}

/// Column with the most common name of a role, regardless of order; among equal names the first
/// with a known unit.
size_t find_known(const std::vector<ColumnName>& names, ColumnRole role) {
  size_t first = TableColumns::kNone;
  for (const std::string_view known : known_names()[static_cast<size_t>(role)])
    for (size_t i = 0; i < names.size(); ++i) {
      if (!is_called(names[i], role, known)) continue;
      if (is_usable(unit_of(names[i], role), role)) return i;
      if (first == TableColumns::kNone) first = i;
    }
  return first;
}

size_t find_requested(const std::vector<std::string>& names, const std::string& requested) {
  // A first line of numbers holds no names.
  double value = 0;
  const bool has_names = !std::all_of(names.begin(), names.end(), [&](const std::string& name) {
    return parse_number_or_missing(name, value);
  });
  for (size_t i = 0; i < names.size() && has_names; ++i)
    if (trimmed(names[i]) == requested) return i;
  for (size_t i = 0; i < names.size() && has_names; ++i)
    if (lower(trimmed(names[i])) == lower(requested)) return i;
  int64_t number = 0;
  if (parse_whole(requested, number) && number >= 1 && number <= static_cast<int64_t>(names.size()))
    return static_cast<size_t>(number - 1);
  return TableColumns::kNone;
}

}  // namespace

std::optional<Quantity> quantity_of(ColumnRole role) {
  switch (role) {
    case ColumnRole::kTime:
      return Quantity::kTime;
    case ColumnRole::kX:
    case ColumnRole::kY:
    case ColumnRole::kZ:
      return Quantity::kLength;
    case ColumnRole::kHeading:
      return Quantity::kAngle;
    case ColumnRole::kId:
    case ColumnRole::kFrame:
    case ColumnRole::kActive:
      break;
  }
  return std::nullopt;
}

std::optional<ColumnRole> role_named(std::string_view name) {
  const std::vector<ColumnName> names = {column_name(name)};
  for (size_t role = 0; role < kColumnRoles; ++role)
    if (find_known(names, static_cast<ColumnRole>(role)) == 0) return static_cast<ColumnRole>(role);
  return std::nullopt;
}

std::string TableColumns::missing() const {
  std::vector<std::string_view> out;
  if (!has(ColumnRole::kId)) out.push_back("id");
  if (!has(ColumnRole::kFrame) && !has(ColumnRole::kTime)) out.push_back("t or frame");
  if (!has(ColumnRole::kX)) out.push_back("x");
  if (!has(ColumnRole::kY)) out.push_back("y");
  return fmt::format("{}", fmt::join(out, ", "));
}

std::array<std::string, kColumnRoles> parse_columns_option(std::string_view text) {
  std::array<std::string, kColumnRoles> out;
  while (!text.empty()) {
    const size_t comma = text.find(',');
    const std::string_view item = trimmed(text.substr(0, comma));
    text.remove_prefix(comma == std::string_view::npos ? text.size() : comma + 1);
    const size_t equals = item.find('=');
    const std::string_view role = trimmed(item.substr(0, equals));
    const auto known = std::find(kColumnRoleNames.begin(), kColumnRoleNames.end(), role);
    if (equals == std::string_view::npos || known == kColumnRoleNames.end())
      throw InputError("--columns",
                       fmt::format("ROLE=NAME,... of the roles {}, as in {}",
                                   fmt::join(kColumnRoleNames, ", "), kExample),
                       in_quotes(item));
    const std::string_view name = trimmed(item.substr(equals + 1));
    std::string& place = out[static_cast<size_t>(known - kColumnRoleNames.begin())];
    if (name.empty() || !place.empty())
      throw InputError("--columns", "each role once, with the name of a column", in_quotes(item));
    place = name;
  }
  return out;
}

/// Drops suffixes that are no units: "x_in" next to "x_out" is an entry position, "t_min" next to
/// "t_max" a minimum.
void drop_ambiguous_suffixes(std::vector<ColumnName>& names) {
  const auto drop = [&](std::string_view suffix, std::string_view opposite) {
    const bool has_opposite = std::any_of(names.begin(), names.end(), [&](const ColumnName& name) {
      return name.plain.ends_with(opposite);
    });
    if (!has_opposite) return;
    for (ColumnName& name : names)
      if (name.suffix == suffix) name.suffix.clear();
  };
  drop("in", "out");
  drop("min", "max");
}

TableColumns columns_by_name(const std::vector<std::string>& names,
                             const std::array<std::string, kColumnRoles>& requested,
                             const std::string& where) {
  TableColumns out;
  std::vector<ColumnName> column_names;
  for (const std::string& name : names) column_names.push_back(column_name(name));
  drop_ambiguous_suffixes(column_names);
  for (size_t role = 0; role < kColumnRoles; ++role) {
    if (requested[role].empty()) {
      out.at[role] = find_known(column_names, static_cast<ColumnRole>(role));
      continue;
    }
    out.at[role] = find_requested(names, requested[role]);
    if (out.at[role] == TableColumns::kNone)
      throw InputError(where,
                       fmt::format("a column '{}', because of --columns{}", requested[role],
                                   did_you_mean(requested[role], names)),
                       in_quotes(fmt::format("{}", fmt::join(names, ", "))));
  }
  const std::string& time = requested[static_cast<size_t>(ColumnRole::kTime)];
  const std::string& frame = requested[static_cast<size_t>(ColumnRole::kFrame)];
  if (!time.empty() && frame.empty()) out[ColumnRole::kFrame] = TableColumns::kNone;
  if (!frame.empty() && time.empty()) out[ColumnRole::kTime] = TableColumns::kNone;
  for (size_t role = 0; role < kColumnRoles; ++role) {
    if (out.at[role] == TableColumns::kNone) continue;
    const ColumnName& name = column_names[out.at[role]];
    out.units[role] = unit_of(name, static_cast<ColumnRole>(role));
    if (quantity_of(static_cast<ColumnRole>(role)) && out.units[role].empty())
      out.remarks[role] = name.remark;
  }
  return out;
}

char separator_of(std::string_view line) {
  char best = ' ';
  ptrdiff_t max = 0;
  bool is_quoted = false;
  std::string bare;
  for (const char c : line) {
    if (c == '"') is_quoted = !is_quoted;
    if (!is_quoted) bare += c;
  }
  for (const char c : {';', ',', '\t'}) {
    const ptrdiff_t count = std::count(bare.begin(), bare.end(), c);
    if (count > max) {
      best = c;
      max = count;
    }
  }
  return best;
}

namespace {

/// Returns whether a word is the unit of the preceding name, which has none.
bool is_unit_of(std::string_view word, const std::string& name) {
  const std::optional<Unit> unit = unit_named(word);
  const std::optional<ColumnRole> role = role_named(name);
  if (!unit) return false;
  // Names without a role only take their place.
  if (!role) return unit->quantity == Quantity::kSpeed;
  return unit->quantity == quantity_of(*role) && unit_of(column_name(name), *role).empty();
}

}  // namespace

std::vector<std::string> names_between_blanks(std::string_view line, bool join_units) {
  // "x / cm" is "x/cm".
  std::string text;
  for (const char c : line) {
    if (c == '/')
      while (!text.empty() && is_blank(text.back())) text.pop_back();
    if (!is_blank(c) || !text.ends_with('/')) text += c;
  }
  std::vector<std::string> names;
  std::vector<std::string_view> words;
  if (!split(text, ' ', words)) words = words_of(text);
  bool is_open = false;
  for (size_t i = 0; i < words.size(); ++i) {
    const std::string_view word = words[i];
    if (word.empty()) continue;
    bool joins = is_open || kOpeningBrackets.find(word.front()) != std::string_view::npos;
    if (join_units && !joins && !names.empty()) {
      // "in" is an inch unless another unit follows.
      const bool is_in = lower(word) == "in" && i + 1 < words.size();
      const bool ends_in = lower(names.back()).ends_with(" in");
      const std::string before =
          ends_in ? names.back().substr(0, names.back().size() - 3) : names.back();
      joins = is_unit_of(word, before) || (is_in && is_unit_of(words[i + 1], before));
    }
    if (joins && !names.empty())
      names.back().append(" ").append(word);
    else
      names.emplace_back(word);
    const size_t opened = word.find_last_of(kOpeningBrackets),
                 closed = word.find_last_of(kClosingBrackets);
    if (opened != std::string_view::npos) is_open = true;
    if (closed != std::string_view::npos && (opened == std::string_view::npos || closed > opened))
      is_open = false;
  }
  return names;
}

bool split(std::string_view line, char separator, std::vector<std::string_view>& out) {
  out.clear();
  if (separator == ' ') {
    for (size_t at = 0; at < line.size();) {
      if (is_blank(line[at])) {
        ++at;
        continue;
      }
      size_t end = at;
      if (line[at] == '"') {
        end = line.find('"', at + 1);
        if (end == std::string_view::npos) return false;
        out.push_back(line.substr(at + 1, end - at - 1));
        at = end + 1;
        continue;
      }
      while (end < line.size() && !is_blank(line[end])) ++end;
      out.push_back(line.substr(at, end - at));
      at = end;
    }
    return true;
  }
  for (size_t at = 0;;) {
    size_t begin = at;
    while (begin < line.size() && line[begin] == ' ') ++begin;
    if (begin < line.size() && line[begin] == '"') {
      // Doubled quotes stay doubled; numbers have none.
      size_t end = line.find('"', begin + 1);
      while (end != std::string_view::npos && end + 1 < line.size() && line[end + 1] == '"')
        end = line.find('"', end + 2);
      if (end == std::string_view::npos) return false;
      out.push_back(line.substr(begin + 1, end - begin - 1));
      at = line.find(separator, end + 1);
    } else {
      at = line.find(separator, at);
      out.push_back(trimmed(line.substr(begin, at == std::string_view::npos ? at : at - begin)));
    }
    if (at == std::string_view::npos) return true;
    ++at;
  }
}

}  // namespace throng
