// Which column of a table holds what, by its name or as options say.
// One rule: a table is known if its names leave no doubt where id, instant, x and y are.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "recordings/units.h"

namespace throng {

enum class ColumnRole : uint8_t { kId, kFrame, kTime, kX, kY, kZ, kHeading, kActive };
inline constexpr size_t kColumnRoles = 8;
/// As in --columns.
inline constexpr std::array<std::string_view, kColumnRoles> kColumnRoleNames = {
    "id", "frame", "t", "x", "y", "z", "heading", "active"};

/// What a column of a role is measured in; none for numbers that only count.
std::optional<Quantity> quantity_of(ColumnRole role);

struct TableColumns {
  static constexpr size_t kNone = ~size_t{0};
  std::array<size_t, kColumnRoles> at = {kNone, kNone, kNone, kNone, kNone, kNone, kNone, kNone};
  std::array<std::string, kColumnRoles>
      units;  ///< as names state them ("x/cm"); empty: they do not
  std::array<std::string, kColumnRoles> remarks;  ///< instead of a unit: "head" of "x (head)"

  bool has(ColumnRole role) const { return (*this)[role] != kNone; }
  size_t operator[](ColumnRole role) const { return at[static_cast<size_t>(role)]; }
  size_t& operator[](ColumnRole role) { return at[static_cast<size_t>(role)]; }
  /// What is missing, in words, or "".
  std::string missing() const;
};

/// What --columns says: a name, or a number from 1, for each role. Throws InputError naming the
/// option.
std::array<std::string, kColumnRoles> parse_columns_option(std::string_view text);

/// The role of a single name; none if it is not one of those that programs give.
std::optional<ColumnRole> role_named(std::string_view name);

/// By names as programs give them; `wanted` goes before. Of several columns of one role the first
/// with a unit that is known counts. Throws InputError, with `where`, if a wanted column is not
/// there.
TableColumns columns_by_name(const std::vector<std::string>& names,
                             const std::array<std::string, kColumnRoles>& wanted,
                             const std::string& where);

/// The separator of a first line: the one of ; , tab that there is most of, else a blank.
char separator_of(std::string_view line);

/// The names in a line that parts its columns by blanks: brackets, and what they hold, belong to
/// the name before them. With `join_units` so do units that fit it ("x cm y cm" are two names).
std::vector<std::string> names_between_blanks(std::string_view line, bool join_units);

/// Fields of a line, quotes taken off. With a blank as separator any number of blanks is one.
/// False if a quote does not end.
bool split(std::string_view line, char separator, std::vector<std::string_view>& out);

}  // namespace throng
