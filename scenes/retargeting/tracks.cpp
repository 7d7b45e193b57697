#include "scenes/retargeting/tracks.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "base/elementary.h"

namespace throng {
namespace {

float between(float from, float to, double u) {
  return static_cast<float>(std::lerp(static_cast<double>(from), static_cast<double>(to), u));
}

/// The shorter way round; NaN stays NaN.
float phase_between(float from, float to, double u) {
  const float turn = std::remainder(to - from, 1.0f);
  return phase_of(between(from, from + turn, u));
}

TrackNow at_knot(const Knot& knot) {
  return {true,
          0,
          {knot.x_m, knot.y_m},
          knot.heading_rad,
          knot.ahead_mps,
          {knot.next_x_mps, knot.next_y_mps},
          knot.phase};
}

/// Of somebody who is away, by the knot that it comes in at.
TrackNow before_coming_in(const Knot& first, double time_s) {
  const double left_s = first.time_s - time_s;
  if (left_s > kExpected_s) return {};
  TrackNow now = at_knot(first);
  now.is_present = false;
  now.comes_in_s = left_s;
  now.position_m -= left_s * now.next_mps.cast<double>();
  return now;
}

}  // namespace

Tracks::Tracks(size_t people, const std::function<std::vector<Knot>(size_t person)>& dress,
               Workers& workers)
    : cursors_(people), windows_(people) {
  std::atomic<int64_t> end{0};
  workers.for_blocks(static_cast<int>(people), [&](int block, int) {
    const auto person = static_cast<size_t>(block);
    const std::vector<Knot> knots = dress(person);
    Cursor& cursor = cursors_[person];
    cursor.count = static_cast<int64_t>(knots.size());
    cursor.file_knot = end.fetch_add(cursor.count);
    file_.write(cursor.file_knot * static_cast<int64_t>(sizeof(Knot)),
                std::as_bytes(std::span(knots)));
  });
}

void Tracks::load(size_t person, int64_t index) {
  Cursor& cursor = cursors_[person];
  // One before for the curve; the rest is ahead, where time goes.
  cursor.loaded = std::max<int64_t>(index - 1, 0);
  const int64_t count = std::min<int64_t>(cursor.count - cursor.loaded, kWindow);
  const std::span<Knot> room(windows_[person].data(), static_cast<size_t>(count));
  file_.read((cursor.file_knot + cursor.loaded) * static_cast<int64_t>(sizeof(Knot)),
             std::as_writable_bytes(room));
}

const Knot& Tracks::knot(size_t person, int64_t index) {
  return windows_[person][static_cast<size_t>(index - cursors_[person].loaded)];
}

TrackNow Tracks::at(size_t person, double time_s) {
  Cursor& cursor = cursors_[person];
  const auto has = [&](int64_t index) {
    return cursor.loaded >= 0 && index >= cursor.loaded &&
           index < cursor.loaded + static_cast<int64_t>(kWindow);
  };
  const auto need = [&](int64_t index) {
    if (!has(index)) load(person, cursor.from);
  };
  need(cursor.from);
  if (knot(person, cursor.from).time_s > time_s + kSame_s) {
    cursor.from = 0;  // back in time, as in a run that is resumed: from the start again
    need(0);
    const Knot& first = knot(person, 0);
    if (first.time_s > time_s + kSame_s) return before_coming_in(first, time_s);
  }
  while (cursor.from + 1 < cursor.count) {
    need(cursor.from + 1);
    if (knot(person, cursor.from + 1).time_s > time_s + kSame_s) break;
    ++cursor.from;
  }
  const int64_t from = cursor.from;
  const int64_t last = std::min(from + 2, cursor.count - 1);
  need(std::max<int64_t>(from - 1, 0));
  need(last);
  const Knot& here = knot(person, from);
  TrackNow now = at_knot(here);
  if (time_s <= here.time_s + kSame_s || here.next == Knot::Next::kJump) return now;
  if (here.next == Knot::Next::kAway)
    return from + 1 < cursor.count ? before_coming_in(knot(person, from + 1), time_s) : TrackNow{};
  const Knot& next = knot(person, from + 1);
  const Knot* before = nullptr;
  if (from > 0 && knot(person, from - 1).next == Knot::Next::kWay) before = &knot(person, from - 1);
  const Knot* after = nullptr;
  if (from + 2 < cursor.count && next.next == Knot::Next::kWay) after = &knot(person, from + 2);
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
