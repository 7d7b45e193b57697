#include "recordings/recorded_samples.h"

#include <cmath>

namespace throng {
namespace {

/// Simulators print the place between two steps twice, with different last digits.
constexpr double kSamePlace_m = 1e-6;

}  // namespace

double SampleMapping::time_s(double instant) const {
  const double time_s = (instant - origin) / per_s;
  return grid_per_s > 0 ? std::round(time_s * grid_per_s) / grid_per_s : time_s;
}

Duplicates RecordedSamples::read_stored(size_t person, std::vector<Sample>& out) const {
  std::vector<StoredSample> stored;
  store_->read(person, stored);
  out.clear();
  out.reserve(stored.size());
  Duplicates duplicates;
  for (const StoredSample& s : stored) {
    if (s.instant < mapping_.first || s.instant > mapping_.last) continue;
    const Sample sample{.time_s = mapping_.time_s(s.instant),
                        .position_m = Eigen::Vector2d(s.x_m, s.y_m) - mapping_.shift_m,
                        .z_m = s.z_m,
                        .heading_rad = s.heading_rad};
    if (out.empty() || sample.time_s - out.back().time_s > mapping_.same_within_s) {
      out.push_back(sample);
      continue;
    }
    const bool is_said_twice =
        mapping_.same_within_s > 0 &&
        (sample.position_m - out.back().position_m).cwiseAbs().maxCoeff() < kSamePlace_m;
    if (is_said_twice) continue;
    if (duplicates.count++ == 0) duplicates.first_s = sample.time_s;
  }
  return duplicates;
}

}  // namespace throng
