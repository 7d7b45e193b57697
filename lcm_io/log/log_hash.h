// The hash of the events in a log, by every definition that a log may have been written under.
// One rule: a definition that was ever written stays readable.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "culling/event_hash.h"

namespace throng {

class LogHash {
 public:
  /// Events in the order of the log; those of a frame may come in pieces.
  void add(int64_t frame, std::span<const PairEvent> events);

  /// Goes on behind another hash, unless frames have been chained already.
  void start_from(uint64_t hash);
  /// Of all events so far. `kind` is known (see is_known()).
  uint64_t value(EventHashKind kind);
  /// What went wrong is known and reported: from here on as if the hash had been this.
  void go_on_from(EventHashKind kind, uint64_t hash);
  static bool is_known(int32_t kind);

  /// Whether this is the hash that Throng wrote before there were checks: FNV-1a over frame, pair
  /// and kind, under a deadline also the level, event after event.
  bool is_old_hash(uint64_t hash) const;

 private:
  struct Way {
    EventSum frame;  // of frame_
    EventHash hash;
    uint64_t old_hash = 0xcbf29ce484222325ull;
  };
  void finish_frame();

  std::array<Way, 2> ways_;  // without levels, with levels
  int64_t frame_ = 0;
  bool is_chained_ = false;
  bool is_empty_ = true;
};

}  // namespace throng
