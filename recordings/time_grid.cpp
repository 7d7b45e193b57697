#include "recordings/time_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace throng {
namespace {

/// Accumulated floating-point steps drift by a fraction of the step and with the time.
double allowed_s(const PrintedTimes& times, double per_s, double time_s) {
  return 2 * times.rounding_s + 1e-4 / per_s + 1e-7 * std::abs(time_s - times.first_s);
}

struct Spans {
  double min_gap_s = std::numeric_limits<double>::infinity();
  size_t longest = 0;
};

Spans spans_of(const SampleStore& store) {
  Spans out;
  double longest_s = -1;
  std::vector<StoredSample> samples;
  for (size_t person = 0; person < store.people(); ++person) {
    store.read(person, samples);
    if (samples.empty()) continue;
    const double span_s = samples.back().instant - samples.front().instant;
    if (span_s > longest_s) {
      longest_s = span_s;
      out.longest = person;
    }
    for (size_t i = 1; i < samples.size(); ++i) {
      const double gap_s = samples[i].instant - samples[i - 1].instant;
      if (gap_s > 1e-6) out.min_gap_s = std::min(out.min_gap_s, gap_s);
    }
  }
  return out;
}

/// Refines a first guess over increasing spans of one track: each span determines the number of
/// frames in the next.
double refined(const std::vector<StoredSample>& track, double per_s) {
  double longest_s = 0;
  for (const StoredSample& sample : track) {
    const double span_s = sample.instant - track.front().instant;
    const double frames = std::round(span_s * per_s);
    if (frames < 1 || span_s <= longest_s) continue;
    longest_s = span_s;
    per_s = frames / span_s;
  }
  return per_s;
}

/// Returns whether steps alternate between one and two last digits: the rate is as fine as the
/// digits.
bool is_truncated(const std::vector<StoredSample>& track, double digit_s) {
  size_t single = 0, twofold = 0;
  for (size_t i = 1; i < track.size(); ++i) {
    const double digits = (track[i].instant - track[i - 1].instant) / digit_s;
    single += digits > 0.5 && digits < 1.5 ? 1 : 0;
    twofold += digits > 1.5 && digits < 2.5 ? 1 : 0;
  }
  return single > 0 && single + twofold + 1 == track.size() && 10 * twofold > track.size();
}

/// Rounds to a whole number of frames per second, or of milliseconds per frame, if possible.
double rounded(double per_s, double allowed) {
  const auto near = [&](double nice) { return std::abs(nice - per_s) <= allowed; };
  if (const double whole = std::round(per_s); whole >= 1 && near(whole)) return whole;
  if (const double ms = std::round(1000 / per_s); ms >= 1 && near(1000 / ms)) return 1000 / ms;
  if (const double film = std::round(per_s * 1.001) / 1.001; film > 0 && near(film)) return film;
  return per_s;
}

}  // namespace

void RateEstimator::take(double frame, double time_s, double rounding_s) {
  if (!std::isfinite(frame) || !std::isfinite(time_s)) return;
  // Trailing zeros may be omitted: the longest number shows the digits.
  rounding_s_ = is_empty_ ? rounding_s : std::min(rounding_s_, rounding_s);
  if (is_empty_ || frame < first_frame_) {
    first_frame_ = frame;
    first_s_ = time_s;
  }
  if (is_empty_ || frame > last_frame_) {
    last_frame_ = frame;
    last_s_ = time_s;
  }
  is_empty_ = false;
}

std::optional<double> RateEstimator::per_s() const {
  if (!(last_frame_ > first_frame_ && last_s_ > first_s_)) return std::nullopt;
  return (last_frame_ - first_frame_) / (last_s_ - first_s_);
}

double RateEstimator::uncertainty() const { return 2 * rounding_s_ / (last_s_ - first_s_); }

bool lie_on(const SampleStore& store, const PrintedTimes& times, double per_s) {
  std::vector<StoredSample> samples;
  for (size_t person = 0; person < store.people(); ++person) {
    store.read(person, samples);
    double last_frame = -1;
    double last_s = -std::numeric_limits<double>::infinity();
    for (const StoredSample& sample : samples) {
      const double since_s = sample.instant - times.first_s;
      const double frame = std::round(since_s * per_s);
      if (std::abs(since_s - frame / per_s) > allowed_s(times, per_s, sample.instant)) return false;
      // Two instants on one frame: the rate is too low.
      if (sample.instant > last_s && frame <= last_frame) return false;
      last_frame = frame;
      last_s = sample.instant;
    }
  }
  return true;
}

std::optional<double> regular_rate(const SampleStore& store, const PrintedTimes& times) {
  const Spans spans = spans_of(store);
  if (!std::isfinite(spans.min_gap_s)) return std::nullopt;
  std::vector<StoredSample> track;
  store.read(spans.longest, track);
  const double span_s = track.back().instant - track.front().instant;
  const auto rate_from = [&](double guess, double rounding_s) {
    return rounded(guess, guess * (2 * rounding_s / span_s + 1e-6));
  };
  // If a step is hardly longer than the last digit, only the mean is reliable.
  if (is_truncated(track, 2 * times.rounding_s)) {
    const double mean = static_cast<double>(track.size() - 1) / span_s;
    if (const double rate = rate_from(mean, times.rounding_s); lie_on(store, times, rate))
      return rate;
  }
  // Most rates are exact; 60 per second is not, with few digits.
  const double guess = refined(track, 1 / spans.min_gap_s);
  if (const double rate = rate_from(guess, 0); lie_on(store, {times.first_s, 0}, rate)) return rate;
  if (const double rate = rate_from(guess, times.rounding_s); lie_on(store, times, rate))
    return rate;
  return std::nullopt;
}

std::optional<double> usual_rate(const SampleStore& store) {
  std::vector<StoredSample> track;
  store.read(spans_of(store).longest, track);
  std::vector<double> gaps_s;
  for (size_t i = 1; i < track.size(); ++i)
    if (const double gap_s = track[i].instant - track[i - 1].instant; gap_s > 0)
      gaps_s.push_back(gap_s);
  if (gaps_s.empty()) return std::nullopt;
  const auto middle = gaps_s.begin() + static_cast<std::ptrdiff_t>(gaps_s.size() / 2);
  std::nth_element(gaps_s.begin(), middle, gaps_s.end());
  const double hole_s = 1.5 * *middle;
  std::erase_if(gaps_s, [&](double gap_s) { return gap_s > hole_s; });
  return static_cast<double>(gaps_s.size()) / std::accumulate(gaps_s.begin(), gaps_s.end(), 0.0);
}

}  // namespace throng
