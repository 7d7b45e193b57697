// Writes how far people and robots stay apart: tables and a figure.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/figure.h"
#include "base/files/atomic_file.h"
#include "scenes/run/sink.h"
#include "scenes/separation/separation_monitor.h"

namespace throng {

/// The figure of a run's separation: how near a robot came to each region, and what was required.
/// Memory does not grow with the run; each point is the frame of its stretch that came
/// nearest.
class SeparationHistory {
 public:
  /// A run of so many frames at most, as far as it is known.
  SeparationHistory(const RunInfo& run, int64_t frames);

  void add(int64_t frame, std::span<const RegionSeparation> rows);

  /// Of the robot that was too near for the longest time, or else came nearest; the regions that
  /// people have. False: no robot came within the margin.
  bool has_figure() const;
  Figure figure(const RunInfo& run, const SeparationTotals& totals) const;

 private:
  struct Point {
    float lo_m = RegionSeparation::kFar;
    float required_m = RegionSeparation::kUnknown;
    bool is_short = false;
  };
  static constexpr int64_t kPoints = 600;
  struct Robot {
    uint64_t short_frames = 0;  ///< of all regions together
    float min_distance_m = RegionSeparation::kFar;
    std::array<std::vector<Point>, kBodyRegions> regions;  ///< by stretch; empty: always far
  };

  size_t worst() const;

  double step_s_;
  float proximity_m_;
  int64_t frames_per_point_;  ///< frames
  size_t points_ = 0;
  int64_t first_frame_ = -1;
  std::vector<int32_t> index_;  ///< by avatar, into robots_; -1: not yet
  std::vector<std::unique_ptr<Robot>> robots_;
  std::vector<uint32_t> ids_;
};

/// Writes how near robots came to which region of people: CSV files, and a figure where gnuplot is
/// there.
/// Rows are written as the run goes; the figure at its end.
class SeparationSink final : public Sink {
 public:
  /// Of a run of a scene with this rule. Creates the folder; begin() replaces the files in it.
  /// Empty: only the totals are of interest. Throws EnvironmentError, here and in all calls, if
  /// something cannot be written.
  SeparationSink(std::filesystem::path folder, const SeparationRule& rule);

  SinkNeeds needs() const override { return {.postures = is_measured_}; }
  void begin(const RunInfo& run) override;
  void frame(const RunInfo& run, const Frame& frame) override;
  void end(const RunInfo& run, const RunEnd& end) override;

  /// Null before begin().
  const SeparationTotals* totals() const { return monitor_ ? &monitor_->totals() : nullptr; }
  const std::filesystem::path& folder() const { return folder_; }
  /// Why there is no figure, or "".
  const std::string& note() const { return note_; }

 private:
  void list_ended(const RunInfo& run);
  void draw_figure(const RunInfo& run);

  std::filesystem::path folder_;
  bool is_measured_;
  std::unique_ptr<OutputFile> rows_, shortfalls_;
  std::unique_ptr<SeparationMonitor> monitor_;
  std::unique_ptr<SeparationHistory> history_;
  std::string text_, note_;
};

/// The names of all files that it writes into the folder.
std::vector<std::string> separation_files();

}  // namespace throng
