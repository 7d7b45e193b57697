// Comments before the first position of a text: the frame rate, the units and the names of columns
// that they state.
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
  /// A line with its comment sign. What states nothing is skipped.
  void read(std::string_view line, int64_t number);

  /// The rate that the name of a column of frames states, if it does: "frame [25 fps]".
  void read_rate_in_name(const TableColumns& columns, int64_t number);

  /// The rate that --fps or else the comments state. Throws InputError for one that is not
  /// understood, or for two, unless the option overrules them; notes what is overruled.
  std::optional<double> rate(RecordingBuilder& builder) const;
  /// Tells the builder which rate is stated, and where: --fps goes before.
  void state_rate(RecordingBuilder& builder) const;
  /// What the comments state, whatever --fps is.
  std::optional<double> stated_rate() const { return rate_ ? rate_->per_s : std::nullopt; }
  /// But for those in names() and in lists.
  const StatedUnits& units() const { return units_; }
  /// States the units of lines that list one for each column ("# -,ms,cm,mm"). A list that does not
  /// fit the columns, whose roles are given in their order, makes settle() refuse the file.
  void state_lists(StatedUnits& units, std::span<const std::optional<ColumnRole>> roles) const;
  /// The last line that names id, frame or time, x and y; empty if there is none.
  const std::string& names() const { return names_; }
  int64_t names_line() const { return names_line_; }
  /// Whether ids come before frames, as a comment that begins with both says: "# frame id ...".
  std::optional<bool> has_ids_first() const { return has_ids_first_; }

 private:
  struct Rate {
    std::string text;
    std::optional<double> per_s;
    int64_t line = 0;
    std::string_view place = "the comment";
  };

  /// A comment that names units, perhaps one for each column.
  struct List {
    std::string text;
    std::vector<std::string> fields;  ///< without what surrounds units
    bool has_separators = false;      ///< other than blanks
    int64_t line = 0;
  };

  void read_list(std::string_view line, int64_t number);
  void read_rate(const std::string& text, int64_t number);
  void add_rate(Rate rate);
  void read_names(std::string_view text, int64_t number);
  void read_description(std::string_view text, int64_t number);
  void read_units(std::string_view text, int64_t number);

  std::optional<Rate> rate_;
  std::optional<Rate> other_rate_;  ///< stated as well, and not the same
  StatedUnits units_;
  std::string names_;
  int64_t names_line_ = 0;
  std::optional<bool> has_ids_first_;
  std::vector<List> lists_;
};

/// Throws InputError for a comment behind the first position that states another rate than the
/// recording has, or another unit: a second file behind the first one.
void refuse_contradiction(RecordingBuilder& builder, const HeaderComments& later,
                          const StatedUnits& now, const StatedUnits& then, int64_t number);

/// The unit in a description of a column: "x-coordinate (meter [m])", "positions (in cm)". Empty if
/// it states none.
std::string unit_in_description(std::string_view text, Quantity quantity);

/// The rate of --fps, or what the file states; a note where these differ.
std::optional<double> overruled_rate(RecordingBuilder& builder, std::optional<double> stated,
                                     std::string_view source);

}  // namespace throng
