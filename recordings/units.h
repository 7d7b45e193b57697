// Units of lengths, times, angles and speeds: the table of all spellings that recordings use, and
// the frame rates that are written with them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace throng {

enum class Quantity : uint8_t { kLength, kTime, kAngle, kSpeed };

/// "length", "time", "angle", "speed".
std::string_view name_of(Quantity quantity);

struct Unit {
  std::string name;  ///< as --unit has it: "cm", "ms", "deg", "m/s"
  Quantity quantity = Quantity::kLength;
  double in_si = 1;  ///< m, s, rad or m/s of one; 0: known and not read ("px", "mile", "Mm")
};

/// The unit that a text names as a whole, in any usual spelling: "cm", "Centimetres", "km/h", "°".
/// Capitals do not matter but in "Mm" and "Ms", which are no mm and no ms. None if it is no unit.
std::optional<Unit> unit_named(std::string_view text);

/// In small letters, but for "Mm", "MS" and the like, where a capital makes another unit of them.
std::string folded(std::string_view text);
bool has_small_letter(std::string_view text);
/// A name or a comment as a whole: one that has no small letter is in small letters throughout.
std::string without_capitals_throughout(std::string_view text);

/// All words that name a unit.
std::vector<std::string_view> spelt_units();

/// Short names of the units of a quantity, but for those that are not read.
std::vector<std::string> unit_names_of(Quantity quantity);

/// Numbers of one unit in SI units: divided where the unit is a part of one, so that 79.035 cm are
/// what 0.79035 m are, to the last digit.
class UnitScale {
 public:
  explicit UnitScale(double in_si = 1)
      : factor_(in_si), divisor_(in_si < 1 ? nearest_whole(1 / in_si) : 0) {}
  double si(double value) const { return divisor_ > 0 ? value / divisor_ : value * factor_; }

 private:
  static double nearest_whole(double value);
  double factor_, divisor_;
};

/// Frames per second of a text that states a rate, or the time from one frame to the next: "25",
/// "29,97 fps", "30000/1001", "25 frames per second", "1/25 s", "40 ms". None unless the text is
/// understood to its end. A comma is a decimal point unless it could separate thousands.
std::optional<double> frame_rate_named(std::string_view text);

/// What frame_rate_named() understands, for errors.
inline constexpr const char* kFrameRateForms =
    "a frame rate as in 25, 25 fps, 29.97 Hz, 30000/1001 or 1/25 s";

}  // namespace throng
