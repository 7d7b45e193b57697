// What is odd about tracks: counted, and the first of each kind named.
// One rule: nothing is mended and nothing refused here; whoever asked for --strict refuses.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "recordings/recorded_samples.h"
#include "recordings/recording.h"

namespace throng {

class WalkableArea;

/// Words for an instant of the recording: "frame 112", "12.48 s".
using InstantName = std::function<std::string(double time_s)>;

class TrackCheck {
 public:
  /// `fps`: of the recorded frames, 0 for events. `area`: null if the file has none.
  TrackCheck(double fps, const WalkableArea* area, InstantName name)
      : fps_(fps), area_(area), name_(std::move(name)) {}

  /// A person's samples in ascending order of time.
  void take(int64_t id, std::span<const Sample> samples, const Duplicates& duplicates);
  /// What was found so far, the gravest first.
  std::vector<Oddity> found() const;

 private:
  enum Kind { kJump, kFast, kReturn, kHole, kTwice, kOutside, kOnce, kKinds };
  struct Count {
    int64_t count = 0;
    std::string first;
  };

  void step(int64_t id, const Sample& from, const Sample& to, double usual_s);
  double usual_interval_s(std::span<const Sample> samples);
  /// Counts; true if it was the first, which then wants words.
  bool is_first(Kind kind, int64_t times = 1) {
    counts_[kind].count += times;
    return counts_[kind].count == times;
  }

  double fps_;
  const WalkableArea* area_;
  InstantName name_;
  std::array<Count, kKinds> counts_;
  std::vector<double> gaps_s_;
};

}  // namespace throng
