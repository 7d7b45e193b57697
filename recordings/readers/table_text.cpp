// TableText reads tables with named columns: Crowd:it, Pathfinder, Viswalk, CSV of --trajectory,
// and any other table with an id, an instant, x and y.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "base/errors.h"
#include "base/text.h"
#include "recordings/readers/column_name.h"
#include "recordings/readers/header_comments.h"
#include "recordings/readers/recording_reader.h"
#include "recordings/readers/stated_units.h"
#include "recordings/readers/table_columns.h"

namespace throng {
namespace {

/// A full turn with rounding; headings in degrees exceed it.
constexpr double kMaxHeading_rad = 2 * std::numbers::pi + 1e-3;
constexpr std::string_view kViswalkColumns = "$PEDESTRIAN:";
constexpr std::string_view kViswalkFirst = "$VISION";

/// Returns whether a line has no content: blank lines, comments, and lines of Viswalk before its
/// columns.
bool is_uninformative(std::string_view line) {
  return trimmed(line).empty() || is_comment(line) || line.starts_with('*') ||
         (line.starts_with('$') && !line.starts_with(kViswalkColumns));
}

/// Empty rows before the line of names, whose separator is not yet known.
bool is_empty_row_above(std::string_view line) {
  return is_empty_row(line, ',') || is_empty_row(line, ';');
}

std::string_view names_in(std::string_view line) {
  if (line.starts_with(kViswalkColumns)) line.remove_prefix(kViswalkColumns.size());
  return line;
}

std::vector<std::string> names_of(std::string_view line, char separator, bool join_units = true) {
  if (separator == ' ') return names_between_blanks(names_in(line), join_units);
  std::vector<std::string_view> fields;
  split(names_in(line), separator, fields);
  return {fields.begin(), fields.end()};
}

std::string kind_of(std::string_view line) {
  if (line.starts_with(kViswalkColumns)) return "Viswalk";
  if (line.starts_with("frame,time_s,id,x_m,y_m")) return "Throng CSV";
  if (line.starts_with("\"t\",\"id\",\"name\",\"active\"")) return "Pathfinder";
  if (line.starts_with("time,pedID,posX,posY")) return "Crowd:it";
  return "table";
}

class Rows final : public LineHandler {
 public:
  explicit Rows(RecordingBuilder& builder)
      : builder_(builder), requested_(parse_columns_option(builder.options().columns)) {}

  void take(std::string_view line, int64_t number) override {
    if (separator_ != 0 ? is_empty_row(line, separator_) : is_empty_row_above(line)) {
      builder_.skip_empty_row(number);
    } else if (is_uninformative(line)) {
      if (!is_settled_) comments_.read(line, number);
    } else if (names_.empty()) {
      begin(line, number);
    } else {
      row(line, number);
    }
  }

 private:
  void begin(std::string_view line, int64_t number) {
    const RecordingOptions& options = builder_.options();
    separator_ = options.separator != 0 ? options.separator : separator_of(names_in(line));
    names_ = names_of(line, separator_);
    names_line_ = number;
    bare_names_ = names_of(line, separator_, false);
    columns_ = columns_by_name(names_, requested_, builder_.where(number));
    if (const std::string missing = columns_.missing(); !missing.empty())
      builder_.reject(number,
                      fmt::format("columns for id, t or frame, x and y; name those for {} with "
                                  "--columns id=pedID,t=time,x=posX,y=posY",
                                  missing),
                      in_quotes(line));
    builder_.header().kind = kind_of(line);
    double value = 0;
    if (number_in(ColumnRole::kX, names_, value) && number_in(ColumnRole::kY, names_, value) &&
        number_in(ColumnRole::kId, names_, value))
      row(line, number);
    is_second_ = !is_settled_;
  }

  template <typename Fields>
  bool number_in(ColumnRole role, const Fields& fields, double& out) const {
    const std::string_view field = fields[columns_[role]];
    return role == ColumnRole::kId ? parse_number(field, out) : parse_number_or_missing(field, out);
  }

  /// Called at the line after the names. Words between blanks may be units or names: the number of
  /// fields decides.
  void take_names() {
    if (fields_.size() != names_.size() && fields_.size() == bare_names_.size()) {
      const TableColumns columns =
          columns_by_name(bare_names_, requested_, builder_.where(names_line_));
      if (columns.missing().empty()) {
        names_ = std::move(bare_names_);
        columns_ = columns;
      }
    }
    units_.state(comments_.units());
    if (!comments_.names().empty()) {
      const std::vector<std::string> named = names_between_blanks(comments_.names(), true);
      units_.state(columns_by_name(named, {}, ""), named, comments_.names_line());
    }
    units_.state(columns_, names_, names_line_);
    std::vector<std::optional<ColumnRole>> roles(names_.size());
    for (size_t role = 0; role < kColumnRoles; ++role)
      if (columns_.at[role] != TableColumns::kNone)
        roles[columns_.at[role]] = static_cast<ColumnRole>(role);
    comments_.state_lists(units_, roles);
  }

  /// Pathfinder has units below the names.
  bool is_units(int64_t line) {
    double value = 0;
    if (!std::exchange(is_second_, false)) return false;
    const std::string_view id = text(ColumnRole::kId), x = text(ColumnRole::kX),
                           y = text(ColumnRole::kY);
    for (const std::string_view field : {id, x, y})
      if (parse_number(field, value)) return false;
    if (is_missing(x) || is_missing(y)) return false;
    for (const ColumnRole role : {ColumnRole::kTime, ColumnRole::kX, ColumnRole::kY, ColumnRole::kZ,
                                  ColumnRole::kHeading}) {
      if (!columns_.has(role)) continue;
      // Units of names in capitals are also in capitals.
      const std::string& name = names_[columns_[role]];
      const std::string unit(text(role));
      units_.state(role,
                   bare_unit(has_small_letter(name) ? unit : without_capitals_throughout(unit)),
                   "the line of units, column " + in_quotes(name), line);
    }
    return true;
  }

  /// Called before the first row: names, comments, the line of units and options have to be
  /// complete.
  void settle() {
    is_settled_ = true;
    comments_.read_rate_in_name(columns_, names_line_);
    const RecordingOptions& options = builder_.options();
    const bool has_time = columns_.has(ColumnRole::kTime);
    const bool has_frame = columns_.has(ColumnRole::kFrame);
    by_frame_ = has_frame && (!has_time || options.fps);
    RecordingHeader& head = builder_.header();
    head.clock = by_frame_ ? RecordedClock::kFrames : RecordedClock::kTimes;
    head.rounding_s = 0.5;
    if (by_frame_)
      settle_frames();
    else
      head.per_s = options.fps.value_or(0);
    if (options.heading_unit_rad && !columns_.has(ColumnRole::kHeading))
      throw InputError("--heading-unit", "a table with a column of headings",
                       "a table without one; --columns heading=NAME names it");
    comments_.state_rate(builder_);
    scales_ = units_.settle(builder_, !by_frame_);
    if (!scales_.has_z && columns_.has(ColumnRole::kZ)) note_no_z(builder_);
  }

  void settle_frames() {
    RecordingHeader& head = builder_.header();
    const std::optional<double> rate = comments_.rate(builder_);
    if (!rate) throw_missing(builder_, true, false, "a table with frame numbers and no times");
    if (!(*rate > 0 && *rate <= 10'000))
      throw InputError(builder_.options().file.string(), "a frame rate above 0 and up to 10000",
                       fmt::format("{:g}; --fps 25 overrides the file", *rate));
    head.per_s = *rate;
    const std::string& unit = columns_.units[static_cast<size_t>(ColumnRole::kFrame)];
    if (const std::optional<Unit> found = unit_named(unit))
      builder_.reject(names_line_, "a column of frames, which are numbers without a unit",
                      fmt::format("{} in {}; --columns t=NAME is for times", in_quotes(unit),
                                  in_quotes(names_[columns_[ColumnRole::kFrame]])));
  }

  std::string_view text(ColumnRole role) const { return fields_[columns_[role]]; }

  double number(ColumnRole role, int64_t line) const {
    double out = 0;
    const std::string_view found = text(role);
    if (!parse_number(found, out) || !std::isfinite(out))
      builder_.reject(line, fmt::format("a number in the column '{}'", names_[columns_[role]]),
                      found.empty() ? "nothing" : in_quotes(found) + hint(found));
    return out;
  }
  static std::string hint(std::string_view found) {
    return found.find(',') != std::string_view::npos ? "; write decimals with a point" : "";
  }
  int64_t whole(ColumnRole role, int64_t line) const {
    int64_t out = 0;
    if (!parse_whole(text(role), out))
      builder_.reject(line,
                      fmt::format("a whole number in the column '{}'", names_[columns_[role]]),
                      defect_of_whole(text(role)));
    return out;
  }
  double number_or_missing(ColumnRole role, int64_t line) const {
    double out = 0;
    const bool is_number = parse_number(text(role), out) && std::isfinite(out);
    if (!is_number && is_missing(text(role))) return kMissing;
    return is_number ? out : number(role, line);
  }
  float height(int64_t line) const {
    if (!columns_.has(ColumnRole::kZ) || !scales_.has_z) return static_cast<float>(kMissing);
    return static_cast<float>(scales_.z.si(number_or_missing(ColumnRole::kZ, line)));
  }
  float heading(int64_t line) const {
    if (!columns_.has(ColumnRole::kHeading)) return static_cast<float>(kMissing);
    const double value = number_or_missing(ColumnRole::kHeading, line);
    if (!scales_.has_heading && std::abs(value) > kMaxHeading_rad)
      builder_.reject(
          line,
          fmt::format("headings from -2 pi to 2 pi rad in the column {}, which has no unit",
                      in_quotes(names_[columns_[ColumnRole::kHeading]])),
          fmt::format("{}; state their unit with --heading-unit deg or rad",
                      in_quotes(text(ColumnRole::kHeading))));
    return static_cast<float>(scales_.heading.si(value));
  }

  /// Half of the last digit of all times so far.
  double rounding_s() {
    if (const int decimals = decimals_of(text(ColumnRole::kTime)); decimals > decimals_) {
      decimals_ = decimals;
      rounding_s_ = 0.5 * scales_.time.si(std::pow(0.1, decimals));
    }
    return rounding_s_;
  }

  /// Compares frame and time: one of them is used, the other checks the stated rate.
  void compare_instants() {
    if (!columns_.has(ColumnRole::kFrame) || !columns_.has(ColumnRole::kTime) || !scales_.has_time)
      return;
    double frame = 0, time = 0;
    if (parse_number(text(ColumnRole::kFrame), frame) &&
        parse_number(text(ColumnRole::kTime), time))
      builder_.frame_times().take(frame, scales_.time.si(time), rounding_s());
  }

  void row(std::string_view line, int64_t line_number) {
    if (!split(line, separator_, fields_))
      builder_.reject(line_number, "a second quote", in_quotes(line));
    if (!std::exchange(has_names_, true)) take_names();
    if (fields_.size() != names_.size())
      builder_.reject(line_number, fmt::format("{} columns, as in the first line", names_.size()),
                      fmt::format("{}", fields_.size()));
    if (is_units(line_number)) return;
    if (!is_settled_) settle();
    if (columns_.has(ColumnRole::kActive) && number(ColumnRole::kActive, line_number) == 0) return;
    StoredSample sample;
    if (by_frame_) {
      sample.instant = static_cast<double>(whole(ColumnRole::kFrame, line_number));
    } else {
      sample.instant = scales_.time.si(number(ColumnRole::kTime, line_number));
      builder_.header().rounding_s = rounding_s();
    }
    compare_instants();
    sample.x_m = scales_.x.si(number_or_missing(ColumnRole::kX, line_number));
    sample.y_m = scales_.y.si(number_or_missing(ColumnRole::kY, line_number));
    sample.z_m = height(line_number);
    sample.heading_rad = heading(line_number);
    builder_.add(whole(ColumnRole::kId, line_number), sample, line_number);
  }

  RecordingBuilder& builder_;
  const std::array<std::string, kColumnRoles> requested_;
  HeaderComments comments_;
  char separator_ = 0;
  std::vector<std::string> names_, bare_names_;
  int64_t names_line_ = 0;
  std::vector<std::string_view> fields_;
  TableColumns columns_;
  StatedUnits units_;
  bool has_names_ = false;
  bool is_settled_ = false;
  bool by_frame_ = false;
  bool is_second_ = false;
  int decimals_ = -1;
  double rounding_s_ = 0;
  ColumnScales scales_;
};

class TableText final : public RecordingReader {
 public:
  std::string_view kind() const override { return "table"; }

  bool knows(std::string_view head) const override {
    if (head.starts_with("\xEF\xBB\xBF")) head.remove_prefix(3);
    while (!head.empty()) {
      const size_t length = head.find('\n');
      const std::string_view line = trimmed(head.substr(0, length));
      head.remove_prefix(length == std::string_view::npos ? head.size() : length + 1);
      if (is_uninformative(line) || is_empty_row_above(line)) continue;
      return line.size() < LineSplitter::kMaxLineBytes &&
             columns_by_name(names_of(line, separator_of(names_in(line))), {}, "")
                 .missing()
                 .empty();
    }
    return false;
  }

  void read(const RecordingSource& source, RecordingBuilder& builder) const override {
    Rows rows(builder);
    source.lines(rows);
  }
};

}  // namespace

const RecordingReader& table_text_reader() {
  static const TableText reader;
  return reader;
}

}  // namespace throng
