#include "scenes/recorded/time_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace throng {
namespace {

/// Sums of a step in floating point drift by a little of the step, and with the time.
double allowed_s(const PrintedTimes& times, double per_s, double time_s) {
  return 2 * times.rounding_s + 1e-4 / per_s + 1e-7 * std::abs(time_s - times.first_s);
}

struct Spans {
  double least_gap_s = std::numeric_limits<double>::infinity();  ///< of one person
  size_t longest = 0;                                            ///< whose track is
};

Spans spans_of(const SampleStore& store, const PrintedTimes& times) {
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
      if (gap_s > std::max(times.rounding_s, 1e-6))
        out.least_gap_s = std::min(out.least_gap_s, gap_s);
    }
  }
  return out;
}

/// A first guess made better by longer and longer spans of one track: each tells the number of
/// frames of the next.
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

/// A whole number of frames a second, or of milliseconds a frame, where it could be one.
double rounded(double per_s, double allowed) {
  const auto near = [&](double nice) { return std::abs(nice - per_s) <= allowed; };
  if (const double whole = std::round(per_s); whole >= 1 && near(whole)) return whole;
  if (const double ms = std::round(1000 / per_s); ms >= 1 && near(1000 / ms)) return 1000 / ms;
  if (const double film = std::round(per_s * 1.001) / 1.001; film > 0 && near(film)) return film;
  return per_s;
}

}  // namespace

bool lie_on(const SampleStore& store, const PrintedTimes& times, double per_s) {
  std::vector<StoredSample> samples;
  for (size_t person = 0; person < store.people(); ++person) {
    store.read(person, samples);
    for (const StoredSample& sample : samples) {
      const double since_s = sample.instant - times.first_s;
      const double off_s = std::abs(since_s - std::round(since_s * per_s) / per_s);
      if (off_s > allowed_s(times, per_s, sample.instant)) return false;
    }
  }
  return true;
}

std::optional<double> regular_rate(const SampleStore& store, const PrintedTimes& times) {
  const Spans spans = spans_of(store, times);
  // Where rounding is as large as the steps, every time lies on every grid.
  if (!std::isfinite(spans.least_gap_s) || spans.least_gap_s < 4 * times.rounding_s)
    return std::nullopt;
  std::vector<StoredSample> track;
  store.read(spans.longest, track);
  const double guess = refined(track, 1 / spans.least_gap_s);
  const double span_s = track.back().instant - track.front().instant;
  const double rate = rounded(guess, guess * (2 * times.rounding_s / span_s + 1e-6));
  if (lie_on(store, times, rate)) return rate;
  return std::nullopt;
}

}  // namespace throng
