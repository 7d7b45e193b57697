// How dense it is around somebody: people in a circle over the part of it that is seen from its
// middle.
// One rule: a wall takes room away, and so does what is behind it, so that neither a person beside
// one nor a file in a narrow corridor counts as half alone.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "crowd/navigation/walkable.h"
#include "scenes/file/scene.h"

namespace throng {

class LocalDensity {
 public:
  /// The circle holds 12.6 m2, so that one person more or less is 0.08 per m2.
  static constexpr double kRadius_m = 2;

  explicit LocalDensity(const Scene& scene);

  /// Takes a frame's people, those with present[id] != 0; empty: all. The spans must outlive the
  /// calls of around().
  void place(std::span<const Eigen::Vector2d> positions_m, std::span<const uint8_t> present);
  /// People per m2 within kRadius_m of the point, somebody there included, and nobody behind a
  /// wall.
  double around(const Eigen::Vector2d& point) const;

 private:
  int cell_of(double offset_m, int cells) const;
  Eigen::Vector2d beside_walls(Eigen::Vector2d point) const;
  int people_near(const Eigen::Vector2d& point, bool sees_all) const;

  Walkable walkable_;
  Rectangle ground_;
  double cell_m_;
  int columns_;
  int rows_;
  std::span<const Eigen::Vector2d> positions_m_;
  std::vector<uint32_t> starts_;  ///< cells + 1 entries into ids_
  std::vector<uint32_t> ids_;
  std::vector<uint32_t> next_;
};

/// Levels of density after Fruin (1971) and Helbing et al.: above bounds[i] people per m2 begins
/// level i + 1.
struct DensityLevels {
  static constexpr std::array<double, 5> kBounds = {0.43, 2.0, 3.57, 5.55, 7.1};
  static constexpr std::array<const char*, 6> kNames = {"free walking",     "among others",
                                                        "reduced speed",    "involuntary contact",
                                                        "dangerous forces", "critical"};
  static constexpr size_t kCount = kNames.size();
  static size_t level_of(double density_per_m2);
};

}  // namespace throng
