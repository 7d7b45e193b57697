// Motion measures: accelerations, flow over lines, sway of heads and use of the width.
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

/// Accelerations over 0.1 s in any direction. Heads, as cameras see them with their sway, and roots
/// are measured separately.
class Accelerations {
 public:
  explicit Accelerations(double sample_s);

  /// True if samples are about 0.1 s apart; otherwise the table stays empty.
  bool is_measured() const { return is_measured_; }
  /// Measures the second newest moment.
  void take(const RecentCrowd& crowd);

  MeasureTable table() const;
  /// Accelerations of roots, in m/s2.
  const Histogram& of_bodies() const { return roots_mps2_; }

 private:
  double sample_s_;
  bool is_measured_;
  Histogram heads_mps2_;
  Histogram roots_mps2_;
};

/// Flow over a line: number of people who pass it, and passages per second.
/// Without a chosen line, several lines are watched and the narrowest one in use is reported.
class FlowLines {
 public:
  /// `chosen`: the line; none: lines across the narrowest gaps and through the centre of the
  /// ground.
  FlowLines(const Scene& scene, size_t people, std::optional<Passage> chosen);

  /// Counts passages from the second newest moment to the newest.
  void take(const RecentCrowd& crowd);

  struct Line {
    Passage across{};
    double width_m = 0;    ///< walkable length of the line
    uint64_t forward = 0;  ///< passages to the left, seen from the first end to the second
    uint64_t back = 0;
    double first_s = 0;
    double last_s = 0;
    /// Indexed by person: passed, and not yet kLeft_m away.
    std::vector<uint8_t> has_just_passed{};
    /// Indexed by person: crossed beyond an end of the line.
    std::vector<uint8_t> has_passed_outside{};
    /// Number of people in has_passed_outside.
    uint64_t passed_outside() const;
    uint64_t passed() const { return forward + back; }
    /// (N - 1) over the time from the first to the last passage.
    double flow_per_s() const;
  };
  /// The reported line: the narrowest with at least a fifth of the passages of the busiest one.
  const Line& used() const;
  MeasureTable table() const;

 private:
  std::vector<Line> lines_;  ///< at least one
  bool is_chosen_;
};

/// Lateral sway of walking heads: amplitude and frequency.
/// Sway is the deviation of the head from its path smoothed over 2 s, measured in half waves.
class HeadSway {
 public:
  HeadSway(size_t people, double sample_s);

  /// Number of moments before and after the measured one; 0: samples are too rare to measure sway.
  static size_t half_window(double sample_s);
  /// Measures the moment half_window() ago.
  void take(const RecentCrowd& crowd);

  MeasureTable table() const;

 private:
  /// State of a person whose sway is followed.
  struct Wave {
    double level_m = 0;    ///< mean deviation: the smoothed path cuts corners
    int followed = 0;      ///< number of moments since the person began to walk
    double last_m = 0;     ///< deviation from the level at the previous moment
    double extreme_m = 0;  ///< largest deviation since the last crossing
    double since_s = 0;    ///< time of the last crossing
    double speed_mps = 0;  ///< sum over the moments of the half wave
    int moments = 0;       ///< number of moments in the half wave
    bool has_crossed = false;
  };
  struct PersonSway {
    double amplitude_m = 0;  ///< sum over half waves
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

/// Use of the width: time of people in lanes of 0.5 m across the main walking direction.
/// Memory: a map of visits, because the main direction is known only at the end.
class WidthUse {
 public:
  static constexpr double kLane_m = 0.5;

  explicit WidthUse(const Scene& scene);

  void take(const Moment& moment, const Velocities& velocities);

  /// Unit vector of the main walking axis, in its more frequent sense; X if no person walked.
  Eigen::Vector2d main_direction() const;
  /// Shares of the lanes, from the right edge of the area to the left in walking direction.
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
