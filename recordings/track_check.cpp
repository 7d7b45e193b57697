#include "recordings/track_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "recordings/walkable_wkt.h"

namespace throng {
namespace {

/// Sprinters reach it; nobody in a crowd does.
constexpr double kFastest_mps = 12;
/// A track that was continued with somebody else's head.
constexpr double kJump_m = 3;
/// Somebody out of sight for longer has left and come back.
constexpr double kAway_s = 1;
/// Of the usual interval: what is longer lacks a sample.
constexpr double kLacking = 1.5;
/// Between footsteps people stand where they are for as long as they like.
constexpr double kMoved_m = 0.01;

}  // namespace

double TrackCheck::usual_interval_s(std::span<const Sample> samples) {
  gaps_s_.clear();
  for (size_t i = 1; i < samples.size(); ++i)
    gaps_s_.push_back(samples[i].time_s - samples[i - 1].time_s);
  const auto [least, most] = std::minmax_element(gaps_s_.begin(), gaps_s_.end());
  if (*most <= kLacking * *least) return *most;
  const auto middle = gaps_s_.begin() + static_cast<ptrdiff_t>((gaps_s_.size() - 1) / 2);
  std::nth_element(gaps_s_.begin(), middle, gaps_s_.end());
  return *middle;
}

void TrackCheck::step(int64_t id, const Sample& from, const Sample& to, double usual_s) {
  const double gap_s = to.time_s - from.time_s;
  const double way_m = (to.position_m - from.position_m).norm();
  const bool lacks_some = gap_s > kLacking * usual_s;
  const bool may_stand = fps_ == 0 && way_m < kMoved_m;
  if (lacks_some && gap_s > kAway_s && !may_stand) {
    if (is_first(kReturn))
      counts_[kReturn].first =
          fmt::format("id {} at {}, {:.4g} s and {:.3g} m after its last position", id,
                      name_(to.time_s), gap_s, way_m);
    return;
  }
  if (lacks_some && !may_stand && is_first(kHole))
    counts_[kHole].first = fps_ > 0
                               ? fmt::format("id {} at {}: {} frames before it are missing", id,
                                             name_(to.time_s), std::lround(gap_s * fps_) - 1)
                               : fmt::format("id {} at {}: {:.3g} s after its last position", id,
                                             name_(to.time_s), gap_s);
  if (way_m <= kFastest_mps * gap_s) return;
  const Kind kind = way_m > kJump_m ? kJump : kFast;
  if (is_first(kind))
    counts_[kind].first =
        fmt::format("id {} at {}: {:.3g} m in {:.3g} s", id, name_(to.time_s), way_m, gap_s);
}

void TrackCheck::take(int64_t id, std::span<const Sample> samples, const Duplicates& duplicates) {
  if (samples.empty()) return;
  if (duplicates.count > 0 && is_first(kTwice, duplicates.count))
    counts_[kTwice].first = fmt::format("id {} at {}", id, name_(duplicates.first_s));
  if (samples.size() == 1) {
    if (is_first(kOnce))
      counts_[kOnce].first = fmt::format("id {} at {}", id, name_(samples[0].time_s));
  } else {
    const double usual_s = usual_interval_s(samples);
    for (size_t i = 1; i < samples.size(); ++i) step(id, samples[i - 1], samples[i], usual_s);
  }
  if (area_ == nullptr) return;
  for (const Sample& sample : samples)
    if (!area_->contains(sample.position_m) && is_first(kOutside))
      counts_[kOutside].first =
          fmt::format("id {} at {}: ({:.3f}, {:.3f}) m", id, name_(sample.time_s),
                      sample.position_m.x(), sample.position_m.y());
}

std::vector<Oddity> TrackCheck::found() const {
  static constexpr const char* kWhat[kKinds] = {
      "jumps of more than 3 m",
      "faster than 12 m/s",
      "ids that come back after more than a second",
      "holes in a track",
      "second positions at one instant (the first is kept)",
      "positions outside the walkable area",
      "people who are seen at one instant only"};
  std::vector<Oddity> out;
  for (size_t kind = 0; kind < kKinds; ++kind)
    if (counts_[kind].count > 0)
      out.push_back({kWhat[kind], counts_[kind].count, counts_[kind].first});
  return out;
}

}  // namespace throng
