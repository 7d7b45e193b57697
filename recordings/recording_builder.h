// What every reader of recordings feeds: samples in any order in, a checked recording out.
// One rule: readers say what a file says; what follows from it (rate, people, heights, shift, what
// is odd, what is refused) is worked out here, the same for all kinds.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "recordings/recorded_samples.h"
#include "recordings/recording.h"
#include "recordings/sample_store.h"
#include "recordings/time_grid.h"
#include "recordings/walkable_wkt.h"

namespace throng {

/// What the instants of a file are.
enum class RecordedClock : uint8_t {
  kFrames,  ///< numbers of frames, so many a second
  kSteps,   ///< numbers of frames of which only the smallest step is known in seconds
  kTimes,   ///< seconds, on a regular grid if there is one within rounding
  kEvents,  ///< seconds at any time: footsteps
};

/// What a reader knows of a file besides samples.
struct RecordingHead {
  std::string kind;
  TrackedPoint tracked_point = TrackedPoint::kCentre;  ///< if options do not say
  RecordedClock clock = RecordedClock::kFrames;
  double per_s = 0;       ///< kFrames: frames a second as numbered; kSteps: smallest steps a second
  double rounding_s = 0;  ///< kTimes: half of the last digit printed
  std::string wkt;
  double wkt_unit_m = 1;
  std::string_view place = "line";  ///< what samples are counted by in errors: line, row
};

class RecordingBuilder {
 public:
  explicit RecordingBuilder(const RecordingOptions& options);
  ~RecordingBuilder();

  const RecordingOptions& options() const { return options_; }
  RecordingHead& head() { return head_; }
  /// The rate that the file states, and what does ("the comment '25 fps'"). It, or that of --fps,
  /// is compared with the times of the file, if it has them.
  void state_rate(std::optional<double> per_s, std::string_view by);
  /// For files that number their frames and have their times, too.
  RateEstimator& frame_times() { return frame_times_; }

  /// Positions in metres, not shifted; NaN as x or y is a gap, which is counted. `place`: the line
  /// of the file, from 1. Throws InputError where a number is beyond what can be.
  void add(int64_t id, const StoredSample& sample, int64_t place);
  /// Counts a row of a table that has separators alone.
  void skip_empty_row(int64_t place);
  /// Something odd that only a reader can see.
  void note(std::string what, int64_t count, std::string first);

  /// Throws InputError if there is nobody, or, with options.strict, anything odd.
  std::shared_ptr<const Recording> finish();

  /// "FILE:LINE", or "FILE: row ROW"; "FILE" of place 0.
  std::string where(int64_t place) const;
  [[noreturn]] void refuse(int64_t place, std::string_view expected, std::string_view found) const;

 private:
  struct Extreme {
    double value = 0;
    int64_t place = 0;
  };

  bool has_frames() const {
    return head_.clock == RecordedClock::kFrames || head_.clock == RecordedClock::kSteps;
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
  std::optional<WalkableArea> area(const RecordingFacts& facts);
  void compare_rates();
  void reject_anomalies(const std::vector<Anomaly>& anomalies) const;

  RecordingOptions options_;
  RecordingHead head_;
  double stated_per_s_ = 0;  ///< 0: none is stated
  std::string stated_by_;
  RateEstimator frame_times_;
  std::optional<double> times_per_s_;  ///< kTimes: of the times, whatever --fps is
  std::unique_ptr<SampleStore> store_;
  std::vector<int64_t> ids_;  ///< of people, as they are numbered in the store
  std::vector<uint32_t> small_ids_;
  std::unordered_map<int64_t, uint32_t> large_ids_;
  int64_t last_id_ = -1;
  size_t last_person_ = 0;
  Extreme min_[2], max_[2];  ///< of x and y
  double first_instant_ = 0, last_instant_ = 0;
  int64_t step_ = 0;  ///< the greatest that all differences of frames are multiples of
  bool has_headings_ = false;
  int64_t gaps_ = 0;
  std::string first_gap_;
  int64_t empty_rows_ = 0, first_empty_row_ = 0;
  std::vector<Anomaly> anomalies_;
};

}  // namespace throng
