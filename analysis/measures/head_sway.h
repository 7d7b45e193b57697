// How heads sway from side to side as people walk: how far, and how often.
// One rule: the way is the head's own path, smoothed over two seconds; what is left across it is
// sway, half a wave at a time.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "analysis/measures/histogram.h"
#include "analysis/measures/measure_table.h"
#include "analysis/measures/recent_crowd.h"

namespace throng {

class HeadSway {
 public:
  HeadSway(size_t people, double sample_s);

  /// Moments before and after the one that is looked at; 0: samples are too rare to see sway.
  static size_t half_window(double sample_s);
  /// The moment half_window() ago.
  void take(const RecentCrowd& crowd);

  MeasureTable table() const;

 private:
  /// A person who is followed.
  struct Wave {
    double level_m = 0;    ///< what sways is so far off the smoothed path: it cuts corners
    int followed = 0;      ///< moments since somebody began to walk
    double last_m = 0;     ///< off that level, at the moment before
    double extreme_m = 0;  ///< the largest since the last crossing
    double since_s = 0;    ///< the last crossing
    double speed_mps = 0;  ///< summed over the moments of the half wave
    int moments = 0;       ///< of the half wave
    bool has_crossed = false;
  };
  struct Person {
    double amplitude_m = 0;  ///< summed over half waves
    uint32_t half_waves = 0;
  };
  struct Pace {
    double half_waves = 0;
    double time_s = 0;
  };
  static constexpr std::array<double, 4> kSpeeds_mps = {0.3, 0.8, 1.2, 1.7};

  void follow(size_t person, double across_m, double speed_mps, double time_s);
  void finish_half_wave(size_t person, const Wave& wave, double crossing_s);

  size_t half_;
  double sample_s_;
  std::vector<Wave> waves_;
  std::vector<Person> people_;
  std::array<Pace, 3> paces_{};
};

}  // namespace throng
