#include "scenes/retargeting/retarget.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>

#include "avatars/gait/gait.h"
#include "base/portable_math.h"
#include "scenes/retargeting/head_offset.h"

namespace throng {
namespace {

// Gait phase from the sway of a recorded head. A head sways towards the supporting foot, once per
// stride. A Gabor transform gives amplitude and phase: it correlates the lateral deviation from the
// path with a wave of the expected stride frequency in a window of a few strides.

struct SwaySample {
  double time_s = 0;
  double left_m = 0;      ///< lateral deviation of the head from the path
  double strides_hz = 0;  ///< stride frequency of the gait at this speed; 0: stands
};

/// Half width of the window; its weights are nearly a Gaussian with a third of this width.
constexpr double kReach_s = 1.8;
/// Minimum amplitude. Nine in ten recorded heads sway by 2 cm or more; 5 mm of noise gives less
/// than this.
constexpr double kMinSway_m = 0.008;
constexpr double kMinSamples = 6;
/// Slower sway of people who stand or shuffle is no stride.
constexpr double kMinStride_hz = 0.35;
/// Wave frequencies; a stride frequency 0.1 Hz off the nearest one is still detected.
constexpr std::array<double, 4> kWaves_hz = {0.5, 0.7, 0.9, 1.1};

using Complex = std::complex<float>;

size_t nearest_wave(double strides_hz) {
  size_t nearest = 0;
  for (size_t i = 1; i < kWaves_hz.size(); ++i)
    if (std::abs(kWaves_hz[i] - strides_hz) < std::abs(kWaves_hz[nearest] - strides_hz))
      nearest = i;
  return nearest;
}

/// Deviation times the conjugate of each wave, per sample.
std::vector<std::array<Complex, kWaves_hz.size()>> demodulated(std::span<const SwaySample> track) {
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

/// Strides since the head was last farthest to the left, in [0, 1); NaN: no visible sway. `track`
/// is in ascending order of time.
std::vector<float> strides_since_left(std::span<const SwaySample> track) {
  std::vector<float> phases(track.size(), std::numeric_limits<float>::quiet_NaN());
  const auto products = demodulated(track);
  size_t begin = 0, end = 0;
  for (size_t i = 0; i < track.size(); ++i) {
    const SwaySample& here = track[i];
    while (here.time_s - track[begin].time_s > kReach_s) ++begin;
    while (end < track.size() && track[end].time_s - here.time_s <= kReach_s) ++end;
    const double strides = (track[end - 1].time_s - track[begin].time_s) * here.strides_hz;
    const auto samples = static_cast<double>(end - begin);
    if (here.strides_hz < kMinStride_hz || strides < 1 || samples < kMinSamples * strides) continue;
    const size_t wave = nearest_wave(here.strides_hz);
    std::complex<double> common = 0;
    double weight = 0;
    for (size_t j = begin; j < end; ++j) {
      const double u = (track[j].time_s - here.time_s) / kReach_s, inside = 1 - u * u;
      const double w = inside * inside * inside;
      common += w * std::complex<double>(products[j][wave]);
      weight += w;
    }
    if (2 * std::abs(common) < kMinSway_m * weight) continue;
    const double since_s = here.time_s - track.front().time_s;
    const double turns = arc_tan2(common.imag(), common.real()) / kTurn + kWaves_hz[wave] * since_s;
    phases[i] = phase_of(turns);
  }
  return phases;
}

// Smoothing of a recorded path. Fits use samples before and after an instant: no delay.

struct PathPoint {
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d velocity_mps = Eigen::Vector2d::Zero();
};

struct Window {
  size_t begin = 0, end = 0;

  void move_to(std::span<const Sample> track, size_t at, double reach_s) {
    while (track[at].time_s - track[begin].time_s > reach_s) ++begin;
    end = std::max(end, at + 1);
    while (end < track.size() && track[end].time_s - track[at].time_s <= reach_s) ++end;
  }
  size_t size() const { return end - begin; }
};

Eigen::Vector2d velocity_by_neighbours(std::span<const Sample> track, size_t at) {
  const Sample& before = track[at > 0 ? at - 1 : at];
  const Sample& after = track[std::min(at + 1, track.size() - 1)];
  const double time_s = after.time_s - before.time_s;
  if (!(time_s > 0)) return Eigen::Vector2d::Zero();
  return (after.position_m - before.position_m) / time_s;
}

/// Path of the body from lines fitted within `reach_s` of each sample; faster sway is removed.
std::vector<PathPoint> path_of(std::span<const Sample> track, double reach_s) {
  std::vector<PathPoint> path(track.size());
  Window window;
  for (size_t i = 0; i < track.size(); ++i) {
    window.move_to(track, i, reach_s);
    const Sample& here = track[i];
    double weight = 0, first = 0, second = 0;
    Eigen::Vector2d sum = Eigen::Vector2d::Zero(), tilt = Eigen::Vector2d::Zero();
    for (size_t j = window.begin; j < window.end; ++j) {
      const double u = (track[j].time_s - here.time_s) / reach_s;
      const double inside = 1 - u * u, w = inside * inside * inside;
      const Eigen::Vector2d d = track[j].position_m - here.position_m;
      weight += w;
      first += w * u;
      second += w * u * u;
      sum += w * d;
      tilt += w * u * d;
    }
    const double determinant = weight * second - first * first;
    path[i] = {here.position_m, velocity_by_neighbours(track, i)};
    if (window.size() < 3 || !(determinant > 1e-6 * weight * weight)) continue;
    path[i].position_m += (second * sum - first * tilt) / determinant;
    path[i].velocity_mps = (weight * tilt - first * sum) / (determinant * reach_s);
  }
  return path;
}

/// Positions from parabolas fitted within `reach_s` of each sample, which keep the sway of steps.
/// No position moves by more than `max_move_m`.
std::vector<Eigen::Vector2d> without_noise(std::span<const Sample> track, double reach_s,
                                           double max_move_m) {
  std::vector<Eigen::Vector2d> smooth(track.size());
  Window window;
  for (size_t i = 0; i < track.size(); ++i) {
    window.move_to(track, i, reach_s);
    smooth[i] = track[i].position_m;
    if (window.size() < 5) continue;
    double s1 = 0, s2 = 0, s3 = 0, s4 = 0;
    Eigen::Vector2d b0 = Eigen::Vector2d::Zero(), b1 = b0, b2 = b0;
    for (size_t j = window.begin; j < window.end; ++j) {
      const double u = (track[j].time_s - track[i].time_s) / reach_s, square = u * u;
      const Eigen::Vector2d d = track[j].position_m - track[i].position_m;
      s1 += u;
      s2 += square;
      s3 += square * u;
      s4 += square * square;
      b0 += d;
      b1 += u * d;
      b2 += square * d;
    }
    const auto s0 = static_cast<double>(window.size());
    // Value of the parabola here, by Cramer's rule.
    const double c0 = s2 * s4 - s3 * s3, c1 = s2 * s3 - s1 * s4, c2 = s1 * s3 - s2 * s2;
    const double determinant = s0 * c0 + s1 * c1 + s2 * c2;
    if (!(determinant > 1e-9)) continue;
    Eigen::Vector2d move = (c0 * b0 + c1 * b1 + c2 * b2) / determinant;
    const double length_m = move.norm();
    if (length_m > max_move_m) move *= max_move_m / length_m;
    smooth[i] += move;
  }
  return smooth;
}

/// A stride takes about 1 s: faster deviations from the path are sway.
constexpr double kPathReach_s = 1.2;
/// Reach of the parabolas that remove noise from heads, and the maximum correction.
constexpr double kNoiseReach_s = 0.13;
constexpr double kMaxNoise_m = 0.01;
/// Headings are directions over this distance before and after; shorter displacements are shuffles.
constexpr double kHeadingDistance_m = 0.4;
constexpr double kHeadingReach_s = 1.0;
/// Time ahead for which people know their velocity, and smoothing of the path for it.
constexpr double kNext_s = 0.3;
constexpr double kNextReach_s = 0.5;
/// The mean of two nearly opposite directions is undefined.
constexpr double kMinDirection = 1e-6;

double usual_interval_s(std::span<const Sample> track) {
  std::vector<double> intervals;
  const size_t count = std::min<size_t>(track.size() - 1, 64);
  for (size_t i = 0; i < count; ++i) intervals.push_back(track[i + 1].time_s - track[i].time_s);
  if (intervals.empty()) return 0;
  const auto middle = intervals.begin() + static_cast<ptrdiff_t>(intervals.size() / 2);
  std::nth_element(intervals.begin(), middle, intervals.end());
  return *middle;
}

TrackSample::Next next_of(const Sample& from, const Sample& to, double max_gap_s) {
  const double time_s = to.time_s - from.time_s;
  if (time_s > max_gap_s) return TrackSample::Next::kAbsent;
  const double moved_m = (to.position_m - from.position_m).norm();
  return moved_m > kMaxRunSpeed_mps * time_s && moved_m > 0.5 ? TrackSample::Next::kJump
                                                              : TrackSample::Next::kMove;
}

/// Heading at each sample: mean direction of the path before and after, weighted by proximity in
/// time. Standing people turn from where they came from to where they go.
class Headings {
 public:
  explicit Headings(std::span<const Sample> track, std::span<const PathPoint> path)
      : track_(track), path_(path) {}

  std::vector<double> along_path() {
    std::vector<double> headings(track_.size());
    size_t back = 0, ahead = 0;
    double last = first_rad();
    for (size_t i = 0; i < track_.size(); ++i) {
      while (back + 1 < i && apart_m(back + 1, i) >= kHeadingDistance_m) ++back;
      ahead = std::max(ahead, i);
      while (ahead + 1 < track_.size() && apart_m(i, ahead) < kHeadingDistance_m) ++ahead;
      const Eigen::Vector2d direction = towards(back, i) + towards(i, ahead);
      if (direction.norm() > kMinDirection)
        last = unwrapped(arc_tan2(direction.y(), direction.x()), last);
      headings[i] = last;
    }
    return headings;
  }

  std::vector<double> recorded() const {
    std::vector<double> headings(track_.size());
    double last = first_recorded_rad();
    for (size_t i = 0; i < track_.size(); ++i) {
      if (!std::isnan(track_[i].heading_rad))
        last = unwrapped(static_cast<double>(track_[i].heading_rad), last);
      headings[i] = last;
    }
    return headings;
  }

  bool are_recorded() const {
    return std::any_of(track_.begin(), track_.end(),
                       [](const Sample& sample) { return !std::isnan(sample.heading_rad); });
  }

 private:
  static double unwrapped(double heading_rad, double last) {
    return last + std::remainder(heading_rad - last, kTurn);
  }
  double apart_m(size_t a, size_t b) const {
    return (path_[b].position_m - path_[a].position_m).norm();
  }
  /// Direction from one sample to another, weighted by the inverse duration; nearly zero if they
  /// are close together.
  Eigen::Vector2d towards(size_t from, size_t to) const {
    const Eigen::Vector2d path = path_[to].position_m - path_[from].position_m;
    const double length_m = path.norm();
    if (length_m < 0.5 * kHeadingDistance_m) return kMinDirection * path;
    return path / (length_m * (0.05 + track_[to].time_s - track_[from].time_s));
  }
  double first_rad() const {
    const Eigen::Vector2d path = path_.back().position_m - path_.front().position_m;
    return path.norm() > 0 ? arc_tan2(path.y(), path.x()) : 0;
  }
  double first_recorded_rad() const {
    for (const Sample& sample : track_)
      if (!std::isnan(sample.heading_rad)) return static_cast<double>(sample.heading_rad);
    return 0;
  }

  std::span<const Sample> track_;
  std::span<const PathPoint> path_;
};

/// Smooths angles by line fits, because people do not turn instantly.
std::vector<double> smoothed(std::span<const Sample> track, std::span<const double> angles) {
  std::vector<Sample> as_track(track.begin(), track.end());
  for (size_t i = 0; i < as_track.size(); ++i) as_track[i].position_m = {angles[i], 0};
  std::vector<double> out;
  for (const PathPoint& point : path_of(as_track, kHeadingReach_s))
    out.push_back(point.position_m.x());
  return out;
}

class TrackSegment {
 public:
  TrackSegment(std::span<const Sample> track, const RetargetBody& body,
               std::span<TrackSample> samples)
      : track_(track), body_(body), samples_(samples), path_(path_of(track, kPathReach_s)) {}

  void retarget() {
    place();
    turn();
    for (size_t i = 0; i < track_.size(); ++i) {
      const SinCos heading = sin_cos(static_cast<double>(samples_[i].heading_rad));
      const Eigen::Vector2d& v = path_[i].velocity_mps;
      samples_[i].ahead_mps = static_cast<float>(v.x() * heading.cos + v.y() * heading.sin);
    }
    find_next();
    find_phases();
  }

 private:
  bool is_head() const { return body_.tracked == TrackedPoint::kHead; }

  void place() {
    std::vector<Eigen::Vector2d> heads;
    if (is_head()) heads = without_noise(track_, kNoiseReach_s, kMaxNoise_m);
    for (size_t i = 0; i < track_.size(); ++i) {
      const Eigen::Vector2d& at = is_head() ? heads[i] : track_[i].position_m;
      samples_[i].time_s = track_[i].time_s;
      samples_[i].x_m = at.x();
      samples_[i].y_m = at.y();
    }
  }

  void turn() {
    Headings headings(track_, path_);
    // Recorded headings are as accurate as positions and are not smoothed.
    const std::vector<double> all =
        headings.are_recorded() ? headings.recorded() : smoothed(track_, headings.along_path());
    const double turns = kTurn * std::floor(all.front() / kTurn);
    for (size_t i = 0; i < all.size(); ++i)
      samples_[i].heading_rad = static_cast<float>(all[i] - turns);
  }

  void find_next() {
    const std::vector<PathPoint> path = path_of(track_, kNextReach_s);
    size_t then = 0;
    for (size_t i = 0; i < track_.size(); ++i) {
      then = std::max(then, i);
      while (then + 1 < track_.size() &&
             track_[then].time_s < track_[i].time_s + kNext_s - kTimeTolerance_s)
        ++then;
      Eigen::Vector2d next_mps = path[i].velocity_mps;
      if (then > i)
        next_mps =
            (path[then].position_m - path[i].position_m) / (track_[then].time_s - track_[i].time_s);
      samples_[i].next_x_mps = static_cast<float>(next_mps.x());
      samples_[i].next_y_mps = static_cast<float>(next_mps.y());
    }
  }

  void find_phases() {
    for (TrackSample& sample : samples_) sample.phase = std::numeric_limits<float>::quiet_NaN();
    if (!is_head() || !body_.head->has_head()) return;
    std::vector<SwaySample> sway;
    for (size_t i = 0; i < track_.size(); ++i) {
      const Eigen::Vector2d& v = path_[i].velocity_mps;
      const double speed_mps = v.norm();
      const Eigen::Vector2d off_m = track_[i].position_m - path_[i].position_m;
      const double left_m = speed_mps > 0 ? (v.x() * off_m.y() - v.y() * off_m.x()) / speed_mps : 0;
      const auto speed = static_cast<float>(speed_mps);
      const double stride_m = static_cast<double>(body_.gait->stride_length_m(speed, body_.scale));
      sway.push_back({track_[i].time_s, left_m, speed_mps / stride_m});
    }
    const std::vector<float> since_left = strides_since_left(sway);
    for (size_t i = 0; i < samples_.size(); ++i) {
      const float leftmost = body_.head->leftmost_phase(samples_[i].ahead_mps, body_.scale);
      samples_[i].phase = phase_of(since_left[i] + leftmost);
    }
    bridge_phases();
  }

  double strides_after(size_t i) const {
    const double ahead_mps = static_cast<double>(std::max(samples_[i].ahead_mps, 0.0f));
    const double stride_m = static_cast<double>(
        body_.gait->stride_length_m(static_cast<float>(ahead_mps), body_.scale));
    return ahead_mps * (track_[i + 1].time_s - track_[i].time_s) / stride_m;
  }

  /// Fills phases without visible sway from the distance walked, blended between seen phases to
  /// avoid jumps.
  void bridge_phases() {
    const auto is_seen = [](const TrackSample& sample) { return !std::isnan(sample.phase); };
    const auto first = std::find_if(samples_.begin(), samples_.end(), is_seen);
    if (first == samples_.end()) return;
    auto seen = static_cast<size_t>(first - samples_.begin());
    for (size_t i = seen; i > 0; --i)
      samples_[i - 1].phase =
          phase_of(static_cast<double>(samples_[i].phase) - strides_after(i - 1));
    while (true) {
      size_t next = seen + 1;
      double strides = 0;
      for (; next < samples_.size() && !is_seen(samples_[next]); ++next)
        strides += strides_after(next - 1);
      if (next == samples_.size()) return;
      strides += strides_after(next - 1);
      const auto from = static_cast<double>(samples_[seen].phase);
      const double off =
          std::remainder(static_cast<double>(samples_[next].phase) - (from + strides), 1.0);
      double walked = 0;
      for (size_t i = seen + 1; i < next; ++i) {
        walked += strides_after(i - 1);
        samples_[i].phase = phase_of(from + walked + (strides > 0 ? off * walked / strides : 0));
      }
      seen = next;
    }
  }

  std::span<const Sample> track_;
  const RetargetBody& body_;
  std::span<TrackSample> samples_;
  std::vector<PathPoint> path_;
};

/// Slope of a monotone cubic: harmonic mean of two slopes weighted by intervals, 0 at an extreme
/// (Fritsch and Butland 1984).
double slope(double h0, double s0, double h1, double s1) {
  if (!(s0 * s1 > 0)) return 0;
  const double w0 = 2 * h1 + h0, w1 = h1 + 2 * h0;
  return (w0 + w1) / (w0 / s0 + w1 / s1);
}

double cubic(double from, double to, double slope_from, double slope_to, double h, double u) {
  const double v = 1 - u;
  return from * v * v * (1 + 2 * u) + slope_from * h * u * v * v + to * u * u * (1 + 2 * v) -
         slope_to * h * u * u * v;
}

}  // namespace

std::vector<TrackSample> retarget(std::span<const Sample> track, const RetargetBody& body) {
  std::vector<TrackSample> samples(track.size());
  const double max_gap_s = std::max(kMaxTrackGap_s, 1.5 * usual_interval_s(track));
  size_t begin = 0;
  for (size_t i = 0; i < track.size(); ++i) {
    const bool is_last = i + 1 == track.size();
    samples[i].next =
        is_last ? TrackSample::Next::kAbsent : next_of(track[i], track[i + 1], max_gap_s);
    if (samples[i].next == TrackSample::Next::kMove) continue;
    const size_t count = i + 1 - begin;
    TrackSegment(track.subspan(begin, count), body, std::span(samples).subspan(begin, count))
        .retarget();
    begin = i + 1;
  }
  return samples;
}

Eigen::Vector2d position_between(const TrackSample* before, const TrackSample& from,
                                 const TrackSample& to, const TrackSample* after, double time_s) {
  const double h = to.time_s - from.time_s;
  const double u = std::clamp((time_s - from.time_s) / h, 0.0, 1.0);
  Eigen::Vector2d out;
  for (const auto coordinate : {&TrackSample::x_m, &TrackSample::y_m}) {
    const double s = (to.*coordinate - from.*coordinate) / h;
    double first = s, last = s;
    if (before != nullptr) {
      const double h0 = from.time_s - before->time_s;
      first = slope(h0, (from.*coordinate - before->*coordinate) / h0, h, s);
    }
    if (after != nullptr) {
      const double h1 = after->time_s - to.time_s;
      last = slope(h, s, h1, (after->*coordinate - to.*coordinate) / h1);
    }
    out[coordinate == &TrackSample::x_m ? 0 : 1] =
        cubic(from.*coordinate, to.*coordinate, first, last, h, u);
  }
  return out;
}

}  // namespace throng
