// PairBegins tracks since when each pair touches; PairHistory stores past contacts.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "lcm_io/codec/run_reader.h"

namespace throng {

// Invariant of PairBegins: a begin that was not received has no frame, only an upper bound.

/// The frame of a begin; if the begin was not received, ~F: the pair began before frame F.
using BeginFrame = int64_t;
constexpr BeginFrame began_before(int64_t frame) { return ~(frame > 0 ? frame : 0); }

class PairBegins {
 public:
  enum class ChangeKind : uint8_t {
    kBegan,
    kEnded,
    kLost  ///< messages are missing: it is unknown whether and when the contact ended
  };
  struct Change {
    PairKey pair;
    ChangeKind kind;
    int64_t frame;  ///< first frame in which it holds
    BeginFrame began;
  };
  using Begins = std::map<PairKey, BeginFrame>;

  /// Call after run.take() returned `update`. Returns whether a new run began, which clears all.
  bool take(const RunReader& run, RunReader::Update update);

  std::span<const Change> changes() const { return changes_; }
  /// Begin frames of the touching pairs, in the order of RunReader::touching().
  const Begins& all() const { return begins_; }

  /// Replaces the begins, after a player of `run` has jumped.
  void set(Begins begins, const RunReader& run);

 private:
  void begin(PairKey pair, int64_t frame, BeginFrame began);
  void mark_lost(int64_t frame);
  void match(const RunReader::Touching& touching, int64_t frame);

  Begins begins_;
  std::vector<Change> changes_;
  int64_t missing_ = 0;
  int64_t run_id_ = 0, instance_ = 0;
  bool has_run_ = false;
};

/// PairHistory stores the begins and ends of contacts for queries about a person. Its size is
/// bounded: the oldest entries are discarded and counted.
class PairHistory {
 public:
  explicit PairHistory(size_t capacity = size_t{2} << 20) : capacity_(capacity) {}

  /// Call from one thread; of() and begins_at() are thread-safe.
  void add(std::span<const PairBegins::Change> changes);
  void clear();

  /// Returns the newest `max` pairs of a body that began at or before `frame`, newest first:
  /// {"history": id, "frame": frame, "discarded": n,
  ///  "pairs": [[BeginFrame, end or -1, a, b, part_a, part_b], ...]}.
  std::string of(uint32_t body, int64_t frame, size_t max) const;

  /// Returns the begin frames of pairs that touch at `frame`.
  PairBegins::Begins begins_at(int64_t frame, const RunReader::Touching& touching) const;

 private:
  size_t capacity_;
  mutable std::mutex mutex_;
  std::deque<PairBegins::Change> entries_;
  uint64_t discarded_ = 0;
  int64_t known_from_ = 0;  ///< nothing was discarded from this frame on
};

}  // namespace throng
