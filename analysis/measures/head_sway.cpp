#include "analysis/measures/head_sway.h"

#include <algorithm>
#include <cmath>

namespace throng {
namespace {

/// Half the window that smooths the path. Weights fall off evenly to both sides: what sways once in
/// about a second is gone from the path, so all of it is seen as sway.
constexpr double kHalfWindow_s = 1;
/// With fewer instants a second the extremes are missed.
constexpr double kLongestSample_s = 0.15;
/// Slower people do not sway step by step.
constexpr double kWalking_mps = 0.3;
/// Less is noise.
constexpr double kLeast_m = 0.005;
/// Half waves shorter or longer are not those of steps: 0.4 to 2 strides a second.
constexpr double kShortestWave_s = 0.25, kLongestWave_s = 1.25;
/// A smoothed path cuts corners by what hardly changes over so long.
constexpr double kLevel_s = 2;
/// Until that is known no wave counts.
constexpr double kSettled_s = 1;
/// Of a person, to have an amplitude.
constexpr uint32_t kLeastHalfWaves = 4;

}  // namespace

HeadSway::HeadSway(size_t people, double sample_s)
    : half_(half_window(sample_s)), sample_s_(sample_s), waves_(people), people_(people) {}

size_t HeadSway::half_window(double sample_s) {
  return sample_s > kLongestSample_s ? 0
                                     : static_cast<size_t>(std::round(kHalfWindow_s / sample_s));
}

void HeadSway::take(const RecentCrowd& crowd) {
  if (half_ == 0) return;
  const Moment& moment = crowd.ago(half_);
  for (size_t i = 0; i < waves_.size(); ++i) {
    if (!crowd.stayed(i, half_, half_, half_)) {
      waves_[i] = {};
      continue;
    }
    Eigen::Vector2d path = Eigen::Vector2d::Zero(), before = path, after = path;
    double weights = 0;
    for (size_t k = 0; k <= 2 * half_; ++k) {
      const Eigen::Vector2d& head = crowd.ago(k).heads_m[i];
      const double weight = static_cast<double>(std::min(k, 2 * half_ - k) + 1);
      path += weight * head;
      weights += weight;
      if (k < half_) after += head;
      if (k > half_) before += head;
    }
    const Eigen::Vector2d way = (after - before) / static_cast<double>(half_);
    const double speed_mps = way.norm() / (static_cast<double>(half_ + 1) * sample_s_);
    if (speed_mps < kWalking_mps) {
      waves_[i] = {};
      continue;
    }
    const Eigen::Vector2d off = moment.heads_m[i] - path / weights;
    follow(i, (way.x() * off.y() - way.y() * off.x()) / way.norm(), speed_mps, moment.time_s);
  }
}

void HeadSway::follow(size_t person, double across_m, double speed_mps, double time_s) {
  Wave& wave = waves_[person];
  ++wave.followed;
  wave.level_m += std::max(1.0 / wave.followed, sample_s_ / kLevel_s) * (across_m - wave.level_m);
  const double off_m = across_m - wave.level_m;
  if (wave.moments > 0 && (wave.last_m < 0) != (off_m < 0)) {
    const double share = wave.last_m / (wave.last_m - off_m);
    const double crossing_s = time_s - (1 - share) * sample_s_;
    if (wave.has_crossed) finish_half_wave(person, wave, crossing_s);
    wave.has_crossed = wave.followed * sample_s_ >= kSettled_s;
    wave.since_s = crossing_s;
    wave.extreme_m = 0;
    wave.speed_mps = 0;
    wave.moments = 0;
  }
  wave.last_m = off_m;
  wave.extreme_m = std::max(wave.extreme_m, std::abs(off_m));
  wave.speed_mps += speed_mps;
  ++wave.moments;
}

void HeadSway::finish_half_wave(size_t person, const Wave& wave, double crossing_s) {
  const double length_s = crossing_s - wave.since_s;
  if (wave.extreme_m < kLeast_m || length_s < kShortestWave_s || length_s > kLongestWave_s) return;
  people_[person].amplitude_m += wave.extreme_m;
  ++people_[person].half_waves;
  const double speed_mps = wave.speed_mps / wave.moments;
  for (size_t i = 0; i < paces_.size(); ++i) {
    if (speed_mps < kSpeeds_mps[i] || speed_mps >= kSpeeds_mps[i + 1]) continue;
    paces_[i].half_waves += 1;
    paces_[i].time_s += length_s;
  }
}

MeasureTable HeadSway::table() const {
  MeasureTable table{
      "sway",
      "Head sway",
      "speed",
      "m/s",
      "Across the head's path, smoothed over two seconds, of those who walk (0.3 m/s "
      "or more). Amplitude: a person's mean over half waves. Frequency: strides a "
      "second.",
      {},
      {}};
  Histogram amplitudes(0, 0.0005, 400);
  for (const Person& person : people_)
    if (person.half_waves >= kLeastHalfWaves)
      amplitudes.add(person.amplitude_m / person.half_waves);
  if (amplitudes.count() == 0) return table;
  const auto amplitude = [&](const std::string& what, double value) {
    table.rows.push_back({"amplitude", {}, {}, "", what, "m", value});
  };
  amplitude("mean", amplitudes.mean());
  amplitude("10 %", amplitudes.quantile(0.1));
  amplitude("90 %", amplitudes.quantile(0.9));
  for (size_t i = 0; i < paces_.size(); ++i)
    if (paces_[i].half_waves >= 2 * kLeastHalfWaves)
      table.rows.push_back(ranged_row(kSpeeds_mps[i], kSpeeds_mps[i + 1], "", "frequency", "Hz",
                                      paces_[i].half_waves / (2 * paces_[i].time_s)));
  return table;
}

}  // namespace throng
