// What a file states about the units of its columns, from names, comments and a line of units, and
// what the options overrule.
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

/// Of the columns of a file.
struct ColumnScales {
  UnitScale x, y, z, time, heading;
  bool has_lengths = false;  ///< the file or an option states the unit of x and y
  bool has_z = true;         ///< false: the unit of z cannot be known
  bool has_time = true;      ///< false: times are not read, and their unit is not known
  bool has_heading = false;  ///< the file or an option states the unit of headings
  double area_unit_m = 1;    ///< of the walkable area: that of x and y, if they share one
};

class StatedUnits {
 public:
  /// `source`: what states it, in words: "the column 'x [cm]'". `line`: 0 where there are none.
  void state(ColumnRole role, std::string_view unit, std::string_view source, int64_t line);
  /// The same of x, y and z, or whichever quantity the unit is of.
  void state_all(std::string_view unit, std::string_view source, int64_t line);
  /// What the names of columns state.
  void state(const TableColumns& columns, const std::vector<std::string>& names, int64_t line);

  /// Words in the name of a column where a unit could be; empty: none. They are noted.
  void remark(ColumnRole role, std::string_view text, std::string_view source);

  /// All that is stated elsewhere.
  void state(const StatedUnits& others);

  /// Throws InputError for a unit that is not known, is no unit of that quantity, or differs from
  /// what the file states elsewhere, unless an option overrules it; notes what is overruled.
  ColumnScales settle(RecordingBuilder& builder, bool reads_time) const;

  /// True if both state all they state in the same units.
  bool agrees_with(const StatedUnits& other) const;

 private:
  struct Stated {
    std::string unit;  ///< empty: nothing
    std::string source;
    int64_t line = 0;
    std::string other;  ///< what is stated elsewhere, if it is not the same
    int64_t other_line = 0;
  };

  /// A remark in the name of a column, where a unit could be.
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

/// Notes that positions have no heights because x and y differ in their units and z has none.
void note_no_z(RecordingBuilder& builder);

}  // namespace throng
