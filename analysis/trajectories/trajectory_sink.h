// Writes where people walk, in the formats that other programs read.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scenes/file/scene.h"
#include "scenes/run/sink.h"

namespace throng {

// Where recorded positions go: one implementation a file format.
// What a writer has completed stays readable, whatever fails later.

/// What holds for a whole recording.
struct TrajectoryHead {
  double fps = 0;    ///< recorded frames a second of simulated time
  Rectangle bounds;  ///< of the walkable area
  std::string wkt;   ///< the walkable area, see trajectory_area(); empty: not asked for
  std::vector<std::pair<std::string, std::string>> facts;  ///< scene, seed, run: name and value
  std::vector<std::string> people;                         ///< display names by id
};

struct TrajectoryRow {
  uint32_t id = 0;
  double x_m = 0;
  double y_m = 0;
  double heading_rad = 0;  ///< counter-clockwise from x, in (-pi, pi]
  double speed_mps = 0;
};

class TrajectoryWriter {
 public:
  virtual ~TrajectoryWriter() = default;
  /// Each throws EnvironmentError if the file cannot take it.
  virtual void begin(const TrajectoryHead& head) = 0;
  virtual void frame(int64_t number, std::span<const TrajectoryRow> rows) = 0;
  virtual void end() = 0;
};

/// What SQLite keeps beside a database while it is written: these endings are added to its name.
inline constexpr const char* kSqliteSideFiles[] = {"-journal", "-wal", "-shm"};

/// Opens the file; begin() empties it. Throws EnvironmentError if it cannot be opened.
std::unique_ptr<TrajectoryWriter> open_sqlite_trajectory(const std::filesystem::path& file);
std::unique_ptr<TrajectoryWriter> open_csv_trajectory(const std::filesystem::path& file);

/// Records where people are, for tools that read trajectories (PedPy, JuPedSim, spreadsheets).
/// A row for everybody who is there, none for anybody who is not.
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
