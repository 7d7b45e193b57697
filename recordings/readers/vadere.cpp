// Vadere reads footsteps (postvis.traj): a line per step, from a place at a time to a place at a
// time.
#include <fmt/format.h>

#include <array>
#include <limits>

#include "base/text.h"
#include "recordings/readers/column_name.h"
#include "recordings/readers/header_comments.h"
#include "recordings/readers/recording_reader.h"
#include "recordings/readers/table_columns.h"

namespace throng {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

enum Column { kId, kFrom, kTo, kFromX, kFromY, kToX, kToY, kColumns };
/// Names may have the suffix of a processor: "endTime-PID1".
constexpr std::array<std::string_view, kColumns> kNames = {
    "pedestrianId", "simTime", "endTime", "startX", "startY", "endX", "endY"};

constexpr std::array<ColumnRole, kColumns> kRoles = {
    ColumnRole::kId, ColumnRole::kTime, ColumnRole::kTime, ColumnRole::kX,
    ColumnRole::kY,  ColumnRole::kX,    ColumnRole::kY};

struct Footsteps {
  std::array<size_t, kColumns> at{};
  std::array<std::string, kColumns> units{};
  std::array<std::string, kColumns> remarks{};
  size_t columns = 0;

  bool find(std::string_view line, char separator) {
    std::vector<std::string_view> names;
    split(line, separator, names);
    columns = names.size();
    for (size_t column = 0; column < kColumns; ++column) {
      at[column] = columns;
      for (size_t i = 0; i < columns; ++i)
        if (is_called(names[i].substr(0, names[i].find('-')), column)) at[column] = i;
      if (at[column] == columns) return false;
    }
    return true;
  }

 private:
  bool is_called(std::string_view text, size_t column) {
    const ColumnName name = column_name(text);
    const bool has_suffix = name.has_suffix_of(quantity_of(kRoles[column]));
    const std::string expected = lower(kNames[column]);
    if (name.plain != expected && (!has_suffix || name.plain_before_suffix != expected))
      return false;
    units[column] = has_suffix ? name.suffix : name.unit;
    remarks[column] = units[column].empty() ? name.remark : "";
    return true;
  }
};

bool is_silent(std::string_view line) { return trimmed(line).empty() || is_comment(line); }

class Steps final : public LineHandler {
 public:
  explicit Steps(RecordingBuilder& builder) : builder_(builder) {}

  void take(std::string_view line, int64_t number) override {
    if (is_silent(line)) {
      if (steps_.columns == 0) comments_.read(line, number);
      return;
    }
    if (steps_.columns == 0) return begin(line, number);
    if (is_empty_row(line, separator_)) return builder_.skip_empty_row(number);
    if (!split(line, separator_, fields_) || fields_.size() != steps_.columns)
      builder_.reject(number, fmt::format("{} columns, as in the first line", steps_.columns),
                      fmt::format("{}", fields_.size()));
    int64_t id = 0;
    if (!parse_whole(text(kId), id))
      builder_.reject(number, "a pedestrianId that is a whole number", defect_of_whole(text(kId)));
    const double from_s = scales_.time.si(value(kFrom, number));
    const double to_s = scales_.time.si(value(kTo, number));
    if (to_s < from_s)
      builder_.reject(number, "a step that ends after it has begun",
                      fmt::format("{} s to {} s", from_s, to_s));
    add(id, from_s, kFromX, number);
    add(id, to_s, kToX, number);
  }

 private:
  std::string_view text(size_t column) const { return fields_[steps_.at[column]]; }
  void begin(std::string_view line, int64_t number) {
    separator_ = separator_of(line);
    steps_.find(line, separator_);
    StatedUnits units = comments_.units();
    for (size_t column = 0; column < kColumns; ++column) {
      const std::string source = fmt::format("the column '{}'", kNames[column]);
      units.state(kRoles[column], steps_.units[column], source, number);
      units.remark(kRoles[column], steps_.remarks[column], source);
    }
    std::vector<std::optional<ColumnRole>> roles(steps_.columns);
    for (size_t column = 0; column < kColumns; ++column) roles[steps_.at[column]] = kRoles[column];
    comments_.state_lists(units, roles);
    scales_ = units.settle(builder_, true);
  }
  double value(size_t column, int64_t number) const {
    double out = 0;
    const bool may_be_missing = column >= kFromX;
    if (!(may_be_missing ? parse_number_or_missing(text(column), out)
                         : parse_number(text(column), out)))
      builder_.reject(number, fmt::format("{} that is a number", kNames[column]),
                      in_quotes(text(column)));
    return out;
  }
  void add(int64_t id, double time_s, size_t x, int64_t number) {
    builder_.add(id,
                 {.instant = time_s,
                  .x_m = scales_.x.si(value(x, number)),
                  .y_m = scales_.y.si(value(x + 1, number)),
                  .z_m = kNone,
                  .heading_rad = kNone},
                 number);
  }

  RecordingBuilder& builder_;
  HeaderComments comments_;
  ColumnScales scales_;
  Footsteps steps_;
  char separator_ = ' ';
  std::vector<std::string_view> fields_;
};

class Vadere final : public RecordingReader {
 public:
  std::string_view kind() const override { return "Vadere footsteps"; }

  bool knows(std::string_view head) const override {
    while (!head.empty()) {
      const size_t length = head.find('\n');
      const std::string_view line = trimmed(head.substr(0, length));
      head.remove_prefix(length == std::string_view::npos ? head.size() : length + 1);
      if (is_silent(line)) continue;
      return Footsteps().find(line, separator_of(line));
    }
    return false;
  }

  void read(const RecordingSource& source, RecordingBuilder& builder) const override {
    builder.header().kind = kind();
    builder.header().clock = RecordedClock::kEvents;
    Steps steps(builder);
    source.lines(steps);
  }
};

}  // namespace

const RecordingReader& vadere_reader() {
  static const Vadere reader;
  return reader;
}

}  // namespace throng
