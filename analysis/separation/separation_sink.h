// SeparationSink writes the distances between robots and people as tables and a figure.
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

/// Collects the separation of a run for its figure: distance and required distance by region.
/// Memory does not grow with the run: each point keeps the frame with the least distance of a
/// segment of the run.
class SeparationHistory {
 public:
  /// `frames`: expected maximum number of frames.
  SeparationHistory(const RunInfo& run, int64_t frames);

  void add(int64_t frame, std::span<const RegionSeparation> rows);

  /// The figure shows the robot that was too close for the longest time, or else came closest, and
  /// the regions that people have. False: no robot came within the margin.
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
    uint64_t short_frames = 0;  ///< sum over all regions
    float min_distance_m = RegionSeparation::kFar;
    /// Indexed by region, then segment; empty: always far.
    std::array<std::vector<Point>, kBodyRegions> regions;
  };

  size_t worst() const;

  double step_s_;
  float proximity_m_;
  int64_t frames_per_point_;  ///< length of a segment
  size_t points_ = 0;
  int64_t first_frame_ = -1;
  std::vector<int32_t> index_;  ///< index into robots_, by avatar; -1: none
  std::vector<std::unique_ptr<Robot>> robots_;
  std::vector<uint32_t> ids_;
};

/// Writes how close robots came to each region of people: CSV files, and a figure if gnuplot is
/// installed. Rows are written during the run, the figure at its end.
class SeparationSink final : public Sink {
 public:
  /// Creates the folder; begin() replaces the files in it. An empty folder writes no files and only
  /// computes the totals. Throws EnvironmentError, also in all other calls, if a file cannot be
  /// written.
  SeparationSink(std::filesystem::path folder, const SeparationRule& rule);

  SinkNeeds needs() const override { return {.postures = is_measured_}; }
  void begin(const RunInfo& run) override;
  void frame(const RunInfo& run, const Frame& frame) override;
  void end(const RunInfo& run, const RunEnd& end) override;

  /// Null before begin().
  const SeparationTotals* totals() const { return monitor_ ? &monitor_->totals() : nullptr; }
  const std::filesystem::path& folder() const { return folder_; }
  /// Reason why there is no figure, or "".
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

/// Names of all files that SeparationSink can write.
std::vector<std::string> separation_files();

}  // namespace throng
