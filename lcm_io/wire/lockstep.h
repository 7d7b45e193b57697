// Lockstep makes each frame wait for replies from the controllers of externally controlled groups.
// Invariant: results depend on the replies of the controllers, never on their timing. A missing
// reply ends the run and names the avatars; replies to another frame or run are counted and
// ignored.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "scenes/run/simulation.h"
#include "throng/step_reply_t.hpp"
#include "throng/step_request_t.hpp"

namespace lcm {
class LCM;
}

namespace throng {

class Lockstep {
 public:
  /// Suffixes of the control channel.
  static constexpr std::string_view kRequestSuffix = "_REQUEST", kReplySuffix = "_REPLY";
  static constexpr double kDefaultTimeout_s = 30;

  /// Listens on the reply channel of every externally controlled group. Throws EnvironmentError
  /// with the remedy if LCM cannot use the URL. Throws InputError if the scene has no such group,
  /// if two share a channel, or if a channel name is too long.
  Lockstep(const RunInfo& run, const std::string& url, double timeout_s = kDefaultTimeout_s);
  /// Uses the caller's connection.
  Lockstep(const RunInfo& run, std::shared_ptr<lcm::LCM> lcm, double timeout_s = kDefaultTimeout_s);
  ~Lockstep();
  Lockstep(const Lockstep&) = delete;
  Lockstep& operator=(const Lockstep&) = delete;

  using Stopped = std::function<bool()>;

  /// Waits before the first frame for one reply per externally controlled avatar, so that no
  /// controller misses a message. Throws EnvironmentError naming the missing avatars.
  void begin(Simulation& simulation);
  /// Waits for the replies to a frame and applies them. Returns false if one is late or LCM failed,
  /// see failure(). Once `stopped` returns true it waits at most one second.
  bool after(Simulation& simulation, const Frame& frame, const Stopped& stopped = {});

  const std::string& failure() const { return failure_; }
  /// Whether after() gave up waiting for replies to its last frame because of a stop.
  bool has_missing_replies() const { return missing_ > 0; }

  /// Connection of the requests. Messages published over it before after() precede the request.
  const std::shared_ptr<lcm::LCM>& connection() const { return lcm_; }

  struct Counts {
    std::string group;
    std::string channel;
    int64_t requests = 0;  ///< sent, including repeated ones
    int64_t replies = 0;
    int64_t late = 0;        ///< to an earlier frame
    int64_t repeated = 0;    ///< to this frame, for avatars that had a reply
    int64_t other_runs = 0;  ///< to another run
    int64_t rejected = 0;    ///< damaged, malicious, to a later frame or for another group
    int64_t clamped = 0;     ///< values clamped to the valid range
    std::string rejection;
  };
  const std::vector<Counts>& counts() const { return counts_; }
  double timeout_s() const { return timeout_s_; }
  double total_wait_s() const { return total_wait_s_; }  ///< over all frames, without begin()
  double max_wait_s() const { return max_wait_s_; }

 private:
  using Clock = std::chrono::steady_clock;
  struct Controller {
    Lockstep* self = nullptr;
    size_t index = 0;
    uint16_t group = 0;
    std::string request_channel;
    int64_t requests = 0;
    std::vector<uint32_t> avatars;
  };
  void listen(size_t group);
  bool await(Simulation& simulation, const Stopped& stopped);
  void send_requests();
  void send_request(Controller& controller);
  void take(Controller& controller, std::span<const uint8_t> bytes);
  void handle(Controller& controller, const step_reply_t& reply);
  std::string late_controllers() const;

  const RunInfo& run_;
  std::shared_ptr<lcm::LCM> lcm_;
  double timeout_s_;
  std::vector<Counts> counts_;
  std::vector<std::unique_ptr<Controller>> controllers_;  // stable addresses for liblcm

  Simulation* simulation_ = nullptr;
  int64_t frame_ = 0;
  int64_t utime_us_ = 0;
  bool is_first_ = false;
  std::vector<uint8_t> has_replied_;
  int64_t missing_ = 0;  // externally controlled avatars without a reply
  double total_wait_s_ = 0, max_wait_s_ = 0;
  std::string failure_;
  step_request_t request_{};
  step_reply_t reply_{};
};

}  // namespace throng
