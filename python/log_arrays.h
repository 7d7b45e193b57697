// A log as arrays: the events, places and counters of its first run.
// One rule: what a message cannot be believed is left out, and how much was left out is known;
// `throng check` judges logs.
#pragma once

#include <atomic>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "python/interrupts.h"
#include "python/recorder.h"

namespace throng {

struct LogArrays {
  RunFacts facts;
  std::vector<EventRow> events;
  std::vector<PlaceRow> places;
  std::vector<FrameRow> frames;
  int64_t end_frame = 0;  ///< where the run is over, as far as the log goes
  bool finished = false;  ///< the run said that it was
  std::string hash;       ///< of its end; "" where it is cut off
  int64_t left_out = 0;   ///< messages that were damaged
  /// What is missing or altered before the log ends, a sentence each.
  std::vector<std::string> damage;
};

/// Throws InputError where the file is no log, or says of no run. `fps`: see places_every();
/// without, every state that there is.
LogArrays read_log(const std::filesystem::path& file, std::optional<double> fps, bool places,
                   WorkSigns& signs);

}  // namespace throng
