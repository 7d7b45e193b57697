// What touched whom and when: since when each pair touches, and what a feed has seen before.
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

// PairBegins follows since when each pair touches, as far as the messages of its run say.
// Invariant: a begin that was not heard has no frame, only one before which it lies.

/// The frame of a begin; where it was not heard, ~F: the pair began before frame F.
using BeginFrame = int64_t;
constexpr BeginFrame began_before(int64_t frame) { return ~(frame > 0 ? frame : 0); }

class PairBegins {
 public:
  enum class ChangeKind : uint8_t {
    kBegan,
    kEnded,
    kLost  ///< messages are missing: whether and when the contact ended was not heard
  };
  struct Change {
    PairKey pair;
    ChangeKind kind;
    int64_t frame;  ///< from which on it holds
    BeginFrame began;
  };
  using Begins = std::map<PairKey, BeginFrame>;

  /// After run.take() returned `update`. Returns whether another run began: then all was forgotten.
  bool take(const RunReader& run, RunReader::Update update);

  /// What the last take() changed.
  std::span<const Change> changes() const { return changes_; }
  /// By pair that touches, in the order of RunReader::touching().
  const Begins& all() const { return begins_; }

  /// Continues from what is known from elsewhere: a player of `run` has jumped.
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

/// PairHistory keeps what touched whom and when: the begins and ends that a feed has seen, for
/// asking about a person. It is bounded: the oldest go first, and how many went is reported.
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
