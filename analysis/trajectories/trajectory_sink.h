// Records where people are, for tools that read trajectories (PedPy, JuPedSim, spreadsheets).
// One rule: a row for everybody who is there, none for anybody who is not.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "analysis/trajectories/trajectory_writer.h"
#include "scenes/run/sink.h"

namespace throng {

struct TrajectoryOptions {
  std::filesystem::path file;  ///< NAME.sqlite or NAME.csv
  /// Wanted; every so many steps are written that it comes nearest. None: as a recording has it,
  /// else 10.
  std::optional<double> fps = {};
  /// Of a walkable area that falls into pieces, see trajectory_area().
  std::optional<int64_t> piece = {};
};

class TrajectorySink final : public Sink {
 public:
  /// Opens the file; begin() empties it. Throws InputError for another extension, EnvironmentError
  /// if it cannot be opened; so do all calls if it cannot be written any more.
  explicit TrajectorySink(const TrajectoryOptions& options);

  void begin(const RunInfo& run) override;
  void frame(const RunInfo& run, const Frame& frame) override;
  void end(const RunInfo& run, const RunEnd& end) override;

  int64_t frames() const { return frames_; }  ///< recorded so far
  int64_t rows() const { return rows_total_; }

 private:
  TrajectoryOptions options_;
  std::unique_ptr<TrajectoryWriter> writer_;
  int64_t every_ = 1;  ///< steps
  int64_t frames_ = 0;
  int64_t rows_total_ = 0;
  std::vector<TrajectoryRow> rows_;
};

/// True if the name ends in .sqlite or .csv.
bool is_trajectory_name(const std::filesystem::path& file);

/// Throws InputError if one of the files has the walkable area and no piece of it can be chosen;
/// `option` is the one that chooses.
void require_trajectory_area(std::span<const std::filesystem::path> files, const Scene& scene,
                             std::optional<int64_t> piece, std::string_view option);

}  // namespace throng
