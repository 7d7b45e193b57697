// TrajectorySink writes the positions of people in formats that other programs read.
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

// Writers keep the frames that they have completed readable, regardless of later failures.

/// Properties of a whole trajectory file.
struct TrajectoryHead {
  double fps = 0;    ///< frames per second of simulated time
  Rectangle bounds;  ///< bounds of the walkable area
  std::string wkt;   ///< walkable area, see trajectory_area(); empty: not required
  std::vector<std::pair<std::string, std::string>> facts;  ///< names and values: scene, seed, run
  std::vector<std::string> people;                         ///< display names by id
};

struct TrajectoryRow {
  uint32_t id = 0;
  double x_m = 0;
  double y_m = 0;
  double heading_rad = 0;  ///< counter-clockwise from x, in (-pi, pi]
  double speed_mps = 0;
};

/// Writes one file; each format has an implementation. Calls throw EnvironmentError if the file
/// cannot be written.
class TrajectoryWriter {
 public:
  virtual ~TrajectoryWriter() = default;
  virtual void begin(const TrajectoryHead& head) = 0;
  virtual void frame(int64_t number, std::span<const TrajectoryRow> rows) = 0;
  virtual void end() = 0;
};

/// Suffixes of the files that SQLite keeps next to a database while it is written.
inline constexpr const char* kSqliteSideFiles[] = {"-journal", "-wal", "-shm"};

/// Opens the file; begin() truncates it. Throws EnvironmentError if it cannot be opened.
std::unique_ptr<TrajectoryWriter> open_sqlite_trajectory(const std::filesystem::path& file);
std::unique_ptr<TrajectoryWriter> open_csv_trajectory(const std::filesystem::path& file);

/// Options of a trajectory for tools such as PedPy, JuPedSim or spreadsheets. Frames have one row
/// per present person.
struct TrajectoryOptions {
  std::filesystem::path file;  ///< NAME.sqlite or NAME.csv
  /// Target frame rate; the sink writes every n-th step, with n chosen to come closest. None: that
  /// of the recording, or 10.
  std::optional<double> fps = {};
  /// Number of the piece if the walkable area has several, see trajectory_area().
  std::optional<int64_t> piece = {};
};

class TrajectorySink final : public Sink {
 public:
  /// Opens the file; begin() truncates it. Throws InputError for other extensions; all calls throw
  /// EnvironmentError if the file cannot be opened or written.
  explicit TrajectorySink(const TrajectoryOptions& options);

  void begin(const RunInfo& run) override;
  void frame(const RunInfo& run, const Frame& frame) override;
  void end(const RunInfo& run, const RunEnd& end) override;

  int64_t frames() const { return frames_; }  ///< number of frames so far
  int64_t rows() const { return rows_total_; }

 private:
  TrajectoryOptions options_;
  std::unique_ptr<TrajectoryWriter> writer_;
  int64_t every_ = 1;  ///< steps per frame
  int64_t frames_ = 0;
  int64_t rows_total_ = 0;
  std::vector<TrajectoryRow> rows_;
};

/// True if the name ends in .sqlite or .csv.
bool is_trajectory_name(const std::filesystem::path& file);

/// Throws InputError if a file needs the walkable area and no piece of it can be chosen. `option`
/// names the option that chooses a piece.
void require_trajectory_area(std::span<const std::filesystem::path> files, const Scene& scene,
                             std::optional<int64_t> piece, std::string_view option);

}  // namespace throng
