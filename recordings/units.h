// Units of lengths, times, angles and speeds: all spellings that recordings use, and the frame
// rates written with them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace throng {

enum class Quantity : uint8_t { kLength, kTime, kAngle, kSpeed };

std::string_view name_of(Quantity quantity);

struct Unit {
  std::string name;  ///< value of --unit: "cm", "ms", "deg", "m/s"
  Quantity quantity = Quantity::kLength;
  double in_si = 1;  ///< value in m, s, rad or m/s; 0: known but not supported ("px", "mile", "Mm")
};

/// Unit named by a whole text, in any common spelling: "cm", "Centimetres", "km/h", "°". Case is
/// ignored except in "Mm" and "Ms", which are not mm and ms. Empty for other texts.
std::optional<Unit> unit_named(std::string_view text);

/// Lower case, except for "Mm", "MS" and similar, where a capital changes the unit.
std::string folded(std::string_view text);
bool has_small_letter(std::string_view text);
/// Converts a name or comment without lower-case letters to lower case.
std::string without_capitals_throughout(std::string_view text);

std::vector<std::string_view> spelt_units();

/// Short names of the supported units of a quantity.
std::vector<std::string> unit_names_of(Quantity quantity);

/// UnitScale converts numbers to SI units. It divides by the inverse for units below 1, to make
/// 79.035 cm bitwise equal to 0.79035 m.
class UnitScale {
 public:
  explicit UnitScale(double in_si = 1)
      : factor_(in_si), divisor_(in_si < 1 ? nearest_whole(1 / in_si) : 0) {}
  double si(double value) const { return divisor_ > 0 ? value / divisor_ : value * factor_; }

 private:
  static double nearest_whole(double value);
  double factor_, divisor_;
};

/// Frame rate of a text that states a rate or a frame interval: "25", "29,97 fps", "30000/1001",
/// "25 frames per second", "1/25 s", "40 ms". Empty unless the whole text is understood. A comma is
/// a decimal point unless it could separate thousands.
std::optional<double> frame_rate_named(std::string_view text);

/// Forms that frame_rate_named() understands, for errors.
inline constexpr const char* kFrameRateForms =
    "a frame rate as in 25, 25 fps, 29.97 Hz, 30000/1001 or 1/25 s";

}  // namespace throng
