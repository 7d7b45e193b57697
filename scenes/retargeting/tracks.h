// The dressed ways of all people of a recording, played in time.
// One rule: knots lie in a temporary file, person by person, and of each person only those around
// now are in memory: it grows with the people, never with the frames.
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

/// Where somebody is now.
struct TrackState {
  bool is_present = false;
  /// It is not there yet, but will be in so long, which is not above kExpected_s: then this is
  /// where it would be if it came straight and as fast as it comes in. 0: it is there, or away.
  double enters_in_s = 0;
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  ///< of what was tracked
  float heading_rad = 0;
  float ahead_mps = 0;
  Eigen::Vector2f next_mps = Eigen::Vector2f::Zero();  ///< see BodyStates::next_mps
  float phase = 0;  ///< of the gait; NaN: as the distance walked has it
};

/// So long before somebody comes in, others reckon with it.
inline constexpr double kExpected_s = 0.6;

class Tracks {
 public:
  /// Dresses everybody: `dress` gives the knots of a person, at least one. Throws EnvironmentError.
  Tracks(size_t people, const std::function<std::vector<TrackSample>(size_t person)>& retarget,
         Workers& workers);

  size_t people() const { return cursors_.size(); }

  /// Where a person is. Quick if `time_s` does not go back from call to call; of several people
  /// from several threads. Allocates nothing. Throws EnvironmentError.
  TrackState at(size_t person, double time_s);

 private:
  static constexpr size_t kWindow = 24;  ///< knots of a person in memory: a second

  /// The window on a person's knots: `from` is the last at or before now.
  struct Cursor {
    int64_t file_sample = 0;  ///< of the first of the person
    int64_t count = 0;
    int64_t loaded = -1;  ///< which of the person's is the first of the window
    int64_t from = 0;
  };
  const TrackSample& sample(size_t person, int64_t index);
  void load(size_t person, int64_t index);

  AnonymousFile file_;
  std::vector<Cursor> cursors_;
  std::vector<std::array<TrackSample, kWindow>> windows_;
};

}  // namespace throng
