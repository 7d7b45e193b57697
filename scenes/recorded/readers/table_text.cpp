// Tables with named columns: Crowd:it, Pathfinder, Viswalk, our own --trajectory CSV, and whatever
// has an id, an instant, x and y.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/errors.h"
#include "base/text.h"
#include "scenes/recorded/readers/recording_reader.h"
#include "scenes/recorded/readers/table_columns.h"

namespace throng {
namespace {

constexpr float kNotSaid = std::numeric_limits<float>::quiet_NaN();
constexpr std::string_view kViswalkColumns = "$PEDESTRIAN:";
constexpr std::string_view kViswalkFirst = "$VISION";

/// Digits behind the point; many where there is an exponent.
int decimals_of(std::string_view number) {
  if (number.find_first_of("eE") != std::string_view::npos) return 9;
  const size_t point = number.find('.');
  return point == std::string_view::npos ? 0 : static_cast<int>(number.size() - point - 1);
}

/// Lines that say nothing: blank ones, comments, and what Viswalk puts before its columns.
bool says_nothing(std::string_view line) {
  return trimmed(line).empty() || line.starts_with('#') || line.starts_with('*') ||
         (line.starts_with('$') && !line.starts_with(kViswalkColumns));
}

/// The line of names, without what Viswalk puts before it.
std::string_view names_in(std::string_view line) {
  if (line.starts_with(kViswalkColumns)) line.remove_prefix(kViswalkColumns.size());
  return line;
}

std::vector<std::string> names_of(std::string_view line, char separator) {
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

class Rows final : public LineTaker {
 public:
  explicit Rows(RecordingBuilder& builder)
      : builder_(builder), wanted_(parse_columns_option(builder.options().columns)) {}

  void take(std::string_view line, int64_t number) override {
    if (says_nothing(line)) return;
    if (names_.empty())
      begin(line, number);
    else
      row(line, number);
  }

 private:
  void begin(std::string_view line, int64_t number) {
    const RecordingOptions& options = builder_.options();
    separator_ = options.separator != 0 ? options.separator : separator_of(names_in(line));
    names_ = names_of(line, separator_);
    columns_ = columns_by_name(names_, wanted_, builder_.where(number));
    if (const std::string missing = columns_.missing(); !missing.empty())
      builder_.refuse(number,
                      fmt::format("columns for id, t or frame, x and y; name those for {} with "
                                  "--columns id=pedID,t=time,x=posX,y=posY",
                                  missing),
                      in_quotes(line));
    const bool has_time = columns_.has(ColumnRole::kTime);
    const bool has_frame = columns_.has(ColumnRole::kFrame);
    by_frame_ = has_frame && (!has_time || options.fps);
    if (by_frame_ && !options.fps)
      ask_for(builder_, true, false, "a table that numbers its frames and has no times");
    RecordingHead& head = builder_.head();
    head.kind = kind_of(line);
    head.clock = by_frame_ ? RecordedClock::kFrames : RecordedClock::kTimes;
    head.per_s = options.fps.value_or(0);
    head.rounding_s = 0.5;
    unit_ = LengthUnit(options.unit_m.value_or(columns_.unit_m > 0 ? columns_.unit_m : 1));
    // Without names the first line is a row like any other.
    double value = 0;
    if (number_in(ColumnRole::kX, names_, value) && number_in(ColumnRole::kY, names_, value) &&
        number_in(ColumnRole::kId, names_, value))
      row(line, number);
    is_second_ = true;
  }

  template <typename Fields>
  bool number_in(ColumnRole role, const Fields& fields, double& out) const {
    return parse_number(fields[columns_[role]], out);
  }

  /// Pathfinder has units below the names.
  bool is_units() {
    double value = 0;
    if (!std::exchange(is_second_, false)) return false;
    const std::string_view x = fields_[columns_[ColumnRole::kX]];
    const std::string_view id = fields_[columns_[ColumnRole::kId]];
    if (!id.empty() && parse_number(id, value)) return false;
    const double unit_m = unit_of_length_m(x);
    if (unit_m == 0 || unit_of_length_m(fields_[columns_[ColumnRole::kY]]) != unit_m) return false;
    if (!builder_.options().unit_m) unit_ = LengthUnit(unit_m);
    if (columns_.has(ColumnRole::kTime) && !by_frame_) {
      const std::string unit = lower(fields_[columns_[ColumnRole::kTime]]);
      time_unit_s_ = unit == "ms" ? 0.001 : 1;
    }
    return true;
  }

  std::string_view text(ColumnRole role) const { return fields_[columns_[role]]; }

  double number(ColumnRole role, int64_t line) const {
    double out = 0;
    const std::string_view found = text(role);
    if (!parse_number(found, out) || !std::isfinite(out))
      builder_.refuse(line, fmt::format("a number in the column '{}'", names_[columns_[role]]),
                      found.empty() ? "nothing" : in_quotes(found) + hint(found));
    return out;
  }
  static std::string hint(std::string_view found) {
    return found.find(',') != std::string_view::npos ? "; write decimals with a point" : "";
  }
  int64_t whole(ColumnRole role, int64_t line) const {
    int64_t out = 0;
    if (!parse_whole(text(role), out))
      builder_.refuse(line,
                      fmt::format("a whole number in the column '{}'", names_[columns_[role]]),
                      defect_of_whole(text(role)));
    return out;
  }
  float optional(ColumnRole role, int64_t line) const {
    if (!columns_.has(role) || text(role).empty() || lower(text(role)) == "nan") return kNotSaid;
    return static_cast<float>(number(role, line));
  }

  void row(std::string_view line, int64_t line_number) {
    if (!split(line, separator_, fields_))
      builder_.refuse(line_number, "a second quote", in_quotes(line));
    if (fields_.size() != names_.size())
      builder_.refuse(line_number, fmt::format("{} columns, as in the first line", names_.size()),
                      fmt::format("{}", fields_.size()));
    if (is_units()) return;
    if (columns_.has(ColumnRole::kActive) && number(ColumnRole::kActive, line_number) == 0) return;
    StoredSample sample;
    if (by_frame_) {
      sample.instant = static_cast<double>(whole(ColumnRole::kFrame, line_number));
    } else {
      sample.instant = time_unit_s_ * number(ColumnRole::kTime, line_number);
      decimals_ = std::max(decimals_, decimals_of(text(ColumnRole::kTime)));
      builder_.head().rounding_s = 0.5 * time_unit_s_ * std::pow(0.1, decimals_);
    }
    sample.x_m = unit_.metres(number(ColumnRole::kX, line_number));
    sample.y_m = unit_.metres(number(ColumnRole::kY, line_number));
    const float z = optional(ColumnRole::kZ, line_number);
    sample.z_m = static_cast<float>(unit_.metres(static_cast<double>(z)));
    sample.heading_rad = optional(ColumnRole::kHeading, line_number);
    builder_.add(whole(ColumnRole::kId, line_number), sample, line_number);
  }

  RecordingBuilder& builder_;
  const std::array<std::string, kColumnRoles> wanted_;
  char separator_ = 0;
  std::vector<std::string> names_;
  std::vector<std::string_view> fields_;
  TableColumns columns_;
  bool by_frame_ = false;
  bool is_second_ = false;
  int decimals_ = 0;
  double time_unit_s_ = 1;
  LengthUnit unit_;
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
      if (says_nothing(line)) continue;
      return line.size() < LineCutter::kLongest &&
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
