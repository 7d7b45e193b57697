// ReplayRecorder compresses a run, and write_replay() writes it with the page into one HTML file.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lcm_io/codec/encoder.h"
#include "lcm_io/codec/run_reader.h"
#include "viewer/server/pair_history.h"
#include "viewer/server/proximity_message.h"
#include "viewer/server/run_message.h"
#include "viewer/server/shortfall_list.h"

namespace throng {

/// PostureBasis represents posture rows as a mean and a few directions (principal components,
/// Pearson 1901): walking people use a small part of their joint space.
/// Invariant: every number of every row stays within its tolerance.
struct PostureBasis {
  Eigen::VectorXd mean;        ///< one number per column
  Eigen::MatrixXd directions;  ///< columns x components; one whole step per unit of a coefficient
  int components() const { return static_cast<int>(directions.cols()); }

  /// Returns whole steps along each direction: rows x components.
  Eigen::MatrixXi coefficients(const Eigen::MatrixXd& rows) const;

  /// `rows`: one posture per row. `tolerance`: one per column, above 0.
  static PostureBasis of(const Eigen::MatrixXd& rows, const Eigen::VectorXd& tolerance);

 private:
  Eigen::MatrixXd coefficient_of_;  // components x columns
};

// Keys are stored ten times per second, joint rows as a few numbers.
// Invariant: the page rebuilds every key within these tolerances.

inline constexpr double kReplayKeyPeriod_s = 0.1;
inline constexpr double kReplayPosition_m = 0.005;  ///< step of root positions
inline constexpr double kReplayQuaternion = 1e-3;   ///< step of each component
inline constexpr double kReplayAngle_rad = 0.02;    ///< error of a revolute joint at a key
inline constexpr double kReplayTravel_m = 0.002;    ///< error of a prismatic joint at a key
inline constexpr double kReplayPoint_m = 1e-6;      ///< step of closest points; distances are exact

/// ReplayRecorder takes the messages of one run, in order.
class ReplayRecorder {
 public:
  void take(std::string_view channel, std::span<const uint8_t> bytes);

  /// Returns whether the run has any state to show.
  bool has_keys() const { return !keys_.empty(); }
  /// Null until the description is complete.
  const run_description_t* run() const { return run_.run(); }
  int avatars() const { return run_.run() == nullptr ? 0 : run_.run()->avatar_count; }
  double seconds() const;

  /// Returns the size of the stored states in memory.
  size_t stored_bytes() const { return keys_.size() * bytes_per_key_; }

  /// Returns u32 bytes | run message | u32 bytes of JSON | JSON | columns (see the definition), not
  /// yet compressed. Needs keys. `problem`: missing parts of the run, which the page reports.
  Bytes finish(const std::string& problem);

  /// Omits proximity rows, which are too many for a file. Returns whether there were some.
  bool drop_proximity();

 private:
  struct Key {
    int64_t frame;
    CrowdState crowd;
  };
  struct ProximityRow {
    int64_t frame;
    ProximityPair row;
  };
  struct ContactInterval {
    int64_t begin, end;
    PairLevel level;
    uint8_t flags;
  };
  void store_changes();
  void store_nearest();
  void put_people(Bytes& out) const;
  Eigen::MatrixXd rows_of(std::span<const size_t> members, Eigen::Index joints) const;
  PostureBasis put_postures(size_t model_index, Bytes& out);
  void put_pairs(Bytes& out) const;
  void put_nearest(Bytes& out) const;

  RunReader run_;
  PairBegins begins_;
  std::vector<Key> keys_;
  size_t bytes_per_key_ = 0;
  int64_t last_frame_ = -1;
  std::map<PairKey, std::vector<ContactInterval>> pairs_;
  int64_t interval_count_ = 0;
  /// Nearest parts of each two bodies, by their ids.
  std::map<std::pair<uint32_t, uint32_t>, std::vector<ProximityRow>> nearest_;
  size_t nearest_count_ = 0;
  ShortfallList shortfalls_;
  bool has_proximity_ = false, is_proximity_dropped_ = false;
  std::vector<float> frame_ms_;
};

// The HTML file opens from disk.
// Invariant: it stays below the limit; a larger file is an error that states the possible length.

inline constexpr double kReplayLimitMb = 25;  ///< limit of most e-mail servers

struct ReplayReport {
  uint64_t bytes = 0;
  int avatars = 0;
  double seconds = 0;
  std::string problem{};  ///< missing parts of the run, also in the page; empty: none
};

/// Writes the file. Throws InputError if it would be larger than `limit_mb`, EnvironmentError if it
/// cannot be written. `problem`: missing parts of the run.
ReplayReport write_replay(ReplayRecorder& recorder, const std::filesystem::path& html,
                          std::string_view page, double limit_mb, const std::string& problem = "");

/// Converts the sound part of a log. Throws InputError if it is no log or has no avatars.
ReplayReport write_replay(const std::filesystem::path& log, const std::filesystem::path& html,
                          std::string_view page, double limit_mb);

/// ReplaySink records a run and writes the file at its end.
class ReplaySink final : public Sink, private MessageTarget {
 public:
  /// Creates the file. Throws EnvironmentError if it cannot. `page` must outlive the sink.
  ReplaySink(const std::filesystem::path& html, std::string_view page, double limit_mb);

  SinkNeeds needs() const override { return {.postures = true}; }
  /// Throws InputError if the run has no avatars.
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
