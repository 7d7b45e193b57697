// PairHistory keeps what touched whom and when: the begins and ends that a feed has seen, for
// asking about a person. It is bounded: the oldest go first, and how many went is reported.
#pragma once

#include <cstdint>
#include <deque>
#include <mutex>
#include <string>

#include "viewer/server/pair_begins.h"

namespace throng {

class PairHistory {
 public:
  explicit PairHistory(size_t capacity = size_t{2} << 20) : capacity_(capacity) {}

  /// From one thread; asked from any.
  void add(std::span<const PairBegins::Change> changes);
  void clear();

  /// The newest `max` pairs of a body that began at or before `frame`, newest first, as JSON:
  /// {"history": id, "frame": frame, "forgotten": n,
  ///  "pairs": [[BeginFrame, end or -1, a, b, part_a, part_b], ...]}.
  std::string of(uint32_t body, int64_t frame, size_t max) const;

  /// Since when each of these pairs touches at `frame`.
  PairBegins::Begins begins_at(int64_t frame, const RunReader::Touching& touching) const;

 private:
  size_t capacity_;
  mutable std::mutex mutex_;
  std::deque<PairBegins::Change> entries_;
  uint64_t forgotten_ = 0;
  int64_t known_from_ = 0;  ///< of frames from here on nothing was forgotten
};

}  // namespace throng
