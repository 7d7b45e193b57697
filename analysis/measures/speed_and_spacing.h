// SpeedAndSpacing measures speed against density and the distances to people ahead and to the side.
// Invariant: positions are those of heads, as cameras see them; speeds are displacements over 1 s,
// to exclude sway. Recordings and simulations are measured alike.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "analysis/contacts/local_density.h"
#include "analysis/measures/measure_table.h"
#include "analysis/measures/recent_crowd.h"
#include "analysis/measures/voronoi.h"

namespace throng {

/// Velocities of all people at a moment, over about 1 s around it.
struct Velocities {
  /// Number of moments before and after; 1 s in total.
  static size_t half_window(double sample_s);

  std::vector<Eigen::Vector2d> of_mps;
  std::vector<uint8_t> known;  ///< 1: present during the whole window

  void find(const RecentCrowd& crowd, size_t ago, double sample_s);
};

class SpeedAndSpacing {
 public:
  explicit SpeedAndSpacing(const Scene& scene);

  void take(const Moment& moment, const Velocities& velocities);

  /// Distances to people ahead or to the side at a level of density.
  struct Spacing {
    std::string at;  ///< "1 to 2"
    bool is_ahead = false;
    uint64_t pairs = 0;
    std::array<double, 3> quantiles_m{};  ///< at kQuantiles
  };
  static constexpr std::array<double, 3> kQuantiles = {0.01, 0.05, 0.25};
  /// All cells, including those without a pair.
  std::vector<Spacing> spacings() const;

  MeasureTable speed_table() const;
  MeasureTable spacing_table() const;
  /// Number of samples with the head in an obstacle or off the ground; they have no cell.
  uint64_t off_the_area() const { return off_the_area_; }

  static constexpr double kDensityBin_per_m2 = 0.25;
  static constexpr size_t kDensityBins = 48;
  /// Rows with fewer values are omitted.
  static constexpr uint64_t kMinValues = 15;

 private:
  enum Side { kAhead, kBeside, kSides };
  static constexpr std::array<double, 4> kSpacingBounds_per_m2 = {1, 2, 3, 5};

  void add_spacing(const Moment& moment, size_t person, const Eigen::Vector2d& velocity_mps);

  VoronoiCells cells_;
  PointGrid grid_;
  std::vector<Histogram> speeds_mps_;  ///< indexed by density bin
  std::vector<Histogram> spacing_m_;   ///< indexed by density level and side
  uint64_t off_the_area_ = 0;
  std::vector<Eigen::Vector2d> others_;
  std::vector<std::pair<double, uint32_t>> neighbours_;  ///< squared distance and index
};

}  // namespace throng
