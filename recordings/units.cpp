#include "recordings/units.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <iterator>
#include <numbers>
#include <utility>

#include "recordings/readers/text_lines.h"

namespace throng {
namespace {

struct UnitRow {
  Quantity quantity;
  double in_si;
  /// In the form of folded(), short name first. Includes Latin-1 and both micro signs of Unicode.
  std::vector<std::string_view> spellings;
};

const std::vector<UnitRow>& unit_table() {
  static const std::vector<UnitRow> table = {
      {Quantity::kLength, 1, {"m", "metre", "metres", "meter", "meters"}},
      {Quantity::kLength,
       0.01,
       {"cm", "centimetre", "centimetres", "centimeter", "centimeters", "cms"}},
      {Quantity::kLength,
       0.001,
       {"mm", "millimetre", "millimetres", "millimeter", "millimeters", "mms"}},
      {Quantity::kLength, 1000, {"km", "kilometre", "kilometres", "kilometer", "kilometers"}},
      {Quantity::kLength, 0.3048, {"ft", "foot", "feet"}},
      {Quantity::kLength, 0.0254, {"in", "inch", "inches"}},
      {Quantity::kLength, 0, {"px", "pixel", "pixels", "pix", "voxel", "voxels"}},
      {Quantity::kLength, 0, {"Mm", "MM", "Mms", "MMs", "MMS"}},
      {Quantity::kLength, 0, {"dm",      "decimetre", "decimetres", "decimeter", "decimeters",
                              "um",      "\xC2\xB5m", "\xCE\xBCm",  "\xB5m",     "micron",
                              "microns", "nm",        "nmi",        "mi",        "mile",
                              "miles",   "yd",        "yds",        "yard",      "yards",
                              "furlong", "furlongs",  "fathom",     "fathoms"}},
      {Quantity::kTime, 1, {"s", "sec", "secs", "second", "seconds"}},
      {Quantity::kTime,
       1e-3,
       {"ms", "msec", "msecs", "milli", "millis", "millisec", "millisecs", "millisecond",
        "milliseconds"}},
      {Quantity::kTime,
       1e-6,
       {"us", "usec", "usecs", "micros", "microsec", "microsecs", "microsecond", "microseconds",
        "\xC2\xB5s", "\xCE\xBCs", "\xB5s", "\xC2\xB5sec", "\xCE\xBCsec"}},
      {Quantity::kTime,
       1e-9,
       {"ns", "nsec", "nsecs", "nanos", "nanosec", "nanosecs", "nanosecond", "nanoseconds"}},
      {Quantity::kTime, 0, {"Ms", "MS", "Msec", "MSEC", "Msecs", "MSECS"}},
      {Quantity::kTime, 0, {"tick", "ticks", "jiffy", "jiffies", "fortnight", "fortnights"}},
      {Quantity::kTime, 60, {"min", "mins", "minute", "minutes"}},
      {Quantity::kTime, 3600, {"h", "hr", "hrs", "hour", "hours"}},
      {Quantity::kAngle, 1, {"rad", "rads", "radian", "radians"}},
      {Quantity::kAngle,
       std::numbers::pi / 180,
       {"deg", "degs", "degree", "degrees", "\xC2\xB0", "\xC2\xBA", "\xB0"}},
      {Quantity::kAngle, 0, {"gon", "gons", "grad", "grads", "gradian", "gradians", "mrad"}},
      {Quantity::kSpeed, 1, {"m/s", "mps"}},
      {Quantity::kSpeed, 1 / 3.6, {"km/h", "kmh", "kph", "kmph"}},
      {Quantity::kSpeed, 0.3048, {"ft/s"}},
      {Quantity::kSpeed, 0.44704, {"mph", "mile/h", "miles/h"}}};
  return table;
}

std::optional<Unit> simple_unit(std::string_view text) {
  for (const UnitRow& row : unit_table())
    if (std::find(row.spellings.begin(), row.spellings.end(), text) != row.spellings.end())
      return Unit{std::string(row.spellings.front()), row.quantity, row.in_si};
  return std::nullopt;
}

/// "cm/s", "metres per second", "m s-1".
std::optional<Unit> speed_unit(std::string_view text) {
  for (const std::string_view sign : {" per ", "/"}) {
    const size_t cut = text.find(sign);
    if (cut == std::string_view::npos) continue;
    const auto length = simple_unit(trimmed(text.substr(0, cut)));
    const auto time = simple_unit(trimmed(text.substr(cut + sign.size())));
    if (!length || !time || length->quantity != Quantity::kLength || length->in_si == 0 ||
        time->quantity != Quantity::kTime || time->in_si == 0)
      return std::nullopt;
    return Unit{length->name + "/" + time->name, Quantity::kSpeed, length->in_si / time->in_si};
  }
  for (const std::string_view power : {"^-1", "-1", "\xE2\x81\xBB\xC2\xB9"}) {
    if (!text.ends_with(power)) continue;
    const std::string_view rest = text.substr(0, text.size() - power.size());
    const size_t cut = rest.find_first_of(" *.");
    if (cut == std::string_view::npos) return std::nullopt;
    return speed_unit(fmt::format("{}/{}", rest.substr(0, cut), trimmed(rest.substr(cut + 1))));
  }
  return std::nullopt;
}

class Remainder {
 public:
  explicit Remainder(std::string_view text) : text_(trimmed(text)) {}

  bool is_empty() const { return text_.empty(); }
  std::string_view text() const { return text_; }
  bool take(std::string_view piece) {
    if (!text_.starts_with(piece)) return false;
    text_ = trimmed(text_.substr(piece.size()));
    return true;
  }
  bool take_word(std::initializer_list<std::string_view> words) {
    const size_t length = static_cast<size_t>(
        std::find_if(text_.begin(), text_.end(), [](char c) { return c < 'a' || c > 'z'; }) -
        text_.begin());
    const std::string_view word = text_.substr(0, length);
    return std::find(words.begin(), words.end(), word) != words.end() && take(word);
  }
  std::optional<double> take_number();

 private:
  /// Takes digits with a decimal comma: "29,97", "23,976", but not "1,000".
  bool take_decimals_behind_comma(double& value, std::string_view whole);

  std::string_view text_;
};

bool Remainder::take_decimals_behind_comma(double& value, std::string_view whole) {
  size_t digits = 1;
  while (digits < text_.size() && text_[digits] >= '0' && text_[digits] <= '9') ++digits;
  const std::string_view decimals = text_.substr(1, digits - 1);
  // No camera records 23 976 frames per second, but some record 1 000.
  constexpr double kMaxThousands = 10;
  const bool could_be_thousands =
      decimals.size() == 3 && !whole.starts_with('0') && value <= kMaxThousands;
  if (decimals.empty() || could_be_thousands) return false;
  if (!parse_number(fmt::format("{}.{}", whole, decimals), value)) return false;
  text_ = trimmed(text_.substr(digits));
  return true;
}

std::optional<double> Remainder::take_number() {
  double value = 0;
  const std::string_view whole_text = text_;
  const size_t begin = text_.starts_with('-') || text_.starts_with('+') ? 1 : 0;
  // "nan" and "inf" are no numbers of frames.
  if (begin >= text_.size() ||
      !((text_[begin] >= '0' && text_[begin] <= '9') || text_[begin] == '.'))
    return std::nullopt;
  if (text_.starts_with('+')) text_.remove_prefix(1);
  const auto [end, error] = std::from_chars(text_.data(), text_.data() + text_.size(), value);
  if (error != std::errc()) return std::nullopt;
  const auto length = static_cast<size_t>(end - text_.data());
  const std::string_view number = text_.substr(0, length);
  text_.remove_prefix(length);
  if (text_.starts_with(',')) {
    const bool is_whole = number.find_first_not_of("-0123456789") == std::string_view::npos;
    if (!is_whole || !take_decimals_behind_comma(value, number)) {
      text_ = whole_text;
      return std::nullopt;
    }
  } else {
    text_ = trimmed(text_);
  }
  return value;
}

/// Rate of one of "fps", "Hz", "1/s", "frames per second", "per minute", in 1/s.
std::optional<double> per_second(std::string_view text) {
  Remainder rest(text);
  if (rest.take_word({"fps", "hz", "hertz"}))
    return rest.is_empty() ? std::optional(1.0) : std::nullopt;
  if (rest.take_word({"khz", "kilohertz"}))
    return rest.is_empty() ? std::optional(1e3) : std::nullopt;
  for (const std::string_view inverse : {"s^-1", "s-1", "s\xE2\x81\xBB\xC2\xB9", "1/s", "1/sec"})
    if (rest.text() == inverse) return 1;
  rest.take_word({"frames", "frame", "f", "images", "image", "pictures", "picture", "samples",
                  "sample", "positions", "position"});
  if (!rest.take_word({"per", "a"}) && !rest.take("/")) return std::nullopt;
  rest.take("1 ");
  const std::optional<Unit> unit = unit_named(rest.text());
  if (!unit || unit->quantity != Quantity::kTime || unit->in_si == 0) return std::nullopt;
  return 1 / unit->in_si;
}

std::string_view without_brackets(std::string_view text) {
  if (text.size() >= 2 &&
      ((text.front() == '[' && text.back() == ']') || (text.front() == '(' && text.back() == ')')))
    return trimmed(text.substr(1, text.size() - 2));
  return text;
}

}  // namespace

std::string_view name_of(Quantity quantity) {
  constexpr std::string_view kNames[] = {"length", "time", "angle", "speed"};
  return kNames[static_cast<size_t>(quantity)];
}

std::string folded(std::string_view text) {
  constexpr std::string_view kCaseMatters[] = {"mm", "mms", "ms", "msec", "msecs"};
  std::string out = lower(text);
  const auto is_letter = [&](size_t at) { return out[at] >= 'a' && out[at] <= 'z'; };
  for (size_t begin = 0, end = 0; begin < out.size(); begin = end + 1) {
    for (end = begin; end < out.size() && is_letter(end);) ++end;
    const std::string_view word = std::string_view(out).substr(begin, end - begin);
    if (end > begin && text[begin] == 'M' &&
        std::find(std::begin(kCaseMatters), std::end(kCaseMatters), word) != std::end(kCaseMatters))
      out.replace(begin, end - begin, text.substr(begin, end - begin));
  }
  return out;
}

bool has_small_letter(std::string_view text) {
  return std::any_of(text.begin(), text.end(), [](char c) { return c >= 'a' && c <= 'z'; });
}

std::string without_capitals_throughout(std::string_view text) {
  return has_small_letter(text) ? std::string(text) : lower(text);
}

std::optional<Unit> unit_named(std::string_view text) {
  std::string name = folded(trimmed(text));
  if (name.size() > 1 && name.ends_with('.')) name.pop_back();
  if (std::optional<Unit> unit = simple_unit(name)) return unit;
  return speed_unit(name);
}

std::vector<std::string_view> spelt_units() {
  std::vector<std::string_view> out;
  for (const UnitRow& row : unit_table())
    out.insert(out.end(), row.spellings.begin(), row.spellings.end());
  return out;
}

std::vector<std::string> unit_names_of(Quantity quantity) {
  std::vector<std::string> names;
  for (const UnitRow& row : unit_table())
    if (row.quantity == quantity && row.in_si > 0) names.emplace_back(row.spellings.front());
  return names;
}

double UnitScale::nearest_whole(double value) {
  const double whole = std::round(value);
  return std::abs(whole - value) < 1e-9 * value ? whole : 0;
}

std::optional<double> frame_rate_named(std::string_view text) {
  std::string lowered = folded(trimmed(text));
  while (!lowered.empty() && (lowered.back() == '.' || lowered.back() == ';')) lowered.pop_back();
  Remainder rest(lowered);
  std::optional<double> value = rest.take_number();
  if (!value) return std::nullopt;
  bool is_ratio = false;
  // "1/25", but not "25 / s".
  Remainder behind = rest;
  if (behind.take("/"))
    if (const std::optional<double> divisor = behind.take_number(); divisor && *divisor > 0) {
      // "25 1/s" has no divisor; "1/25" alone may be a rate or an interval.
      is_ratio = true;
      value = *value / *divisor;
      rest = behind;
    }
  const std::string_view unit_text = without_brackets(rest.text());
  if (unit_text.empty()) return is_ratio && *value < 1 ? std::nullopt : value;
  if (const std::optional<double> rate = per_second(unit_text)) return *value * *rate;
  const std::optional<Unit> unit = unit_named(unit_text);
  if (!unit || unit->quantity != Quantity::kTime) return std::nullopt;
  // An interval between frames; intervals above 1 s are misunderstandings.
  const double period_s = *value * unit->in_si;
  if (!(period_s > 0 && period_s <= 1)) return std::nullopt;
  // 1/25 s is exactly 25 per second.
  const double rate = 1 / period_s, whole = std::round(rate);
  return std::abs(rate - whole) < 1e-9 * rate ? whole : rate;
}

}  // namespace throng
