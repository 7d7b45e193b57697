// The name of a column and the unit that it states: "x [cm]", "x/cm", "x (in cm)", "x cm", "x_cm".
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "recordings/units.h"

namespace throng {

/// Around units, and what else a name explains.
inline constexpr std::string_view kOpeningBrackets = "[({", kClosingBrackets = "])}";

struct ColumnName {
  std::string text;   ///< as the file has it
  std::string plain;  ///< in small letters, without blanks, underscores and what is in brackets
  std::string unit;   ///< in brackets or behind a slash, any text; empty: none
  /// Words in round brackets that are no unit and not like one: "head" of "x (head)".
  std::string remark;
  /// The same if the last word is a unit ("x" and "cm" of "x_cm" and "xCm"); empty if it is none.
  /// Whether it is one depends on the column: "t_min" are minutes, "x_min" is a name.
  std::string plain_before_suffix, suffix;

  /// The unit that the suffix is if the column holds this quantity.
  bool has_suffix_of(std::optional<Quantity> quantity) const;
};

ColumnName column_name(std::string_view text);

/// A unit as it stands in brackets or a line of units, without what surrounds it: "in cm", "[cm]".
std::string bare_unit(std::string_view text);

}  // namespace throng
