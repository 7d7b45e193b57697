// PublishedVolume holds the legible numbers that the paper prints.
// A digit that was lost in print stays a question mark.
//
// Suaib, Bade, Mohamad: "Hybrid Collision Culling by Bounding Volumes Manipulation in Massive Rigid
// Body Simulation", TELKOMNIKA 11(6), 2013.
#pragma once

#include <array>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

namespace throng::paper {

/// Table 3 (500 frames), milliseconds, and Table 2 (accumulated collisions).
struct PublishedVolume {
  std::string_view volume;  ///< Throng's name, without k
  uint64_t tests;
  double test_ms;
  uint64_t updates;
  double update_ms;
  double construction_ms;
  double total_ms;
  std::array<std::string_view, 5> collisions;  ///< after 100, 200, ... 500 frames

  /// Returns N_u C_u + N_v C_v + C_o of the printed numbers.
  double computed_ms() const {
    return static_cast<double>(updates) * update_ms + static_cast<double>(tests) * test_ms +
           construction_ms;
  }
  /// Returns the relative deviation of the printed total from computed_ms().
  double error() const {
    const double difference = computed_ms() - total_ms;
    return (difference < 0 ? -difference : difference) / total_ms;
  }
};

inline constexpr std::array<PublishedVolume, 5> kPublished = {{
    {"sphere",
     52395,
     0.00024,
     104790,
     0.00012,
     135.0783,
     160.2126,
     {"36?", "57?", "872", "109?", "144?"}},
    {"aabb",
     52395,
     0.00024,
     104790,
     0.049377,
     90.63781,
     5277.364,
     {"15?", "25?", "387", "497", "625"}},
    {"obb",
     52395,
     0.100106,
     104790,
     0.050053,
     367.6315,
     10857.72,
     {"82", "13?", "207", "308", "395"}},
    {"kdop",
     52395,
     0.000249,
     104790,
     0.000124,
     574.2866,
     600.3288,
     {"71", "?", "165", "230", "316"}},
    {"ordop",
     52395,
     0.001567,
     104790,
     0.000784,
     369.4002,
     533.6356,
     {"59", "99", "140", "202", "267"}},
}};

/// Returns the paper's row for a volume of Throng ("kdop26_refit"); nullptr for the exact test.
inline const PublishedVolume* published_for(std::string_view volume) {
  for (const PublishedVolume& row : kPublished)
    if (volume.starts_with(row.volume)) return &row;
  return nullptr;
}

/// Returns a legible number, or the mean of the possible values if its last digit is lost; negative
/// if nothing is legible.
inline double legible(std::string_view printed) {
  if (printed.empty() || printed.front() == '?') return -1;
  const bool lost = printed.back() == '?';
  const std::string digits(printed.substr(0, printed.size() - (lost ? 1 : 0)));
  const double value = std::strtod(digits.c_str(), nullptr);
  return lost ? 10 * value + 4.5 : value;
}

}  // namespace throng::paper
