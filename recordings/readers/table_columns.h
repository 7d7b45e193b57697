// TableColumns maps roles to the columns of a table, by names or options.
// Invariant: a table is accepted only if its names identify id, instant, x and y unambiguously.
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
inline constexpr std::array<std::string_view, kColumnRoles> kColumnRoleNames = {
    "id", "frame", "t", "x", "y", "z", "heading", "active"};

std::optional<Quantity> quantity_of(ColumnRole role);

struct TableColumns {
  static constexpr size_t kNone = ~size_t{0};
  std::array<size_t, kColumnRoles> at = {kNone, kNone, kNone, kNone, kNone, kNone, kNone, kNone};
  std::array<std::string, kColumnRoles> units;    ///< text in names ("x/cm"); empty: not stated
  std::array<std::string, kColumnRoles> remarks;  ///< instead of a unit: "head" of "x (head)"

  bool has(ColumnRole role) const { return (*this)[role] != kNone; }
  size_t operator[](ColumnRole role) const { return at[static_cast<size_t>(role)]; }
  size_t& operator[](ColumnRole role) { return at[static_cast<size_t>(role)]; }
  std::string missing() const;
};

/// Parses --columns: a column name, or a number from 1, per role. Throws InputError.
std::array<std::string, kColumnRoles> parse_columns_option(std::string_view text);

/// Role of a known column name; empty for others.
std::optional<ColumnRole> role_named(std::string_view name);

/// Finds columns by known names; `requested` takes precedence. Among several columns of a role the
/// first with a known unit is used. Throws InputError at `where` if a requested column is missing.
TableColumns columns_by_name(const std::vector<std::string>& names,
                             const std::array<std::string, kColumnRoles>& requested,
                             const std::string& where);

/// Separator of a first line: the most frequent of ; , tab, else a blank.
char separator_of(std::string_view line);

/// Names in a line with blanks as separators. Brackets and their content belong to the preceding
/// name. With `join_units` so do units that fit it ("x cm y cm" has two names).
std::vector<std::string> names_between_blanks(std::string_view line, bool join_units);

/// Splits a line into fields without quotes. Consecutive blanks count as one separator. Returns
/// false for an open quote.
bool split(std::string_view line, char separator, std::vector<std::string_view>& out);

}  // namespace throng
