// What somebody who watches a run wants to know: rates, stage counters, newest contacts, parts.
// One rule: it follows the run that the inbox follows, and a message costs it little more than its
// length; nothing is kept that could grow without end.
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
  /// Keeps a reference.
  explicit Monitor(const Inbox& inbox) : inbox_(inbox) {}

  /// After inbox.take() said `update`. now_s: seconds of any clock that runs forward: the wall's
  /// for a live run, the log's stamps for a log.
  void take(RunReader::Update update, double now_s);

  /// Sums over what was heard of the run; the stages in the order of scenes/run/stages.h.
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
  /// Since the run was first heard.
  Totals overall(double now_s) const;
  /// The last two seconds or so.
  Totals recent(double now_s) const;
  static constexpr double kRecent_s = 2;

  /// A pair that began or ended.
  struct Note {
    PairKey pair;
    EventKind kind = EventKind::kBegin;
    PairLevel level = PairLevel::kSphere;
    int64_t utime_us = 0;
    double lasted_s = -1;  ///< of an end; below 0 if its begin was not heard
  };
  /// The newest last.
  const std::deque<Note>& notes() const { return notes_; }
  static constexpr size_t kNotes = 64;

  /// All parts of one name, over all models.
  struct PartTotal {
    std::string name;  ///< "obstacle" and "whole body" are two of them
    int64_t begins = 0;
    int64_t touching = 0;
    double contact_s = 0;  ///< of the contacts that ended
  };
  /// The part with the most begins first.
  std::vector<PartTotal> parts() const;

  struct FrameTime {
    double last_ms = 0;
    double median_ms = 0;  ///< of the last kFrameTimes frames
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
  std::deque<Totals> history_;  // a quarter of a second apart, kRecent_s long
  std::deque<Note> notes_;
  std::map<PairKey, int64_t> began_us_;
  std::vector<PartTotal> parts_;            // 0 obstacle, 1 whole body, then by name
  std::vector<std::vector<size_t>> names_;  // by model and part, into parts_
  std::deque<float> frame_ms_;
};

}  // namespace throng
