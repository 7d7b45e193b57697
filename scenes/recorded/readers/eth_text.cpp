// ETH and UCY, as the first benchmarks of trajectories have them: "frame id x y", 2.5 positions a
// second, or the obsmat.txt of "frame id x z y vx vz vy".
#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <unordered_map>

#include "base/text.h"
#include "scenes/recorded/readers/recording_reader.h"
#include "scenes/recorded/units.h"

namespace throng {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
constexpr double kPositionsPerS = 2.5;
constexpr size_t kShort = 4, kLong = 8;  ///< columns

/// How far people go from one line to their next if the one column is their id and the other the
/// frame.
class Guess {
 public:
  void take(int64_t id, int64_t frame, double x, double y) {
    const auto [it, is_new] = last_.try_emplace(id, Place{frame, x, y});
    if (is_new) return;
    if (frame > it->second.frame) {
      ways_ += std::hypot(x - it->second.x, y - it->second.y);
      ++steps_;
    }
    it->second = {frame, x, y};
  }
  bool is_nearer_than(const Guess& other) const {
    if (steps_ == 0) return false;
    return other.steps_ == 0 ||
           ways_ * static_cast<double>(other.steps_) < other.ways_ * static_cast<double>(steps_);
  }

 private:
  struct Place {
    int64_t frame;
    double x, y;
  };
  std::unordered_map<int64_t, Place> last_;
  double ways_ = 0;
  int64_t steps_ = 0;
};

class EthLines final : public LineTaker {
 public:
  explicit EthLines(RecordingBuilder& builder)
      : builder_(builder), scale_(builder.options().unit_m.value_or(1)) {}

  void take(std::string_view line, int64_t number) override {
    fields_of(line, columns_, words_);
    const std::vector<std::string_view>& words = words_;
    if (words.empty()) return;
    if (columns_ == 0) columns_ = words.size();
    if (words.size() != columns_)
      builder_.refuse(number, fmt::format("{} columns, as in the first line", columns_),
                      fmt::format("{}", words.size()));
    int64_t frame = 0, id = 0;
    if (!parse_whole(words[0], frame))
      builder_.refuse(number, "a frame that is a whole number", defect_of_whole(words[0]));
    if (!parse_whole(words[1], id))
      builder_.refuse(number, "an id that is a whole number", defect_of_whole(words[1]));
    double x = 0, y = 0;
    const std::string_view y_text = words[columns_ == kLong ? 4 : 3];
    if (!parse_number_or_missing(words[2], x) || !parse_number_or_missing(y_text, y))
      builder_.refuse(number, "x and y that are numbers", in_quotes(line));
    builder_.add(id,
                 {.instant = static_cast<double>(frame),
                  .x_m = scale_.si(x),
                  .y_m = scale_.si(y),
                  .z_m = kUnknown,
                  .heading_rad = kUnknown},
                 number);
  }

 private:
  RecordingBuilder& builder_;
  UnitScale scale_;
  std::vector<std::string_view> words_;
  size_t columns_ = 0;
};

class EthText final : public RecordingReader {
 public:
  std::string_view kind() const override { return "ETH/UCY text"; }

  /// Eight columns, or four of which the second is the likelier id: archive text has it first.
  bool knows(std::string_view head) const override {
    Guess frame_first, id_first;
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
    return columns == kLong || (columns == kShort && frame_first.is_nearer_than(id_first));
  }

  void read(const RecordingSource& source, RecordingBuilder& builder) const override {
    RecordingHead& head = builder.head();
    head.kind = kind();
    head.clock = builder.options().fps ? RecordedClock::kFrames : RecordedClock::kSteps;
    head.per_s = builder.options().fps.value_or(kPositionsPerS);
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
