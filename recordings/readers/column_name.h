// ColumnName splits the name of a column from its unit: "x [cm]", "x/cm", "x (in cm)", "x cm",
// "x_cm".
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "recordings/units.h"

namespace throng {

inline constexpr std::string_view kOpeningBrackets = "[({", kClosingBrackets = "])}";

struct ColumnName {
  std::string text;
  std::string plain;  ///< lower case, without blanks, underscores and brackets
  std::string unit;   ///< text in brackets or after a slash; empty: none
  /// Words in round brackets that are not a unit or similar to one: "head" of "x (head)".
  std::string remark;
  /// Name without its last word, if that is a unit: "x" and "cm" of "x_cm" and "xCm"; else empty.
  /// The column decides: "t_min" is in minutes, "x_min" is a name.
  std::string plain_before_suffix, suffix;

  bool has_suffix_of(std::optional<Quantity> quantity) const;
};

ColumnName column_name(std::string_view text);

/// Unit in brackets or in a line of units without surrounding text: "cm" of "in cm" and "[cm]".
std::string bare_unit(std::string_view text);

}  // namespace throng
