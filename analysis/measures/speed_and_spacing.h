// Speed against density, and how much room people keep ahead of them and beside.
// One rule: everything is asked of heads, as cameras see them, and of displacements over a second,
// so that sway is no speed; recordings and simulations alike.
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

/// How fast everybody is at a moment, over about a second around it.
struct Velocities {
  /// Moments before and after; a second in all.
  static size_t half_window(double sample_s);

  std::vector<Eigen::Vector2d> of_mps;
  std::vector<uint8_t> known;  ///< there for the whole window

  void find(const RecentCrowd& crowd, size_t ago, double sample_s);
};

class SpeedAndSpacing {
 public:
  explicit SpeedAndSpacing(const Scene& scene);

  /// The people of one moment.
  void take(const Moment& moment, const Velocities& velocities);

  /// How near others are ahead or beside, at a level of density.
  struct Spacing {
    std::string at;  ///< "1 to 2"
    bool is_ahead = false;
    uint64_t pairs = 0;
    std::array<double, 3> quantiles_m{};  ///< kQuantiles
  };
  static constexpr std::array<double, 3> kQuantiles = {0.01, 0.05, 0.25};
  /// All cells, those without a pair included.
  std::vector<Spacing> spacings() const;

  MeasureTable speed_table() const;
  MeasureTable spacing_table() const;
  /// Person-instants whose head was in an obstacle or off the ground: they have no cell.
  uint64_t off_the_area() const { return off_the_area_; }

  static constexpr double kDensityBin_per_m2 = 0.25;
  static constexpr size_t kDensityBins = 48;
  /// Fewer say nothing; rows of less are left out.
  static constexpr uint64_t kMinValues = 15;

 private:
  enum Side { kAhead, kBeside, kSides };
  static constexpr std::array<double, 4> kSpacingBounds_per_m2 = {1, 2, 3, 5};

  void add_spacing(const Moment& moment, size_t person, const Eigen::Vector2d& velocity_mps);

  VoronoiCells cells_;
  PointGrid grid_;
  std::vector<Histogram> speeds_mps_;  ///< by bin of density
  std::vector<Histogram> spacing_m_;   ///< by level of density and side
  uint64_t off_the_area_ = 0;
  std::vector<Eigen::Vector2d> others_;
  std::vector<std::pair<double, uint32_t>> neighbours_;  ///< squared distance and index
};

}  // namespace throng
