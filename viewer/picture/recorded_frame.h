// RecordedFrame reads the state of a recorded run at the end of one frame from a log.
// Invariant: it reads nothing but the log; a log from another machine gives the same state.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "avatars/mesh/mesh.h"
#include "lcm_io/codec/run_reader.h"
#include "lcm_io/log/log_gaps.h"

namespace throng {

/// Throws InputError if the run has no avatars. `where`: the file or LCM URL of the run.
void require_people(const run_description_t& run, const std::string& where);

/// RecordedFrame holds the run at the end of a frame. Between recorded states the crowd has the
/// latest state before that frame.
class RecordedFrame {
 public:
  /// Reads the log up to the end of frame `number`. Throws InputError if the file is no log or has
  /// no description, too few frames, or no states up to that frame.
  RecordedFrame(const std::filesystem::path& log, int64_t number);

  /// Advances to a later frame. Throws InputError if the log ends before it.
  void advance_to(int64_t number);

  /// Returns sentences about the missing parts of the run; empty: none. Reads to the end: after it,
  /// no other member may be called.
  std::string describe_missing();

  /// Returns the next frame with states, if any. Reads on: after it, only this and
  /// describe_missing() may be called.
  std::optional<int64_t> next_states();

  /// The floor as a flat mesh, made once for all pictures; empty: all of the ground is walkable.
  const Mesh& floor();

  RunReader& run() { return run_; }
  const CrowdState& crowd() const { return run_.state(); }
  const RunReader::Touching& touching() const { return run_.touching(); }

 private:
  std::filesystem::path log_;
  LogReader reader_;
  LogGaps gaps_;
  int64_t last_frame_ = -1;
  RunReader run_;
  std::optional<Mesh> floor_;
};

}  // namespace throng
