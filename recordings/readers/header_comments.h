// HeaderComments reads frame rate, units and column names from comments before the first position.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "recordings/readers/stated_units.h"

namespace throng {

class HeaderComments {
 public:
  /// Reads a line with its comment sign; lines without a statement are ignored.
  void read(std::string_view line, int64_t number);

  /// Reads the rate in the name of a frame column: "frame [25 fps]".
  void read_rate_in_name(const TableColumns& columns, int64_t number);

  /// Rate of --fps, or else of the comments. Throws InputError for an invalid rate or two rates,
  /// unless the option overrides them; overridden rates are noted.
  std::optional<double> rate(RecordingBuilder& builder) const;
  /// Passes the stated rate and its source to the builder; --fps takes precedence.
  void state_rate(RecordingBuilder& builder) const;
  std::optional<double> stated_rate() const { return rate_ ? rate_->per_s : std::nullopt; }
  /// Units of statements; excludes those in names() and lists.
  const StatedUnits& units() const { return units_; }
  /// States the units of lines with one unit per column ("# -,ms,cm,mm"). `roles` are in the order
  /// of columns. A list that does not fit the columns makes settle() reject the file.
  void state_lists(StatedUnits& units, std::span<const std::optional<ColumnRole>> roles) const;
  /// Last line that names id, frame or time, x and y; empty: none.
  const std::string& names() const { return names_; }
  int64_t names_line() const { return names_line_; }
  /// Whether ids come before frames, from a comment with both names: "# frame id ...".
  std::optional<bool> has_ids_first() const { return has_ids_first_; }

 private:
  struct Rate {
    std::string text;
    std::optional<double> per_s;
    int64_t line = 0;
    std::string_view place = "the comment";
  };

  /// Comment that consists of units, perhaps one per column.
  struct List {
    std::string text;
    std::vector<std::string> fields;
    bool has_separators = false;
    int64_t line = 0;
  };

  void read_list(std::string_view line, int64_t number);
  void read_rate(const std::string& text, int64_t number);
  void add_rate(Rate rate);
  void read_names(std::string_view text, int64_t number);
  void read_description(std::string_view text, int64_t number);
  void read_units(std::string_view text, int64_t number);

  std::optional<Rate> rate_;
  std::optional<Rate> other_rate_;
  StatedUnits units_;
  std::string names_;
  int64_t names_line_ = 0;
  std::optional<bool> has_ids_first_;
  std::vector<List> lists_;
};

/// Throws InputError for a comment after the first position with another rate or unit, as in two
/// concatenated files.
void reject_contradiction(RecordingBuilder& builder, const HeaderComments& later,
                          const StatedUnits& now, const StatedUnits& then, int64_t number);

/// Unit in the description of a column: "x-coordinate (meter [m])", "positions (in cm)"; empty:
/// none.
std::string unit_in_description(std::string_view text, Quantity quantity);

/// Rate of --fps or of the file, with a note if they differ.
std::optional<double> overruled_rate(RecordingBuilder& builder, std::optional<double> stated,
                                     std::string_view source);

}  // namespace throng
