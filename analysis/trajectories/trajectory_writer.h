// Where recorded positions go: one implementation a file format.
// One rule: what a writer has completed stays readable, whatever fails later.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "scenes/file/scene.h"

namespace throng {

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
inline constexpr const char* kBesideSqlite[] = {"-journal", "-wal", "-shm"};

/// Opens the file; begin() empties it. Throws EnvironmentError if it cannot be opened.
std::unique_ptr<TrajectoryWriter> open_sqlite_trajectory(const std::filesystem::path& file);
std::unique_ptr<TrajectoryWriter> open_csv_trajectory(const std::filesystem::path& file);

}  // namespace throng
