#include "scenes/retargeting/sway.h"

#include <array>
#include <cmath>
#include <complex>
#include <limits>

#include "base/elementary.h"

namespace throng {
namespace {

/// The window reaches so far to both sides; its weights are nearly a Gaussian of a third of it.
constexpr double kReach_s = 1.8;
/// Of recorded heads nine in ten sway by 2 cm and more; noise of 5 mm comes to less than this.
constexpr double kLeastSway_m = 0.008;
/// Fewer samples a stride do not show it.
constexpr double kLeastSamples = 6;
/// Of people who stand or shuffle, sway is no stride.
constexpr double kSlowest_hz = 0.35;
/// Strides are compared with the nearest of these: what is 0.1 Hz beside it still shows.
constexpr std::array<double, 4> kWaves_hz = {0.5, 0.7, 0.9, 1.1};

using Complex = std::complex<float>;

size_t wave_near(double strides_hz) {
  size_t nearest = 0;
  for (size_t i = 1; i < kWaves_hz.size(); ++i)
    if (std::abs(kWaves_hz[i] - strides_hz) < std::abs(kWaves_hz[nearest] - strides_hz))
      nearest = i;
  return nearest;
}

/// The deviation times each wave turned backwards, for every sample.
std::vector<std::array<Complex, kWaves_hz.size()>> turned_back(std::span<const SwaySample> track) {
  std::vector<std::array<Complex, kWaves_hz.size()>> out(track.size());
  for (size_t i = 0; i < track.size(); ++i) {
    const double since_s = track[i].time_s - track.front().time_s;
    for (size_t wave = 0; wave < kWaves_hz.size(); ++wave) {
      const double turns = kWaves_hz[wave] * since_s;
      const SinCos at = sin_cos(kTurn * (turns - std::floor(turns)));
      out[i][wave] = {static_cast<float>(track[i].left_m * at.cos),
                      static_cast<float>(-track[i].left_m * at.sin)};
    }
  }
  return out;
}

}  // namespace

std::vector<float> strides_since_left(std::span<const SwaySample> track) {
  std::vector<float> phases(track.size(), std::numeric_limits<float>::quiet_NaN());
  const auto turned = turned_back(track);
  size_t begin = 0, end = 0;
  for (size_t i = 0; i < track.size(); ++i) {
    const SwaySample& here = track[i];
    while (here.time_s - track[begin].time_s > kReach_s) ++begin;
    while (end < track.size() && track[end].time_s - here.time_s <= kReach_s) ++end;
    const double strides = (track[end - 1].time_s - track[begin].time_s) * here.strides_hz;
    const auto samples = static_cast<double>(end - begin);
    if (here.strides_hz < kSlowest_hz || strides < 1 || samples < kLeastSamples * strides) continue;
    const size_t wave = wave_near(here.strides_hz);
    std::complex<double> common = 0;
    double weight = 0;
    for (size_t j = begin; j < end; ++j) {
      const double u = (track[j].time_s - here.time_s) / kReach_s, inside = 1 - u * u;
      const double w = inside * inside * inside;
      common += w * std::complex<double>(turned[j][wave]);
      weight += w;
    }
    if (2 * std::abs(common) < kLeastSway_m * weight) continue;
    const double since_s = here.time_s - track.front().time_s;
    const double turns = arc_tan2(common.imag(), common.real()) / kTurn + kWaves_hz[wave] * since_s;
    phases[i] = phase_of(turns);
  }
  return phases;
}

}  // namespace throng
