// Archive text, as PeTrack writes it: a line of id, frame, x, y and mostly z for each head and
// frame; comments say rate and unit, in older files nothing does.
#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>

#include "base/text.h"
#include "scenes/recorded/readers/recording_reader.h"

namespace throng {
namespace {

enum class Role : uint8_t { kNone, kId, kFrame, kX, kY, kZ };

/// What comments before the first position say.
struct Comments {
  std::optional<double> fps;
  std::optional<double> unit_m;
  std::optional<double> z_unit_m;
  std::vector<Role> roles;  ///< by column; empty: nothing says

  void read(std::string_view line);

 private:
  void read_rate(const std::string& text);
  void read_columns(const std::string& text);
};

/// The number that follows a word and a colon, equals sign or blank.
std::optional<double> number_after(const std::string& text, std::string_view word) {
  size_t at = text.find(word);
  if (at == std::string::npos) return std::nullopt;
  at = text.find_first_not_of(" \t:=", at + word.size());
  if (at == std::string::npos) return std::nullopt;
  double value = 0;
  const auto [end, error] = std::from_chars(text.data() + at, text.data() + text.size(), value);
  static_cast<void>(end);
  if (error != std::errc()) return std::nullopt;
  return value;
}

void Comments::read_rate(const std::string& text) {
  for (const char* word : {"framerate", "frame rate", "fps"})
    if (const std::optional<double> rate = number_after(text, word)) {
      fps = rate;
      return;
    }
}

/// "id frame x/m y/m z/m", "ID FR X[cm] Y[cm] Z[cm] A B ANGLE COLOR".
void Comments::read_columns(const std::string& text) {
  std::string plain = text;
  for (const auto& [from, to] : {std::pair{"[in ", "["}, {" [", "["}, {" (", "("}})
    for (size_t at = plain.find(from); at != std::string::npos; at = plain.find(from))
      plain.replace(at, std::string_view(from).size(), to);
  std::vector<Role> found;
  std::optional<double> unit, z_unit;
  for (const std::string_view word : words_of(plain)) {
    const size_t cut = word.find_first_of("/[(");
    const std::string_view name = word.substr(0, cut);
    double in_m = 0;
    if (cut != std::string_view::npos) {
      std::string_view unit_name = word.substr(cut + 1);
      unit_name = unit_name.substr(0, unit_name.find_first_of("])"));
      in_m = unit_of_length_m(unit_name);
    }
    Role role = Role::kNone;
    if (name == "id" || name == "persid" || name == "personid") role = Role::kId;
    if (name == "frame" || name == "fr") role = Role::kFrame;
    if (name == "x") role = Role::kX;
    if (name == "y") role = Role::kY;
    if (name == "z") role = Role::kZ;
    found.push_back(role);
    if (in_m > 0 && role == Role::kX) unit = in_m;
    if (in_m > 0 && role == Role::kZ) z_unit = in_m;
  }
  const auto has = [&](Role role) { return std::count(found.begin(), found.end(), role) == 1; };
  if (!has(Role::kId) || !has(Role::kFrame) || !has(Role::kX) || !has(Role::kY)) return;
  roles = std::move(found);
  if (unit) unit_m = unit;
  if (z_unit) z_unit_m = z_unit;
}

void Comments::read(std::string_view line) {
  const std::string text = lower(line.substr(1));
  read_rate(text);
  read_columns(text);
  for (const char* word : {"unit:", "units:"})
    if (const size_t at = text.find(word); at != std::string::npos)
      if (const double in_m =
              unit_of_length_m(trimmed(std::string_view(text).substr(at + std::strlen(word))));
          in_m > 0)
        unit_m = in_m;
}

class ArchiveLines final : public LineTaker {
 public:
  explicit ArchiveLines(RecordingBuilder& builder) : builder_(builder) {}

  void take(std::string_view line, int64_t number) override {
    const char* at = line.data();
    const char* const end = at + line.size();
    while (at < end && is_blank(*at)) ++at;
    if (at == end) return;
    if (*at == '#') {
      comment({at, static_cast<size_t>(end - at)}, number);
      return;
    }
    if (columns_ == 0) begin({at, static_cast<size_t>(end - at)}, number);
    position(at, end, number);
  }

 private:
  void comment(std::string_view line, int64_t number) {
    if (columns_ == 0) return comments_.read(line);
    // A second file behind the first one.
    Comments later;
    later.read(line);
    if (later.fps && comments_.fps && *later.fps != *comments_.fps)
      builder_.refuse(number, fmt::format("one frame rate, {:g}", *comments_.fps),
                      fmt::format("{:g}; split the file there", *later.fps));
    if (later.unit_m && comments_.unit_m && *later.unit_m != *comments_.unit_m)
      builder_.refuse(number, "one unit of length", "another one; split the file there");
  }

  /// The first position: what comments and options said until now must be enough.
  void begin(std::string_view line, int64_t number) {
    const RecordingOptions& options = builder_.options();
    if (options.fps) comments_.fps = options.fps;
    if (options.unit_m) comments_.unit_m = comments_.z_unit_m = options.unit_m;
    columns_ = words_of(line).size();
    roles_ = comments_.roles;
    if (roles_.empty()) roles_ = {Role::kId, Role::kFrame, Role::kX, Role::kY, Role::kZ};
    roles_.resize(columns_, Role::kNone);
    for (const Role role : {Role::kId, Role::kFrame, Role::kX, Role::kY})
      if (std::find(roles_.begin(), roles_.end(), role) == roles_.end())
        builder_.refuse(number, "id, frame, x, y and perhaps z",
                        fmt::format("{} columns: {}", columns_, in_quotes(line)));
    if (!comments_.fps || !comments_.unit_m)
      ask_for(builder_, !comments_.fps, !comments_.unit_m,
              "archive text whose comments do not say so");
    if (!(*comments_.fps > 0 && *comments_.fps <= 10'000))
      builder_.refuse(number, "a frame rate above 0 and up to 10000",
                      fmt::format("{:g}; --fps 25 overrules the file", *comments_.fps));
    unit_ = LengthUnit(*comments_.unit_m);
    z_unit_ = LengthUnit(comments_.z_unit_m.value_or(*comments_.unit_m));
    RecordingHead& head = builder_.head();
    head.clock = RecordedClock::kFrames;
    head.per_s = *comments_.fps;
  }

  void position(const char* at, const char* end, int64_t number) {
    int64_t id = 0, frame = 0;
    double x = 0, y = 0, z = std::numeric_limits<double>::quiet_NaN();
    size_t column = 0;
    while (at < end) {
      const char* stop = at;
      if (column < columns_) {
        switch (roles_[column]) {
          case Role::kId:
            stop = whole(at, end, id, "an id", number);
            break;
          case Role::kFrame:
            stop = whole(at, end, frame, "a frame", number);
            break;
          case Role::kX:
            stop = real(at, end, x, "x", number);
            break;
          case Role::kY:
            stop = real(at, end, y, "y", number);
            break;
          case Role::kZ:
            stop = real(at, end, z, "z", number);
            break;
          case Role::kNone:
            stop = word_end(at, end);
        }
      } else {
        stop = word_end(at, end);
      }
      ++column;
      at = stop;
      while (at < end && is_blank(*at)) ++at;
    }
    if (column != columns_)
      builder_.refuse(number, fmt::format("{} columns, as in the first line", columns_),
                      fmt::format("{}", column));
    if (std::isinf(z)) builder_.refuse(number, "z", "infinity");
    builder_.add(id,
                 {.instant = static_cast<double>(frame),
                  .x_m = unit_.metres(x),
                  .y_m = unit_.metres(y),
                  .z_m = static_cast<float>(z_unit_.metres(z)),
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
      builder_.refuse(number, fmt::format("{} that is a whole number", what),
                      defect_of_whole(text));
    return word;
  }

  const char* real(const char* at, const char* end, double& out, const char* what,
                   int64_t number) const {
    const auto [stop, error] = std::from_chars(at, end, out);
    if (error == std::errc() && (stop == end || is_blank(*stop))) return stop;
    const char* const word = word_end(at, end);
    const std::string_view text(at, static_cast<size_t>(word - at));
    if (!parse_number(text, out))
      builder_.refuse(number, fmt::format("{} that is a number", what), in_quotes(text));
    return word;
  }

  RecordingBuilder& builder_;
  Comments comments_;
  std::vector<Role> roles_;
  size_t columns_ = 0;
  LengthUnit unit_, z_unit_;
};

class ArchiveText final : public RecordingReader {
 public:
  std::string_view kind() const override { return "archive text"; }

  /// The first line that is no comment begins with two whole numbers and goes on with two numbers.
  bool knows(std::string_view head) const override {
    if (head.starts_with("\xEF\xBB\xBF")) head.remove_prefix(3);
    Comments comments;
    while (!head.empty()) {
      const size_t length = head.find('\n');
      const std::string_view line = trimmed(head.substr(0, length));
      head.remove_prefix(length == std::string_view::npos ? head.size() : length + 1);
      if (line.empty()) continue;
      if (!line.starts_with('#')) return is_position(line);
      comments.read(line);
    }
    return !comments.roles.empty();
  }

  void read(const RecordingSource& source, RecordingBuilder& builder) const override {
    builder.head().kind = kind();
    builder.head().tracks = TrackedPoint::kHead;
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
      if (!parse_number(words[i], value)) return false;
    return true;
  }
};

}  // namespace

const RecordingReader& archive_text_reader() {
  static const ArchiveText reader;
  return reader;
}

}  // namespace throng
