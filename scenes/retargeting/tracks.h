// Tracks plays the retargeted tracks of all people of a recording.
// Invariant: samples lie in a temporary file and only a window per person in memory, which grows
// with people, not with frames.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "base/files/anonymous_file.h"
#include "base/workers.h"
#include "scenes/retargeting/retarget.h"

namespace throng {

struct TrackState {
  bool is_present = false;
  /// Time in seconds until an absent person enters, if at most kExpected_s, else 0. The state is
  /// then extrapolated backwards from the entry at constant velocity.
  double enters_in_s = 0;
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  float heading_rad = 0;
  float ahead_mps = 0;
  Eigen::Vector2f next_mps = Eigen::Vector2f::Zero();
  float phase = 0;  ///< gait phase; NaN: not visible, follows from the distance walked
};

/// Others react to a person this long before it enters.
inline constexpr double kExpected_s = 0.6;

class Tracks {
 public:
  /// Retargets all people: `retarget` returns the samples of a person, at least one. Throws
  /// EnvironmentError.
  Tracks(size_t people, const std::function<std::vector<TrackSample>(size_t person)>& retarget,
         Workers& workers);

  size_t people() const { return cursors_.size(); }

  /// State of a person. Fast if `time_s` does not decrease between calls. Thread-safe for different
  /// people. Allocates nothing. Throws EnvironmentError.
  TrackState at(size_t person, double time_s);

 private:
  static constexpr size_t kWindow = 24;

  /// Window on a person's samples; `from` is the last sample at or before the present.
  struct Cursor {
    int64_t file_sample = 0;
    int64_t count = 0;
    int64_t loaded = -1;
    int64_t from = 0;
  };
  const TrackSample& sample(size_t person, int64_t index);
  void load(size_t person, int64_t index);

  AnonymousFile file_;
  std::vector<Cursor> cursors_;
  std::vector<std::array<TrackSample, kWindow>> windows_;
};

}  // namespace throng
