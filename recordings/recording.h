// Recording holds the trajectories of people from an experiment or another simulator, independent
// of the file format.
// Invariant: positions are those of the file, in metres, shifted by whole kilometres if they are
// map coordinates; anomalies are counted and reported, never repaired.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/rectangle.h"
#include "geometry/polygon_union.h"

namespace throng {

enum class TrackedPoint : uint8_t {
  kCentre,  ///< centre of the body, usual in simulators
  kHead,    ///< seen by cameras above a crowd
};

/// Facts that a file may lack, and the requested part.
struct RecordingOptions {
  std::filesystem::path file{};
  /// Frames per second as the file numbers them: 25 if it has every tenth frame of a 25 fps
  /// recording.
  std::optional<double> fps{};
  std::optional<double> unit_m{};            ///< metres per unit of length of the file: 0.01 for cm
  std::optional<double> heading_unit_rad{};  ///< radians per unit of its headings
  std::string columns{};  ///< "id=pedID,t=time,x=posX,y=posY"; empty: by column names
  char separator = 0;
  std::optional<TrackedPoint> tracked_point{};  ///< empty: by kind of file
  /// Start and end relative to the file's first frame. Time 0 is the first frame from start_s on.
  double start_s = 0;
  double end_s = std::numeric_limits<double>::infinity();
  bool strict = false;
};

/// Position of a person at a recorded instant.
struct Sample {
  double time_s = 0;  ///< since the first frame of the recording
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  float z_m = std::numeric_limits<float>::quiet_NaN();          ///< NaN: unknown
  float heading_rad = std::numeric_limits<float>::quiet_NaN();  ///< NaN: unknown
};

struct RecordedPerson {
  int64_t id = 0;
  int64_t samples = 0;
  double first_s = 0, last_s = 0;
  /// Height of the top of the head; empty if z is missing, equal for all people or not a body
  /// height.
  std::optional<double> height_m;
};

/// Kind of anomaly, number of occurrences, and the first one.
struct Anomaly {
  std::string what;  ///< "speeds above 12 m/s"
  int64_t count = 0;
  std::string first;  ///< "id 7 at frame 112: 3.2 m in 0.04 s"
};

/// Content of a file apart from positions.
struct RecordingFacts {
  std::string kind;  ///< "archive text", "JuPedSim SQLite", ...
  TrackedPoint tracked_point = TrackedPoint::kCentre;
  double fps = 0;           ///< rate of recorded frames; 0: events at any time (footsteps)
  int64_t first_frame = 0;  ///< number in the file; 0 if it has times
  int64_t frame_step = 1;   ///< difference of the numbers of consecutive frames
  int64_t frames = 0;       ///< number from the first to the last, inclusive; 0 if fps is 0
  double duration_s = 0;    ///< time from the first sample to the last
  int64_t samples = 0;
  Rectangle bounds;
  /// Whole kilometres subtracted from the file's coordinates.
  Eigen::Vector2d shift_m = Eigen::Vector2d::Zero();
  bool has_headings = false;
  std::string wkt;  ///< walkable area in the file's units, not shifted; empty: none
  double wkt_unit_m = 1;
  std::vector<Anomaly> anomalies;
};

class RecordedSamples;

/// Recording in memory, with samples in an anonymous temporary file: memory grows with the number
/// of people only. Immutable and thread-safe.
class Recording {
 public:
  Recording(RecordingFacts facts, std::vector<RecordedPerson> people,
            std::unique_ptr<const RecordedSamples> samples, uint64_t content_hash);
  ~Recording();

  const RecordingFacts& facts() const { return facts_; }
  /// People in ascending order of id.
  const std::vector<RecordedPerson>& people() const { return people_; }
  /// Hash of samples, people and facts that shape a run; independent of file name and format.
  uint64_t content_hash() const { return content_hash_; }
  /// Reads all samples of a person in ascending order of time, at most one per instant. Throws
  /// EnvironmentError if the temporary file cannot be read.
  void read(size_t person, std::vector<Sample>& out) const;

 private:
  RecordingFacts facts_;
  std::vector<RecordedPerson> people_;
  std::unique_ptr<const RecordedSamples> samples_;
  uint64_t content_hash_;
};

/// Reads a file; its kind is detected by content. Throws InputError with file, line, expectation,
/// finding and the option that remedies it. Throws EnvironmentError if the temporary file cannot be
/// written.
std::shared_ptr<const Recording> read_recording(const RecordingOptions& options);

/// Joined walkable area of a recording in the metres of the scene. Throws InputError at `where`.
JoinedArea recorded_area(const RecordingFacts& facts, const std::string& where);

/// Returns whether the content of a file looks like a recording.
bool is_recording(const std::filesystem::path& file);

}  // namespace throng
