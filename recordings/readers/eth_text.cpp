// EthText reads ETH and UCY files: "frame id x y" at 2.5 positions per second, or obsmat.txt with
// "frame id x z y vx vz vy".
#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <optional>
#include <unordered_map>
#include <vector>

#include "base/errors.h"
#include "base/text.h"
#include "recordings/readers/header_comments.h"
#include "recordings/readers/recording_reader.h"
#include "recordings/readers/stated_units.h"

namespace throng {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
constexpr double kPositionsPerS = 2.5;
constexpr size_t kShort = 4, kLong = 8;

/// Guess measures displacements between lines of one id, for both orders of id and frame.
class Guess {
 public:
  void take(int64_t id, int64_t frame, double x, double y) {
    const auto [it, is_new] = last_.try_emplace(id, Place{frame, x, y});
    if (is_new) return;
    if (frame > it->second.frame) {
      path_m_ += std::hypot(x - it->second.x, y - it->second.y);
      ++steps_;
    }
    it->second = {frame, x, y};
  }
  bool is_nearer_than(const Guess& other) const {
    if (steps_ == 0) return false;
    return other.steps_ == 0 || path_m_ * static_cast<double>(other.steps_) <
                                    other.path_m_ * static_cast<double>(steps_);
  }

 private:
  struct Place {
    int64_t frame;
    double x, y;
  };
  std::unordered_map<int64_t, Place> last_;
  double path_m_ = 0;
  int64_t steps_ = 0;
};

class EthLines final : public LineHandler {
 public:
  explicit EthLines(RecordingBuilder& builder) : builder_(builder) {}

  void take(std::string_view line, int64_t number) override {
    if (is_comment(line)) return comment(line, number);
    fields_of(line, columns_, words_);
    const std::vector<std::string_view>& words = words_;
    if (words.empty()) return;
    if (columns_ == 0) begin(words.size());
    if (words.size() != columns_)
      builder_.reject(number, fmt::format("{} columns, as in the first line", columns_),
                      fmt::format("{}", words.size()));
    int64_t frame = 0, id = 0;
    if (!parse_whole(words[0], frame))
      builder_.reject(number, "a frame that is a whole number", defect_of_whole(words[0]));
    if (!parse_whole(words[1], id))
      builder_.reject(number, "an id that is a whole number", defect_of_whole(words[1]));
    double x = 0, y = 0;
    const std::string_view y_text = words[columns_ == kLong ? 4 : 3];
    if (!parse_number_or_missing(words[2], x) || !parse_number_or_missing(y_text, y))
      builder_.reject(number, "x and y that are numbers", in_quotes(line));
    builder_.add(id,
                 {.instant = static_cast<double>(frame),
                  .x_m = scales_.x.si(x),
                  .y_m = scales_.y.si(y),
                  .z_m = kUnknown,
                  .heading_rad = kUnknown},
                 number);
  }

 private:
  void comment(std::string_view line, int64_t number) {
    if (columns_ == 0) return comments_.read(line, number);
    HeaderComments later;
    later.read(line, number);
    StatedUnits units = later.units();
    later.state_lists(units, roles());
    reject_contradiction(builder_, later, units_, units, number);
  }

  std::vector<std::optional<ColumnRole>> roles() const {
    std::vector<std::optional<ColumnRole>> out = {ColumnRole::kFrame, ColumnRole::kId,
                                                  ColumnRole::kX, ColumnRole::kY};
    if (columns_ == kLong) out.insert(out.begin() + 3, ColumnRole::kZ);
    out.resize(columns_);
    return out;
  }

  /// Called at the first position: the preceding comments and the options apply.
  void begin(size_t columns) {
    columns_ = columns;
    units_ = comments_.units();
    comments_.state_lists(units_, roles());
    scales_ = units_.settle(builder_, false);
    if (!builder_.options().unit_m) units_.state_all("m", "this kind of file", 0);
    const std::optional<double> rate = comments_.rate(builder_);
    if (rate && !(*rate > 0 && *rate <= 10'000))
      throw InputError(builder_.options().file.string(), "a frame rate above 0 and up to 10000",
                       fmt::format("{:g}; --fps 25 overrides the file", *rate));
    RecordingHeader& head = builder_.header();
    head.clock = rate ? RecordedClock::kFrames : RecordedClock::kSteps;
    head.per_s = rate.value_or(kPositionsPerS);
  }

  RecordingBuilder& builder_;
  HeaderComments comments_;
  StatedUnits units_;
  ColumnScales scales_;
  std::vector<std::string_view> words_;
  size_t columns_ = 0;
};

class EthText final : public RecordingReader {
 public:
  std::string_view kind() const override { return "ETH/UCY text"; }

  /// Accepts eight columns, or four with the more likely id in the second; archive text has it
  /// first. A comment that names the columns is decisive: archive text reads it.
  bool knows(std::string_view head) const override {
    Guess frame_first, id_first;
    HeaderComments comments;
    if (head.starts_with("\xEF\xBB\xBF")) head.remove_prefix(3);
    const size_t end = head.rfind('\n');
    if (end != std::string_view::npos) head = head.substr(0, end);
    size_t columns = 0;
    std::vector<std::string_view> words;
    while (!head.empty()) {
      const size_t length = head.find('\n');
      std::string_view line = head.substr(0, length);
      head.remove_prefix(length == std::string_view::npos ? head.size() : length + 1);
      if (line.ends_with('\r')) line.remove_suffix(1);
      if (trimmed(line).empty()) continue;
      if (is_comment(line)) {
        if (columns == 0) comments.read(line, 1);
        continue;
      }
      if (!comments.names().empty()) return false;
      fields_of(line, columns, words);
      if (columns == 0) columns = words.size();
      int64_t first = 0, second = 0;
      double x = 0, y = 0;
      if (words.size() != columns || (columns != kShort && columns != kLong) ||
          !parse_whole(words[0], first) || !parse_whole(words[1], second) ||
          !parse_number_or_missing(words[2], x) ||
          !parse_number_or_missing(words[columns == kLong ? 4 : 3], y))
        return false;
      if (std::isnan(x) || std::isnan(y)) continue;
      frame_first.take(second, first, x, y);
      id_first.take(first, second, x, y);
    }
    // A comment that names only these two is also decisive.
    if (columns == kShort && comments.has_ids_first()) return !*comments.has_ids_first();
    return columns == kLong || (columns == kShort && frame_first.is_nearer_than(id_first));
  }

  void read(const RecordingSource& source, RecordingBuilder& builder) const override {
    builder.header().kind = kind();
    EthLines lines(builder);
    source.lines(lines);
  }
};

}  // namespace

const RecordingReader& eth_text_reader() {
  static const EthText reader;
  return reader;
}

}  // namespace throng
