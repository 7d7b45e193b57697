// A recorded run made small enough to send, in one HTML file with the page.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lcm_io/codec/encoder.h"
#include "lcm_io/codec/run_reader.h"
#include "viewer/server/pair_history.h"
#include "viewer/server/run_message.h"

namespace throng {

/// Joint rows of many moments as a mean and a few directions: walking people fill a small part of
/// the space that their joints span (principal components, Pearson 1901).
/// As many components as keep every number of every row within its tolerance.
struct PostureBasis {
  Eigen::VectorXd mean;        ///< a column each
  Eigen::MatrixXd directions;  ///< columns x components; a coefficient's unit is one whole step
  int components() const { return static_cast<int>(directions.cols()); }

  /// Whole steps along each direction: rows x components.
  Eigen::MatrixXi coefficients(const Eigen::MatrixXd& rows) const;

  /// `rows`: one a line. `tolerance`: one a column, above 0.
  static PostureBasis of(const Eigen::MatrixXd& rows, const Eigen::VectorXd& tolerance);

 private:
  Eigen::MatrixXd coefficient_of_;  // components x columns
};

// A recorded run made small enough to send: keys ten times a second, joint rows as a few numbers.
// What the page rebuilds is off by less than the tolerances stated here, whatever moves
// the people.

inline constexpr double kReplayKeyPeriod_s = 0.1;
inline constexpr double kReplayPosition_m = 0.005;  ///< step of root positions
inline constexpr double kReplayQuaternion = 1e-3;   ///< step of each component
inline constexpr double kReplayAngle_rad = 0.02;    ///< error of a joint that turns, at a key
inline constexpr double kReplayTravel_m = 0.002;    ///< error of a joint that slides, at a key

/// Takes the messages of one run, in order.
class ReplayRecorder {
 public:
  void take(std::string_view channel, std::span<const uint8_t> bytes);

  /// Whether there is anything to show.
  bool has_keys() const { return !keys_.empty(); }
  /// Null until the description is complete.
  const run_description_t* run() const { return run_.run(); }
  int avatars() const { return run_.run() == nullptr ? 0 : run_.run()->avatar_count; }
  double seconds() const;

  /// What has been kept so far, in memory.
  size_t stored_bytes() const { return keys_.size() * bytes_per_key_; }

  /// u32 bytes | run message | u32 bytes of JSON | JSON | columns: see the definition. Not yet
  /// compressed. Needs keys. `problem`: what of the run is missing, for the page to say.
  Bytes finish(const std::string& problem);

 private:
  struct Key {
    int64_t frame;
    CrowdState crowd;
  };
  struct ContactInterval {
    int64_t begin, end;
    PairLevel level;
    uint8_t flags;
  };
  void store_changes();
  void put_people(Bytes& out) const;
  Eigen::MatrixXd rows_of(std::span<const size_t> members, Eigen::Index joints) const;
  PostureBasis put_postures(size_t model_index, Bytes& out);
  void put_pairs(Bytes& out) const;

  RunReader run_;
  PairBegins begins_;
  std::vector<Key> keys_;
  size_t bytes_per_key_ = 0;
  int64_t last_frame_ = -1;
  std::map<PairKey, std::vector<ContactInterval>> pairs_;
  int64_t interval_count_ = 0;
  std::vector<float> frame_ms_;
};

// One HTML file with the page and a recorded run in it, to open from disk or to send.
// No larger than the reader was allowed; what does not fit is an error that says what
// would.

inline constexpr double kReplayLimitMb = 25;  ///< what most e-mail servers take

struct ReplayReport {
  uint64_t bytes = 0;
  int avatars = 0;
  double seconds = 0;
  std::string problem{};  ///< what of the run is missing, also in the page; "" if nothing is
};

/// Throws InputError if it would be larger than `limit_mb`, EnvironmentError if it cannot be
/// written. `problem`: what of the run is missing.
ReplayReport write_replay(ReplayRecorder& recorder, const std::filesystem::path& html,
                          std::string_view page, double limit_mb, const std::string& problem = "");

/// The same from a log, as far as that is sound. Throws InputError if it is none, or of nobody.
ReplayReport write_replay(const std::filesystem::path& log, const std::filesystem::path& html,
                          std::string_view page, double limit_mb);

/// Records a run while it goes on, and writes the file at its end.
class ReplaySink final : public Sink, private MessageTarget {
 public:
  /// Creates the file. Throws EnvironmentError if it cannot. `page` must outlive it.
  ReplaySink(const std::filesystem::path& html, std::string_view page, double limit_mb);

  SinkNeeds needs() const override { return {.postures = true}; }
  /// Throws InputError if nobody is in the run.
  void begin(const RunInfo& run) override;
  void frame(const RunInfo& run, const Frame& frame) override;
  void end(const RunInfo& run, const RunEnd& end) override;

  const ReplayReport& report() const { return report_; }

 private:
  void message(Channel channel, int64_t utime_us, std::span<const uint8_t> bytes) override;

  std::filesystem::path html_;
  std::string_view page_;
  double limit_mb_;
  ReplayRecorder recorder_;
  std::optional<RunEncoder> encoder_;
  ReplayReport report_;
};

}  // namespace throng
