// Monitor summarises the followed run of an Inbox: rates, stage counters, newest contacts, parts.
// Invariant: the cost of a message is proportional to its length, and memory is bounded.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <vector>

#include "lcm_io/wire/inbox.h"
#include "scenes/run/stages.h"

namespace throng {

class Monitor {
 public:
  explicit Monitor(const Inbox& inbox) : inbox_(inbox) {}

  /// Call after inbox.take(), with its result. now_s: seconds of a monotonic clock for a live run,
  /// the stamps of a log.
  void take(RunReader::Update update, double now_s);

  /// Sums over the received messages of the run; stages in the order of scenes/run/stages.h.
  struct Totals {
    double now_s = 0;
    int64_t frames = 0;
    std::array<int64_t, kChannelCount> messages{};
    std::array<int64_t, kChannelCount> bytes{};
    std::array<int64_t, kCullingStageCount> updates{};
    std::array<int64_t, kCullingStageCount> tests{};
    std::array<int64_t, kCullingStageCount> passed{};
    std::array<double, kCullingStageCount> update_ns{};
    std::array<double, kCullingStageCount> test_ns{};
    double other_ns = 0;  ///< posing and events
    int64_t begins = 0;
    int64_t ends = 0;
  };
  /// Returns the totals since the run was first received.
  Totals overall(double now_s) const;
  /// Returns the totals of about the last two seconds.
  Totals recent(double now_s) const;
  static constexpr double kRecent_s = 2;

  struct Note {
    PairKey pair;
    EventKind kind = EventKind::kBegin;
    PairLevel level = PairLevel::kSphere;
    int64_t utime_us = 0;
    double lasted_s = -1;  ///< for an end; below 0 if its begin was not received
  };
  /// The newest is last.
  const std::deque<Note>& notes() const { return notes_; }
  static constexpr size_t kNotes = 4096;

  /// Totals of all parts with one name, over all models.
  struct PartTotal {
    std::string name;  ///< including "obstacle" and "whole body"
    int64_t begins = 0;
    int64_t touching = 0;
    double contact_s = 0;
  };
  /// Sorted by begins, descending.
  std::vector<PartTotal> parts() const;

  struct FrameTime {
    double last_ms = 0;
    double median_ms = 0;  ///< over the last kFrameTimes frames
  };
  FrameTime frame_time() const;
  static constexpr size_t kFrameTimes = 240;

 private:
  void begin_run(double now_s);
  void name_parts();
  size_t part_of(uint32_t body, uint32_t part) const;
  void take_events();
  void take_frame_stats();
  void drop_unseen_ends();
  Totals now(double now_s) const;

  const Inbox& inbox_;
  int64_t run_id_ = 0;
  int64_t instance_ = 0;
  bool has_run_ = false;
  Totals first_, sums_;
  std::deque<Totals> history_;  // every quarter of a second, for kRecent_s
  std::deque<Note> notes_;
  std::map<PairKey, int64_t> began_us_;
  std::vector<PartTotal> parts_;            // 0 obstacle, 1 whole body, then by name
  std::vector<std::vector<size_t>> names_;  // by model and part, index into parts_
  std::deque<float> frame_ms_;
};

}  // namespace throng
