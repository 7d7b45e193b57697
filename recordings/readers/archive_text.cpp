// ArchiveText reads text as PeTrack writes it: a line of id, frame, x, y and mostly z per head and
// frame. Comments state rate and unit; older files lack them.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/text.h"
#include "recordings/readers/header_comments.h"
#include "recordings/readers/recording_reader.h"
#include "recordings/readers/stated_units.h"
#include "recordings/readers/table_columns.h"

namespace throng {
namespace {

using Roles = std::vector<std::optional<ColumnRole>>;

/// Columns named in a comment, if the names fit the number of columns; "x cm y cm" has two names or
/// four.
struct NamedColumns {
  Roles roles;
  std::vector<std::string> names;
  TableColumns columns;
};

NamedColumns named_columns(const HeaderComments& comments, size_t count) {
  NamedColumns out;
  if (comments.names().empty()) return out;
  out.names = names_between_blanks(comments.names(), true);
  if (out.names.size() != count)
    if (std::vector<std::string> bare = names_between_blanks(comments.names(), false);
        bare.size() == count)
      out.names = std::move(bare);
  out.columns = columns_by_name(out.names, {}, "");
  out.roles.resize(out.names.size());
  for (const ColumnRole role : {ColumnRole::kId, ColumnRole::kFrame, ColumnRole::kX, ColumnRole::kY,
                                ColumnRole::kZ, ColumnRole::kTime})
    if (out.columns.has(role)) out.roles[out.columns[role]] = role;
  return out;
}

class ArchiveLines final : public LineHandler {
 public:
  explicit ArchiveLines(RecordingBuilder& builder) : builder_(builder) {}

  void take(std::string_view line, int64_t number) override {
    const char* at = line.data();
    const char* const end = at + line.size();
    while (at < end && is_blank(*at)) ++at;
    if (at == end) return;
    if (is_comment(line)) {
      comment({at, static_cast<size_t>(end - at)}, number);
      return;
    }
    if (columns_ == 0) begin({at, static_cast<size_t>(end - at)}, number);
    position(at, end, number);
  }

 private:
  void comment(std::string_view line, int64_t number) {
    if (columns_ == 0) return comments_.read(line, number);
    HeaderComments later;
    later.read(line, number);
    StatedUnits units = later.units();
    const NamedColumns named = named_columns(later, columns_);
    units.state(named.columns, named.names, number);
    later.state_lists(units, roles_);
    reject_contradiction(builder_, later, units_, units, number);
  }

  /// Called at the first position: the preceding comments and the options have to be complete.
  void begin(std::string_view line, int64_t number) {
    std::vector<std::string_view> fields;
    fields_of(line, 0, fields);
    columns_ = fields.size();
    NamedColumns named = named_columns(comments_, columns_);
    roles_ = std::move(named.roles);
    if (roles_.empty())
      roles_ = {ColumnRole::kId, ColumnRole::kFrame, ColumnRole::kX, ColumnRole::kY,
                ColumnRole::kZ};
    roles_.resize(columns_);
    for (const ColumnRole role :
         {ColumnRole::kId, ColumnRole::kFrame, ColumnRole::kX, ColumnRole::kY})
      if (std::find(roles_.begin(), roles_.end(), role) == roles_.end())
        builder_.reject(number, "id, frame, x, y and perhaps z",
                        fmt::format("{} columns: {}", columns_, in_quotes(line)));
    units_ = comments_.units();
    units_.state(named.columns, named.names, comments_.names_line());
    comments_.state_lists(units_, roles_);
    comments_.read_rate_in_name(named.columns, comments_.names_line());
    const std::optional<double> rate = comments_.rate(builder_);
    comments_.state_rate(builder_);
    scales_ = units_.settle(builder_, false);
    if (!rate || !scales_.has_lengths)
      throw_missing(builder_, !rate, !scales_.has_lengths, "archive text whose comments lack it");
    if (!(*rate > 0 && *rate <= 10'000))
      builder_.reject(number, "a frame rate above 0 and up to 10000",
                      fmt::format("{:g}; --fps 25 overrides the file", *rate));
    if (!scales_.has_z && std::find(roles_.begin(), roles_.end(), ColumnRole::kZ) != roles_.end())
      note_no_z(builder_);
    RecordingHeader& head = builder_.header();
    head.clock = RecordedClock::kFrames;
    head.per_s = *rate;
  }

  struct Position {
    int64_t id = 0, frame = 0;
    double x = 0, y = 0, z = kMissing;
    double time = kMissing, time_rounding = 0;  ///< only compared; `frame` is used
  };

  void position(const char* at, const char* end, int64_t number) {
    const std::string_view line(at, static_cast<size_t>(end - at));
    if (line.ends_with('\t') || line.find("\t\t") != std::string_view::npos)
      return cells(line, number);
    Position position;
    size_t column = 0;
    while (at < end) {
      at = column < columns_ ? field(at, end, column, position, number) : word_end(at, end);
      ++column;
      while (at < end && is_blank(*at)) ++at;
    }
    if (column != columns_) reject_columns(column, number);
    add(position, number);
  }

  /// Parses a line with tabs, whose fields may be empty.
  void cells(std::string_view line, int64_t number) {
    std::vector<std::string_view> fields;
    fields_of(line, columns_, fields);
    if (fields.size() != columns_) reject_columns(fields.size(), number);
    Position position;
    for (size_t column = 0; column < columns_; ++column)
      field(fields[column].data(), fields[column].data() + fields[column].size(), column, position,
            number);
    add(position, number);
  }

  [[noreturn]] void reject_columns(size_t count, int64_t number) const {
    builder_.reject(number, fmt::format("{} columns, as in the first line", columns_),
                    fmt::format("{}", count));
  }

  const char* field(const char* at, const char* end, size_t column, Position& out,
                    int64_t number) const {
    if (!roles_[column]) return word_end(at, end);
    switch (*roles_[column]) {
      case ColumnRole::kId:
        return whole(at, end, out.id, "an id", number);
      case ColumnRole::kFrame:
        return whole(at, end, out.frame, "a frame", number);
      case ColumnRole::kX:
        return real(at, end, out.x, "x", number);
      case ColumnRole::kY:
        return real(at, end, out.y, "y", number);
      case ColumnRole::kZ:
        return real(at, end, out.z, "z", number);
      case ColumnRole::kTime: {
        const char* const stop = word_end(at, end);
        const std::string_view text(at, static_cast<size_t>(stop - at));
        if (!parse_number(text, out.time)) out.time = kMissing;
        out.time_rounding = 0.5 * std::pow(0.1, decimals_of(text));
        return stop;
      }
      default:
        return word_end(at, end);
    }
  }

  void add(const Position& position, int64_t number) {
    if (std::isinf(position.z)) builder_.reject(number, "z", "infinity");
    if (scales_.has_time && !std::isnan(position.time))
      builder_.frame_times().take(static_cast<double>(position.frame),
                                  scales_.time.si(position.time),
                                  scales_.time.si(position.time_rounding));
    const double z_m = scales_.has_z ? scales_.z.si(position.z) : kMissing;
    builder_.add(position.id,
                 {.instant = static_cast<double>(position.frame),
                  .x_m = scales_.x.si(position.x),
                  .y_m = scales_.y.si(position.y),
                  .z_m = static_cast<float>(z_m),
                  .heading_rad = std::numeric_limits<float>::quiet_NaN()},
                 number);
  }

  static const char* word_end(const char* at, const char* end) {
    while (at < end && !is_blank(*at)) ++at;
    return at;
  }

  const char* whole(const char* at, const char* end, int64_t& out, const char* what,
                    int64_t number) const {
    const auto [stop, error] = std::from_chars(at, end, out);
    if (error == std::errc() && (stop == end || is_blank(*stop))) return stop;
    const char* const word = word_end(at, end);
    const std::string_view text(at, static_cast<size_t>(word - at));
    if (!parse_whole(text, out))
      builder_.reject(number, fmt::format("{} that is a whole number", what),
                      defect_of_whole(text));
    return word;
  }

  const char* real(const char* at, const char* end, double& out, const char* what,
                   int64_t number) const {
    const auto [stop, error] = std::from_chars(at, end, out);
    if (error == std::errc() && (stop == end || is_blank(*stop))) return stop;
    const char* const word = word_end(at, end);
    const std::string_view text(at, static_cast<size_t>(word - at));
    if (!parse_number_or_missing(text, out))
      builder_.reject(number, fmt::format("{} that is a number", what), in_quotes(text));
    return word;
  }

  RecordingBuilder& builder_;
  HeaderComments comments_;
  StatedUnits units_;
  Roles roles_;
  size_t columns_ = 0;
  ColumnScales scales_;
};

class ArchiveText final : public RecordingReader {
 public:
  std::string_view kind() const override { return "archive text"; }

  /// The first non-comment line begins with two whole numbers, then two numbers.
  bool knows(std::string_view head) const override {
    if (head.starts_with("\xEF\xBB\xBF")) head.remove_prefix(3);
    HeaderComments comments;
    for (int64_t number = 1; !head.empty(); ++number) {
      const size_t length = head.find('\n');
      const std::string_view line = trimmed(head.substr(0, length));
      head.remove_prefix(length == std::string_view::npos ? head.size() : length + 1);
      if (line.empty()) continue;
      if (!is_comment(line)) return is_position(line);
      comments.read(line, number);
    }
    return !comments.names().empty();
  }

  void read(const RecordingSource& source, RecordingBuilder& builder) const override {
    builder.header().kind = kind();
    builder.header().tracked_point = TrackedPoint::kHead;
    ArchiveLines lines(builder);
    source.lines(lines);
  }

 private:
  static bool is_position(std::string_view line) {
    const std::vector<std::string_view> words = words_of(line);
    int64_t whole = 0;
    double value = 0;
    if (words.size() < 3 || !parse_whole(words[0], whole) || !parse_whole(words[1], whole))
      return false;
    for (size_t i = 2; i < std::min<size_t>(words.size(), 4); ++i)
      if (!parse_number_or_missing(words[i], value)) return false;
    return true;
  }
};

}  // namespace

const RecordingReader& archive_text_reader() {
  static const ArchiveText reader;
  return reader;
}

}  // namespace throng
