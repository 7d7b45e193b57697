#include "recordings/recording_summary.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>

namespace throng {
namespace {

constexpr size_t kMaxInstants = 300, kMinInstants = 20;
constexpr size_t kMaxPositions = 2'000'000;
/// Longer gaps are absences.
constexpr double kMaxGap_s = 2;
constexpr double kSpeedWindow_s = 1;

/// Position between samples; empty before the first, after the last and during absences.
std::optional<Eigen::Vector2d> place_at(std::span<const Sample> track, double time_s) {
  if (time_s < track.front().time_s || time_s > track.back().time_s) return std::nullopt;
  const auto after = std::lower_bound(
      track.begin(), track.end(), time_s,
      [](const Sample& sample, double bound_s) { return sample.time_s < bound_s; });
  if (after->time_s == time_s || after == track.begin()) return after->position_m;
  const Sample& before = *(after - 1);
  const double gap_s = after->time_s - before.time_s;
  if (gap_s > kMaxGap_s) return std::nullopt;
  const double t = (time_s - before.time_s) / gap_s;
  return before.position_m + t * (after->position_m - before.position_m);
}

class DensityGrid {
 public:
  explicit DensityGrid(const Rectangle& bounds)
      : origin_(bounds.min_m),
        columns_(static_cast<int64_t>(bounds.size_m().x() / kDensityRadius_m) + 3) {}

  void place(std::span<const Eigen::Vector2f> people) {
    people_.clear();
    for (const Eigen::Vector2f& p : people) people_.push_back({cell_of(p), p});
    std::sort(people_.begin(), people_.end(),
              [](const Entry& a, const Entry& b) { return a.cell < b.cell; });
  }
  int64_t near(const Eigen::Vector2f& point) const {
    int64_t count = 0;
    const int64_t middle = cell_of(point);
    for (const int64_t row : {middle - columns_, middle, middle + columns_}) {
      auto it = std::lower_bound(people_.begin(), people_.end(), row - 1,
                                 [](const Entry& p, int64_t cell) { return p.cell < cell; });
      for (; it != people_.end() && it->cell <= row + 1; ++it)
        count += static_cast<double>((it->place - point).squaredNorm()) <=
                 kDensityRadius_m * kDensityRadius_m;
    }
    return count;
  }

 private:
  struct Entry {
    int64_t cell;
    Eigen::Vector2f place;
  };
  int64_t cell_of(const Eigen::Vector2f& p) const {
    const Eigen::Vector2d at = (p.cast<double>() - origin_) / kDensityRadius_m;
    return static_cast<int64_t>(std::floor(at.y()) + 1) * columns_ +
           static_cast<int64_t>(std::floor(at.x()) + 1);
  }

  Eigen::Vector2d origin_;
  int64_t columns_;
  std::vector<Entry> people_;
};

std::vector<double> instants_of(const Recording& recording) {
  const size_t max =
      std::clamp(kMaxPositions / recording.people().size(), kMinInstants, kMaxInstants);
  const double duration_s = recording.facts().duration_s;
  const double fps = recording.facts().fps;
  const auto count = std::min(max, static_cast<size_t>(duration_s) + 1);
  std::vector<double> out;
  for (size_t i = 0; i < count; ++i) {
    // At recorded frames if there are any, each in the middle of an equal time span.
    const double time_s = duration_s * (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    out.push_back(fps > 0 ? std::floor(time_s * fps) / fps : time_s);
  }
  return out;
}

}  // namespace

Percentiles percentiles_of(std::vector<float>& values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const auto at = [&](double part) {
    const double last = static_cast<double>(values.size() - 1);
    return static_cast<double>(values[static_cast<size_t>(std::lround(part * last))]);
  };
  return {at(0.05), at(0.5), at(0.95)};
}

RecordingSummary summary_of(const Recording& recording) {
  RecordingSummary out;
  const std::vector<double> instants = instants_of(recording);
  std::vector<std::vector<Eigen::Vector2f>> places(instants.size());
  std::vector<float> speeds, heights, densities;
  std::vector<Sample> track;
  for (size_t person = 0; person < recording.people().size(); ++person) {
    if (const auto height = recording.people()[person].height_m)
      heights.push_back(static_cast<float>(*height));
    recording.read(person, track);
    for (size_t i = 0; i < instants.size(); ++i) {
      const auto place = place_at(track, instants[i]);
      if (!place) continue;
      places[i].push_back(place->cast<float>());
      const auto before = place_at(track, instants[i] - 0.5 * kSpeedWindow_s);
      const auto after = place_at(track, instants[i] + 0.5 * kSpeedWindow_s);
      if (before && after)
        speeds.push_back(static_cast<float>((*after - *before).norm() / kSpeedWindow_s));
    }
  }
  DensityGrid grid(recording.facts().bounds);
  constexpr double kArea_m2 = std::numbers::pi * kDensityRadius_m * kDensityRadius_m;
  for (size_t i = 0; i < instants.size(); ++i) {
    const auto count = static_cast<int64_t>(places[i].size());
    out.mean_people += static_cast<double>(count) / static_cast<double>(instants.size());
    if (count > out.max_people) {
      out.max_people = count;
      out.max_people_at_s = instants[i];
    }
    grid.place(places[i]);
    for (const Eigen::Vector2f& place : places[i])
      densities.push_back(static_cast<float>(static_cast<double>(grid.near(place)) / kArea_m2));
  }
  out.speed_mps = percentiles_of(speeds);
  out.density_per_m2 = percentiles_of(densities);
  out.heights = static_cast<int64_t>(heights.size());
  out.height_m = percentiles_of(heights);
  return out;
}

}  // namespace throng
