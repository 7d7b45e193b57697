// A recorded run made small enough to send: keys ten times a second, joint rows as a few numbers.
// One rule: what the page rebuilds is off by less than the tolerances stated here, whatever moves
// the people.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lcm_io/codec/run_reader.h"
#include "viewer/replay/posture_basis.h"
#include "viewer/server/pair_begins.h"
#include "viewer/server/run_message.h"

namespace throng {

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
  size_t bytes_kept() const { return keys_.size() * bytes_per_key_; }

  /// u32 bytes | run message | u32 bytes of JSON | JSON | columns: see the definition. Not yet
  /// compressed. Needs keys. `problem`: what of the run is missing, for the page to say.
  Bytes finish(const std::string& problem);

 private:
  struct Key {
    int64_t frame;
    CrowdState crowd;
  };
  struct Stretch {
    int64_t begin, end;
    PairLevel level;
    uint8_t flags;
  };
  void keep_changes();
  void put_people(Bytes& out) const;
  Eigen::MatrixXd rows_of(std::span<const size_t> members, Eigen::Index joints) const;
  PostureBasis put_postures(size_t model_index, Bytes& out);
  void put_pairs(Bytes& out) const;

  RunReader run_;
  PairBegins begins_;
  std::vector<Key> keys_;
  size_t bytes_per_key_ = 0;
  int64_t last_frame_ = -1;
  std::map<PairKey, std::vector<Stretch>> pairs_;
  int64_t stretches_ = 0;
  std::vector<float> frame_ms_;
};

}  // namespace throng
