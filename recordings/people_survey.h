// The people of a recording, once all of their samples are known: when they are there, how tall
// they are, where all of them were.
// One rule: it sees everybody once, in ascending order of ids, and keeps nothing of their samples.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "base/hasher.h"
#include "recordings/recording.h"

namespace throng {

class PeopleSurvey {
 public:
  /// At least one sample, in ascending order of time.
  void take(int64_t id, std::span<const Sample> samples);
  /// The people, and what they add to the facts. Call it once.
  std::vector<RecordedPerson> finish(RecordingFacts& facts);
  /// Of everything that shapes a run, after finish().
  uint64_t hash() const { return hash_.value(); }

 private:
  std::optional<double> height_of(std::span<const Sample> samples);
  void judge_heights(RecordingFacts& facts);

  std::vector<RecordedPerson> people_;
  int64_t samples_ = 0;
  double duration_s_ = 0;
  Rectangle bounds_;
  double least_z_m_ = std::numeric_limits<double>::infinity();
  double most_z_m_ = -std::numeric_limits<double>::infinity();
  std::vector<float> heights_m_;  ///< of the person at hand
  Hasher hash_;
};

}  // namespace throng
