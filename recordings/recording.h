// Where people of a recording were: what a file of an experiment or of another simulator says,
// whatever its format.
// One rule: positions are kept as the file has them (in metres, shifted by whole kilometres where
// they are coordinates of a map); what is odd about them is counted and reported, never mended.
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

namespace throng {

/// What a recording's positions are those of.
enum class TrackedPoint : uint8_t {
  kCentre,  ///< of the body, as simulators have it
  kHead,    ///< as cameras above a crowd see it
};

/// What a file does not say, and which part of it is asked for.
struct RecordingOptions {
  std::filesystem::path file{};
  /// Frames a second as the file numbers them: 25 where every tenth of 25 a second is recorded.
  std::optional<double> fps{};
  std::optional<double> unit_m{};            ///< metres per unit of length of the file: 0.01 for cm
  std::optional<double> heading_unit_rad{};  ///< radians per unit of its headings
  std::string columns{};  ///< "id=pedID,t=time,x=posX,y=posY"; empty: by their names
  char separator = 0;     ///< of columns; 0: as the first line shows
  std::optional<TrackedPoint> tracked_point{};  ///< none: by the kind of file
  double start_s = 0;  ///< after the first frame of the file; 0 s is then the first
                       ///< frame of the part
  double end_s = std::numeric_limits<double>::infinity();
  bool strict = false;  ///< what is odd is bad input
};

/// Where somebody was at one recorded instant.
struct Sample {
  double time_s = 0;  ///< since the first frame of the recording
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  float z_m = std::numeric_limits<float>::quiet_NaN();          ///< none: NaN
  float heading_rad = std::numeric_limits<float>::quiet_NaN();  ///< none: NaN
};

struct RecordedPerson {
  int64_t id = 0;  ///< as in the file
  int64_t samples = 0;
  double first_s = 0, last_s = 0;
  /// Of the head's top; none where z is none, the same for all, or no height of a person.
  std::optional<double> height_m;
};

/// A kind of oddity, how often it was seen, and where first.
struct Anomaly {
  std::string what;  ///< "faster than 12 m/s"
  int64_t count = 0;
  std::string first;  ///< "id 7 at frame 112: 3.2 m in 0.04 s"
};

/// What a file says besides positions.
struct RecordingFacts {
  std::string kind;  ///< "archive text", "JuPedSim SQLite", ...
  TrackedPoint tracked_point = TrackedPoint::kCentre;
  double fps = 0;           ///< of the recorded frames; 0: events at any time (footsteps)
  int64_t first_frame = 0;  ///< as the file numbers them; 0 where it has times
  int64_t frame_step = 1;   ///< from one recorded frame to the next, as the file numbers them
  int64_t frames = 0;       ///< instants from the first to the last, both included; 0 if fps is
  double duration_s = 0;    ///< from the first sample to the last
  int64_t samples = 0;      ///< of all people
  Rectangle bounds;         ///< of all positions, shifted
  Eigen::Vector2d shift_m = Eigen::Vector2d::Zero();  ///< whole km taken off the file's coordinates
  bool has_headings = false;
  std::string wkt;  ///< the walkable area as the file has it (its units, not shifted); empty: none
  double wkt_unit_m = 1;
  std::vector<Anomaly> anomalies;
};

class RecordedSamples;

/// A recording that was read: facts and people in memory, samples in a temporary file without a
/// name, so that memory grows with the people alone. Immutable; from several threads at once.
class Recording {
 public:
  Recording(RecordingFacts facts, std::vector<RecordedPerson> people,
            std::unique_ptr<const RecordedSamples> samples, uint64_t content_hash);
  ~Recording();

  const RecordingFacts& facts() const { return facts_; }
  /// In ascending order of their ids.
  const std::vector<RecordedPerson>& people() const { return people_; }
  /// Of the samples, people and facts that shape a run; not of the file's name or its format.
  uint64_t content_hash() const { return content_hash_; }
  /// All samples of a person in ascending order of time, no two at the same instant. Throws
  /// EnvironmentError if the temporary file cannot be read.
  void read(size_t person, std::vector<Sample>& out) const;

 private:
  RecordingFacts facts_;
  std::vector<RecordedPerson> people_;
  std::unique_ptr<const RecordedSamples> samples_;
  uint64_t content_hash_;
};

/// Reads a file of any kind that is known by its content. Throws InputError: one line that names
/// file, line, what is expected, what was found, and the option that says what the file does not;
/// EnvironmentError if the temporary file cannot be written.
std::shared_ptr<const Recording> read_recording(const RecordingOptions& options);

/// True if the file looks like a recording of some kind: by its content, not by its name.
bool is_recording(const std::filesystem::path& file);

}  // namespace throng
