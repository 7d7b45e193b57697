#include "analysis/measures/speed_and_spacing.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace throng {
namespace {

constexpr double kHalfWindow_s = 0.5;
/// Radius that contains all people who affect a cell or the density by the sixth nearest.
constexpr double kSearchRadius_m = 2 * VoronoiCells::kCap_m;
constexpr double kGridCell_m = 1;
/// The direction of slower people is undefined.
constexpr double kWalking_mps = 0.1;
constexpr double kSpacingReach_m = 1.2;
constexpr size_t kDensityNeighbours = 6;

double cosine(double degrees) { return std::cos(degrees * std::numbers::pi / 180); }

}  // namespace

size_t Velocities::half_window(double sample_s) {
  return static_cast<size_t>(std::max(1.0, std::round(kHalfWindow_s / sample_s)));
}

void Velocities::find(const RecentCrowd& crowd, size_t ago, double sample_s) {
  const size_t half = half_window(sample_s);
  const Moment& before = crowd.ago(ago + half);
  const Moment& after = crowd.ago(ago - half);
  const size_t people = after.present.size();
  of_mps.assign(people, Eigen::Vector2d::Zero());
  known.assign(people, 0);
  for (size_t i = 0; i < people; ++i) {
    if (!crowd.stayed(i, ago, half, half)) continue;
    known[i] = 1;
    of_mps[i] = (after.heads_m[i] - before.heads_m[i]) / (2 * static_cast<double>(half) * sample_s);
  }
}

SpeedAndSpacing::SpeedAndSpacing(const Scene& scene)
    : cells_(scene),
      grid_(scene.ground, kGridCell_m),
      speeds_mps_(kDensityBins, Histogram(0, 0.01, 500)),
      spacing_m_((kSpacingBounds_per_m2.size() + 1) * kSides, Histogram(0, 0.005, 240)) {}

void SpeedAndSpacing::take(const Moment& moment, const Velocities& velocities) {
  grid_.place(moment.heads_m, moment.present);
  for (size_t i = 0; i < moment.present.size(); ++i) {
    if (moment.present[i] == 0 || velocities.known[i] == 0) continue;
    neighbours_.clear();
    others_.clear();
    grid_.for_each_within(moment.heads_m[i], kSearchRadius_m, [&](uint32_t other, double squared) {
      if (other == i) return;
      neighbours_.emplace_back(squared, other);
      others_.push_back(moment.heads_m[other]);
    });
    const double speed_mps = velocities.of_mps[i].norm();
    if (const std::optional<VoronoiCell> cell = cells_.cell(moment.heads_m[i], others_);
        cell && cell->area_m2 > 0) {
      const double bin = 1 / cell->area_m2 / kDensityBin_per_m2;
      speeds_mps_[static_cast<size_t>(std::min(bin, kDensityBins - 1.0))].add(speed_mps);
    } else {
      ++off_the_area_;
    }
    if (speed_mps >= kWalking_mps) add_spacing(moment, i, velocities.of_mps[i]);
  }
}

void SpeedAndSpacing::add_spacing(const Moment& moment, size_t person,
                                  const Eigen::Vector2d& velocity_mps) {
  double density_per_m2 = 0;  // fewer neighbours: the lowest level
  if (neighbours_.size() >= kDensityNeighbours) {
    std::nth_element(neighbours_.begin(), neighbours_.begin() + kDensityNeighbours - 1,
                     neighbours_.end());
    density_per_m2 =
        kDensityNeighbours / (std::numbers::pi * neighbours_[kDensityNeighbours - 1].first);
  }
  const auto level = static_cast<size_t>(
      std::upper_bound(kSpacingBounds_per_m2.begin(), kSpacingBounds_per_m2.end(), density_per_m2) -
      kSpacingBounds_per_m2.begin());
  static const double ahead_of = cosine(30), beside_of = cosine(60);
  const Eigen::Vector2d ahead = velocity_mps.normalized();
  for (const auto& [squared, other] : neighbours_) {
    const double distance_m = std::sqrt(squared);
    if (distance_m > kSpacingReach_m || distance_m == 0) continue;
    const double along = ahead.dot(moment.heads_m[other] - moment.heads_m[person]) / distance_m;
    if (along >= ahead_of) spacing_m_[level * kSides + kAhead].add(distance_m);
    if (std::abs(along) <= beside_of) spacing_m_[level * kSides + kBeside].add(distance_m);
  }
}

MeasureTable SpeedAndSpacing::speed_table() const {
  MeasureTable table{"speed_density",
                     "Speed against density",
                     "density",
                     "people per m2",
                     "Density: 1 over the area of the head's Voronoi cell, cut at walls and "
                     "limited "
                     "to 2 m. Speed: displacement of the head over 1 s, half of it before and "
                     "half after.",
                     {},
                     {}};
  for (size_t i = 0; i < kDensityBins; ++i) {
    const Histogram& speeds = speeds_mps_[i];
    if (speeds.count() < kMinValues) continue;
    const double from = kDensityBin_per_m2 * static_cast<double>(i);
    const std::optional<double> to =
        i + 1 < kDensityBins ? std::optional(from + kDensityBin_per_m2) : std::nullopt;
    table.rows.push_back(ranged_row(from, to, "", "mean", "m/s", speeds.mean()));
    table.rows.push_back(ranged_row(from, to, "", "10 %", "m/s", speeds.quantile(0.1)));
    table.rows.push_back(ranged_row(from, to, "", "90 %", "m/s", speeds.quantile(0.9)));
  }
  return table;
}

std::vector<SpeedAndSpacing::Spacing> SpeedAndSpacing::spacings() const {
  std::vector<Spacing> out;
  for (size_t level = 0; level <= kSpacingBounds_per_m2.size(); ++level)
    for (const Side side : {kAhead, kBeside}) {
      const Histogram& distances_m = spacing_m_[level * kSides + side];
      Spacing& cell = out.emplace_back();
      cell.at = range_text(level == 0 ? 0 : kSpacingBounds_per_m2[level - 1],
                           level < kSpacingBounds_per_m2.size()
                               ? std::optional(kSpacingBounds_per_m2[level])
                               : std::nullopt);
      cell.is_ahead = side == kAhead;
      cell.pairs = distances_m.count();
      for (size_t i = 0; i < kQuantiles.size(); ++i)
        cell.quantiles_m[i] = distances_m.quantile(kQuantiles[i]);
    }
  return out;
}

MeasureTable SpeedAndSpacing::spacing_table() const {
  MeasureTable table{"spacing",
                     "Spacing ahead and beside",
                     "density",
                     "people per m2",
                     "Distances from the head of a walking person (0.1 m/s or more) to others "
                     "within 1.2 m: ahead, within 30 degrees of the walking direction; beside, 60 "
                     "to 120 degrees from it. Density by the sixth nearest.",
                     {},
                     {}};
  for (size_t level = 0; level <= kSpacingBounds_per_m2.size(); ++level)
    for (const Side side : {kAhead, kBeside}) {
      const Histogram& spacing = spacing_m_[level * kSides + side];
      if (spacing.count() < kMinValues) continue;
      const double from = level == 0 ? 0 : kSpacingBounds_per_m2[level - 1];
      const std::optional<double> to = level < kSpacingBounds_per_m2.size()
                                           ? std::optional(kSpacingBounds_per_m2[level])
                                           : std::nullopt;
      for (const auto& [what, share] : {std::pair("1 %", 0.01), {"5 %", 0.05}, {"25 %", 0.25}})
        table.rows.push_back(ranged_row(from, to, side == kAhead ? "ahead" : "beside", what, "m",
                                        spacing.quantile(share)));
    }
  return table;
}

}  // namespace throng
