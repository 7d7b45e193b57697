// What touched whom and when: the begins and ends that a feed has seen, for asking about a person.
// One rule: bounded; the oldest go first, and how many went is reported.
#pragma once

#include <cstdint>
#include <deque>
#include <mutex>
#include <string>
#include <vector>

#include "lcmtypes/codec/run_reader.h"

namespace throng {

class PairHistory {
 public:
  explicit PairHistory(size_t capacity = size_t{2} << 20) : capacity_(capacity) {}

  /// From one thread; asked from any.
  void add(int64_t frame, std::span<const PairEvent> events);
  void clear();

  /// The newest `most` pairs of a body that began at or before `frame`, newest first, as JSON:
  /// {"history": id, "pairs": [[begin, end or -1, a, b, part_a, part_b], ...], "forgotten": n}
  std::string of(uint32_t body, int64_t frame, size_t most) const;

 private:
  struct Entry {
    int64_t frame;
    PairEvent event;
  };
  size_t capacity_;
  mutable std::mutex mutex_;
  std::deque<Entry> entries_;
  uint64_t forgotten_ = 0;
};

}  // namespace throng
