// StatedUnits collects the units of columns from names, comments, lines of units and options.
#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "recordings/readers/table_columns.h"
#include "recordings/recording_builder.h"
#include "recordings/units.h"

namespace throng {

struct ColumnScales {
  UnitScale x, y, z, time, heading;
  bool has_lengths = false;  ///< the unit of x and y is stated by file or option
  bool has_z = true;         ///< false: the unit of z is unknown
  bool has_time = true;      ///< false: times are ignored, their unit is unknown
  bool has_heading = false;  ///< the unit of headings is stated by file or option
  double area_unit_m = 1;    ///< unit of the walkable area: that of x and y, if equal
};

class StatedUnits {
 public:
  /// `source`: description of the place, as in "the column 'x [cm]'". `line`: 0 if unknown.
  void state(ColumnRole role, std::string_view unit, std::string_view source, int64_t line);
  /// States a unit of x, y and z, or of the columns of its quantity.
  void state_all(std::string_view unit, std::string_view source, int64_t line);
  void state(const TableColumns& columns, const std::vector<std::string>& names, int64_t line);

  /// Records words in a column's name where a unit could be; empty: none. They become notes.
  void remark(ColumnRole role, std::string_view text, std::string_view source);

  void state(const StatedUnits& others);

  /// Resolves all units. Throws InputError for an unknown unit, one of another quantity, or
  /// contradicting ones, unless an option overrides them; overridden units are noted.
  ColumnScales settle(RecordingBuilder& builder, bool reads_time) const;

  /// Returns whether both state equal units for the columns that both state.
  bool agrees_with(const StatedUnits& other) const;

 private:
  struct Stated {
    std::string unit;
    std::string source;
    int64_t line = 0;
    std::string other;
    int64_t other_line = 0;
  };

  struct Remark {
    std::string text, source;
  };

  static bool are_the_same(std::string_view a, std::string_view b);
  const Stated& of(ColumnRole role) const { return stated_[static_cast<size_t>(role)]; }
  std::optional<double> known(ColumnRole role, const RecordingBuilder& builder,
                              std::string_view way_out) const;
  void note_overruled(RecordingBuilder& builder, std::string_view option, double in_si,
                      std::initializer_list<ColumnRole> roles) const;
  void note_remarks(RecordingBuilder& builder) const;
  void settle_lengths(RecordingBuilder& builder, ColumnScales& out) const;
  void settle_heading(RecordingBuilder& builder, ColumnScales& out) const;

  std::array<Stated, kColumnRoles> stated_;
  std::array<Remark, kColumnRoles> remarks_;
};

/// Notes that heights are unknown, because units of x and y differ and z has none.
void note_no_z(RecordingBuilder& builder);

}  // namespace throng
