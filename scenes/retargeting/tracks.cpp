#include "scenes/retargeting/tracks.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "base/portable_math.h"

namespace throng {
namespace {

float between(float from, float to, double u) {
  return static_cast<float>(std::lerp(static_cast<double>(from), static_cast<double>(to), u));
}

/// Interpolates the shorter way round the cycle; NaN stays NaN.
float phase_between(float from, float to, double u) {
  const float turn = std::remainder(to - from, 1.0f);
  return phase_of(between(from, from + turn, u));
}

TrackState state_at(const TrackSample& sample) {
  return {true,
          0,
          {sample.x_m, sample.y_m},
          sample.heading_rad,
          sample.ahead_mps,
          {sample.next_x_mps, sample.next_y_mps},
          sample.phase};
}

TrackState before_entry(const TrackSample& first, double time_s) {
  const double left_s = first.time_s - time_s;
  if (left_s > kExpected_s) return {};
  TrackState now = state_at(first);
  now.is_present = false;
  now.enters_in_s = left_s;
  now.position_m -= left_s * now.next_mps.cast<double>();
  return now;
}

}  // namespace

Tracks::Tracks(size_t people,
               const std::function<std::vector<TrackSample>(size_t person)>& retarget,
               Workers& workers)
    : cursors_(people), windows_(people) {
  std::atomic<int64_t> end{0};
  workers.for_blocks(static_cast<int>(people), [&](int block, int) {
    const auto person = static_cast<size_t>(block);
    const std::vector<TrackSample> samples = retarget(person);
    Cursor& cursor = cursors_[person];
    cursor.count = static_cast<int64_t>(samples.size());
    cursor.file_sample = end.fetch_add(cursor.count);
    file_.write(cursor.file_sample * static_cast<int64_t>(sizeof(TrackSample)),
                std::as_bytes(std::span(samples)));
  });
}

void Tracks::load(size_t person, int64_t index) {
  Cursor& cursor = cursors_[person];
  // One sample before, for the curve; the others lie ahead.
  cursor.loaded = std::max<int64_t>(index - 1, 0);
  const int64_t count = std::min<int64_t>(cursor.count - cursor.loaded, kWindow);
  const std::span<TrackSample> window(windows_[person].data(), static_cast<size_t>(count));
  file_.read((cursor.file_sample + cursor.loaded) * static_cast<int64_t>(sizeof(TrackSample)),
             std::as_writable_bytes(window));
}

const TrackSample& Tracks::sample(size_t person, int64_t index) {
  return windows_[person][static_cast<size_t>(index - cursors_[person].loaded)];
}

TrackState Tracks::at(size_t person, double time_s) {
  Cursor& cursor = cursors_[person];
  const auto has = [&](int64_t index) {
    return cursor.loaded >= 0 && index >= cursor.loaded &&
           index < cursor.loaded + static_cast<int64_t>(kWindow);
  };
  const auto need = [&](int64_t index) {
    if (!has(index)) load(person, cursor.from);
  };
  need(cursor.from);
  if (sample(person, cursor.from).time_s > time_s + kTimeTolerance_s) {
    cursor.from = 0;  // time went back, as after a resume: search from the start
    need(0);
    const TrackSample& first = sample(person, 0);
    if (first.time_s > time_s + kTimeTolerance_s) return before_entry(first, time_s);
  }
  while (cursor.from + 1 < cursor.count) {
    need(cursor.from + 1);
    if (sample(person, cursor.from + 1).time_s > time_s + kTimeTolerance_s) break;
    ++cursor.from;
  }
  const int64_t from = cursor.from;
  const int64_t last = std::min(from + 2, cursor.count - 1);
  need(std::max<int64_t>(from - 1, 0));
  need(last);
  const TrackSample& here = sample(person, from);
  TrackState now = state_at(here);
  if (time_s <= here.time_s + kTimeTolerance_s || here.next == TrackSample::Next::kJump) return now;
  if (here.next == TrackSample::Next::kAbsent)
    return from + 1 < cursor.count ? before_entry(sample(person, from + 1), time_s) : TrackState{};
  const TrackSample& next = sample(person, from + 1);
  const TrackSample* before = nullptr;
  if (from > 0 && sample(person, from - 1).next == TrackSample::Next::kMove)
    before = &sample(person, from - 1);
  const TrackSample* after = nullptr;
  if (from + 2 < cursor.count && next.next == TrackSample::Next::kMove)
    after = &sample(person, from + 2);
  const double u = (time_s - here.time_s) / (next.time_s - here.time_s);
  now.position_m = position_between(before, here, next, after, time_s);
  now.heading_rad = between(here.heading_rad, next.heading_rad, u);
  now.ahead_mps = between(here.ahead_mps, next.ahead_mps, u);
  now.next_mps = {between(here.next_x_mps, next.next_x_mps, u),
                  between(here.next_y_mps, next.next_y_mps, u)};
  now.phase = phase_between(here.phase, next.phase, u);
  return now;
}

}  // namespace throng
