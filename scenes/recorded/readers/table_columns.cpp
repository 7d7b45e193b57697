#include "scenes/recorded/readers/table_columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>

#include "base/errors.h"
#include "base/text.h"
#include "scenes/recorded/readers/text_lines.h"

namespace throng {
namespace {

constexpr const char* kExample = "--columns id=pedID,t=time,x=posX,y=posY";

/// Names as programs give them, in small letters, without units, blanks and underscores.
const std::array<std::vector<std::string_view>, kColumnRoles>& known_names() {
  static const std::array<std::vector<std::string_view>, kColumnRoles> names = {{
      {"id", "pedid", "pedestrianid", "persid", "personid", "person", "agentid", "agent", "trackid",
       "no", "number"},
      {"frame", "fr", "frameid", "framenumber", "frameno"},
      {"t", "time", "simtime", "simsec", "seconds", "timestamp"},
      {"x", "posx", "positionx", "xpos", "coordcentx", "centerx", "centrex"},
      {"y", "posy", "positiony", "ypos", "coordcenty", "centery", "centrey"},
      {"z", "posz", "positionz", "zpos", "coordcentz"},
      {"heading", "headingrad"},
      {"active"},
  }};
  return names;
}

/// "Pos_X [cm]" is posx in cm.
struct PlainName {
  std::string name;
  double unit_m = 0;
};

PlainName plain(std::string_view text) {
  PlainName out;
  std::string name = lower(trimmed(text));
  if (const size_t cut = name.find_first_of("[(/"); cut != std::string::npos && cut > 0) {
    std::string_view unit = std::string_view(name).substr(cut + 1);
    unit = trimmed(unit.substr(0, unit.find_first_of("])")));
    if (unit.starts_with("in ")) unit.remove_prefix(3);
    out.unit_m = unit_of_length_m(unit);
    name = name.substr(0, cut);
  }
  for (const auto& [ending, unit_m] :
       {std::pair{"_m", 1.0}, {"_cm", 0.01}, {"_mm", 0.001}, {"_s", 0.0}})
    if (name.ends_with(ending) && name.size() > std::string_view(ending).size()) {
      name = name.substr(0, name.size() - std::string_view(ending).size());
      out.unit_m = unit_m;
    }
  for (const char c : name)
    if (!is_blank(c) && c != '_') out.name += c;
  return out;
}

size_t find_wanted(const std::vector<std::string>& names, const std::string& wanted) {
  // A first line of numbers is no line of names.
  double value = 0;
  const bool has_names = !std::all_of(names.begin(), names.end(), [&](const std::string& name) {
    return parse_number(name, value);
  });
  for (size_t i = 0; i < names.size() && has_names; ++i)
    if (trimmed(names[i]) == wanted) return i;
  for (size_t i = 0; i < names.size() && has_names; ++i)
    if (lower(trimmed(names[i])) == lower(wanted)) return i;
  int64_t number = 0;
  if (parse_whole(wanted, number) && number >= 1 && number <= static_cast<int64_t>(names.size()))
    return static_cast<size_t>(number - 1);
  return TableColumns::kNone;
}

}  // namespace

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

TableColumns columns_by_name(const std::vector<std::string>& names,
                             const std::array<std::string, kColumnRoles>& wanted,
                             const std::string& where) {
  TableColumns out;
  std::vector<PlainName> plain_names;
  for (const std::string& name : names) plain_names.push_back(plain(name));
  for (size_t role = 0; role < kColumnRoles; ++role) {
    if (!wanted[role].empty()) {
      out.at[role] = find_wanted(names, wanted[role]);
      if (out.at[role] == TableColumns::kNone)
        throw InputError(where,
                         fmt::format("a column '{}', because of --columns{}", wanted[role],
                                     did_you_mean(wanted[role], names)),
                         in_quotes(fmt::format("{}", fmt::join(names, ", "))));
      continue;
    }
    // The likeliest name first, whatever the order of columns.
    for (const std::string_view known : known_names()[role]) {
      const auto it = std::find_if(plain_names.begin(), plain_names.end(),
                                   [&](const PlainName& name) { return name.name == known; });
      if (it == plain_names.end()) continue;
      out.at[role] = static_cast<size_t>(it - plain_names.begin());
      break;
    }
  }
  // Whoever says where the time is does not want frames, and the other way round.
  const std::string& time = wanted[static_cast<size_t>(ColumnRole::kTime)];
  const std::string& frame = wanted[static_cast<size_t>(ColumnRole::kFrame)];
  if (!time.empty() && frame.empty()) out[ColumnRole::kFrame] = TableColumns::kNone;
  if (!frame.empty() && time.empty()) out[ColumnRole::kTime] = TableColumns::kNone;
  if (out.has(ColumnRole::kX)) out.unit_m = plain_names[out[ColumnRole::kX]].unit_m;
  return out;
}

char separator_of(std::string_view line) {
  char best = ' ';
  ptrdiff_t most = 0;
  bool is_quoted = false;
  std::string bare;
  for (const char c : line) {
    if (c == '"') is_quoted = !is_quoted;
    if (!is_quoted) bare += c;
  }
  for (const char c : {';', ',', '\t'}) {
    const ptrdiff_t count = std::count(bare.begin(), bare.end(), c);
    if (count > most) {
      best = c;
      most = count;
    }
  }
  return best;
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
      // A doubled quote stays doubled: no number has one.
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
