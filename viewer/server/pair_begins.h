// PairBegins follows since when each pair touches, as far as the messages of its run say.
// Invariant: a begin that was not heard has no frame, only one before which it lies.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "lcm_io/codec/run_reader.h"

namespace throng {

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
  void doubt(int64_t frame);
  void match(const RunReader::Touching& touching, int64_t frame);

  Begins begins_;
  std::vector<Change> changes_;
  int64_t missing_ = 0;
  int64_t run_id_ = 0, instance_ = 0;
  bool has_run_ = false;
};

}  // namespace throng
