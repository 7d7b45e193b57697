// RecordingBuilder checks the samples of a reader, in any order, and builds a recording.
// Invariant: readers report the content of a file; rate, people, heights, shift, anomalies and
// rejections are derived here for all kinds.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "geometry/polygon.h"
#include "recordings/recorded_samples.h"
#include "recordings/recording.h"
#include "recordings/sample_store.h"
#include "recordings/time_grid.h"

namespace throng {

enum class RecordedClock : uint8_t {
  kFrames,  ///< frame numbers at a known rate
  kSteps,   ///< frame numbers; only the time of the smallest step is known
  kTimes,   ///< seconds, on a regular grid if there is one within rounding
  kEvents,  ///< seconds at any time: footsteps
};

struct RecordingHeader {
  std::string kind;
  TrackedPoint tracked_point = TrackedPoint::kCentre;  ///< unless options state it
  RecordedClock clock = RecordedClock::kFrames;
  double per_s = 0;       ///< kFrames: frame numbers per second; kSteps: smallest steps per second
  double rounding_s = 0;  ///< kTimes: half of the last printed digit
  std::string wkt;
  double wkt_unit_m = 1;
  std::string_view place = "line";  ///< unit of positions in errors: line or row
};

class RecordingBuilder {
 public:
  explicit RecordingBuilder(const RecordingOptions& options);
  ~RecordingBuilder();

  const RecordingOptions& options() const { return options_; }
  RecordingHeader& header() { return header_; }
  /// Sets the rate stated in the file and its source ("the comment '25 fps'"). This rate or --fps
  /// is compared with the times of the file, if it has both.
  void state_rate(std::optional<double> per_s, std::string_view by);
  RateEstimator& frame_times() { return frame_times_; }

  /// Adds a position in metres, not shifted. NaN in x or y is a counted gap. `place`: line of the
  /// file, from 1. Throws InputError for an impossible number.
  void add(int64_t id, const StoredSample& sample, int64_t place);
  void skip_empty_row(int64_t place);
  /// Adds an anomaly that only the reader can detect.
  void note(std::string what, int64_t count, std::string first);

  /// Throws InputError without any person, or for anomalies with options.strict.
  std::shared_ptr<const Recording> finish();

  /// Returns "FILE:LINE" or "FILE: row ROW"; "FILE" for place 0.
  std::string where(int64_t place) const;
  [[noreturn]] void reject(int64_t place, std::string_view expected, std::string_view found) const;

 private:
  struct Extreme {
    double value = 0;
    int64_t place = 0;
  };

  bool has_frames() const {
    return header_.clock == RecordedClock::kFrames || header_.clock == RecordedClock::kSteps;
  }
  void add_gap(int64_t id, double instant);
  size_t person_of(int64_t id, int64_t place);
  void extend_bounds(const StoredSample& sample, int64_t place);
  Eigen::Vector2d shift() const;
  void check_extent() const;
  double given_rate(const PrintedTimes& times) const;
  SampleMapping mapping(RecordingFacts& facts);
  double first_instant_from(double instant) const;
  RecordingFacts stated_facts() const;
  std::optional<PolygonLocator> area(const RecordingFacts& facts);
  void compare_rates();
  void reject_anomalies(const std::vector<Anomaly>& anomalies) const;

  RecordingOptions options_;
  RecordingHeader header_;
  double stated_per_s_ = 0;
  std::string stated_by_;
  RateEstimator frame_times_;
  std::optional<double> times_per_s_;  ///< kTimes: rate of the times, regardless of --fps
  std::unique_ptr<SampleStore> store_;
  std::vector<int64_t> ids_;  ///< ids of people, by their numbers in the store
  std::vector<uint32_t> small_ids_;
  std::unordered_map<int64_t, uint32_t> large_ids_;
  int64_t last_id_ = -1;
  size_t last_person_ = 0;
  Extreme min_[2], max_[2];
  double first_instant_ = 0, last_instant_ = 0;
  int64_t step_ = 0;  ///< greatest common divisor of all frame differences
  bool has_headings_ = false;
  int64_t gaps_ = 0;
  std::string first_gap_;
  int64_t empty_rows_ = 0, first_empty_row_ = 0;
  std::vector<Anomaly> anomalies_;
};

}  // namespace throng
