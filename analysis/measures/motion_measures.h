// Measures of how people move: accelerations, lines of flow, sway of the head, use of the width.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "analysis/measures/measure_table.h"
#include "analysis/measures/recent_crowd.h"
#include "analysis/measures/speed_and_spacing.h"
#include "crowd/navigation/walkable.h"
#include "scenes/file/scene.h"

namespace throng {

/// How hard people speed up, slow down and turn, over a tenth of a second.
/// Of heads, as a camera sees them with all their sway, and of the body's way apart.
class Accelerations {
 public:
  explicit Accelerations(double sample_s);

  /// Whether samples come about ten times a second; otherwise the table stays empty.
  bool is_measured() const { return is_measured_; }
  /// The moment before the newest.
  void take(const RecentCrowd& crowd);

  MeasureTable table() const;
  /// Of bodies, in m/s2.
  const Histogram& of_bodies() const { return roots_mps2_; }

 private:
  double sample_s_;
  bool is_measured_;
  Histogram heads_mps2_;
  Histogram roots_mps2_;
};

/// The flow over a line: how many people pass it, and how fast one after another.
/// Without a line that somebody chose several are watched, and what is reported is the
/// narrowest of those that the crowd uses.
class FlowLines {
 public:
  /// None: across the narrowest places, and through the middle of the ground.
  FlowLines(const Scene& scene, size_t people, std::optional<Passage> chosen);

  /// The way from the moment before the newest to the newest.
  void take(const RecentCrowd& crowd);

  struct Line {
    Passage across{};
    double width_m = 0;    ///< of it that people can walk on
    uint64_t forward = 0;  ///< to the left of the way from its first end to its second
    uint64_t back = 0;
    double first_s = 0;
    double last_s = 0;
    std::vector<uint8_t> has_just_passed{};  ///< by person: passed, and not far from it since
    std::vector<uint8_t>
        has_passed_beside{};  ///< by person: crossed its straight beyond one of its ends
    /// How many did.
    uint64_t beside() const;
    uint64_t passed() const { return forward + back; }
    /// N - 1 over the time from the first to the last.
    double flow_per_s() const;
  };
  /// The one that counts: narrowest of those passed by a fifth as many as the busiest.
  const Line& used() const;
  MeasureTable table() const;

 private:
  std::vector<Line> lines_;  ///< at least one
  bool is_chosen_;
};

/// How heads sway from side to side as people walk: how far, and how often.
/// The way is the head's own path, smoothed over two seconds; what is left across it is
/// sway, half a wave at a time.
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
  struct PersonSway {
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
  std::vector<PersonSway> people_;
  std::array<Pace, 3> paces_{};
};

/// How the width of the way is used: the time that people spend in each lane of half a metre across
/// the direction in which most of them walk.
/// That direction is found out by watching, so places are kept as a map of the ground.
class WidthUse {
 public:
  static constexpr double kLane_m = 0.5;

  explicit WidthUse(const Scene& scene);

  void take(const Moment& moment, const Velocities& velocities);

  /// Unit; the way most walk, whichever of the two along it more do. X where nobody walked.
  Eigen::Vector2d main_direction() const;
  /// Lanes from the right edge of the area to the left, as one walks.
  MeasureTable table() const;

 private:
  Rectangle ground_;
  std::vector<Eigen::Vector2d> outline_;  ///< corners of the walkable area
  double cell_m_;
  int columns_;
  int rows_;
  std::vector<uint32_t> visits_;
  Eigen::Matrix2d spread_ = Eigen::Matrix2d::Zero();
  Eigen::Vector2d sum_ = Eigen::Vector2d::Zero();
};

}  // namespace throng
