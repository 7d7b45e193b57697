// Moves the driven groups of a simulation in lockstep: a frame waits for the answers to the last.
// One rule: what a run computes depends on what its controllers answer, never on when; who does not
// answer ends the run, by name, and what comes for another frame or run is counted and not used.
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
  /// What a group's channel is followed by.
  static constexpr std::string_view kRequestSuffix = "_REQUEST", kReplySuffix = "_REPLY";
  static constexpr double kDefaultTimeout_s = 30;

  /// Listens on the answer channel of every driven group. Throws EnvironmentError, with the way
  /// out, if LCM cannot use the URL; InputError if the scene has no driven group, two that share a
  /// channel, or a channel too long for its answers.
  Lockstep(const RunInfo& run, const std::string& url, double timeout_s = kDefaultTimeout_s);
  /// Over a connection that the caller has.
  Lockstep(const RunInfo& run, std::shared_ptr<lcm::LCM> lcm, double timeout_s = kDefaultTimeout_s);
  ~Lockstep();
  Lockstep(const Lockstep&) = delete;
  Lockstep& operator=(const Lockstep&) = delete;

  using Stopped = std::function<bool()>;

  /// Before the first frame: waits until every driven avatar was answered for once, so that no
  /// controller misses a message. Throws EnvironmentError naming who is not there.
  void begin(Simulation& simulation);
  /// After a frame was sent: hands the answers to it to the simulation. False if somebody is late
  /// or LCM broke down, see failure(). Once `stopped` says so it waits a second at most.
  bool after(Simulation& simulation, const Frame& frame, const Stopped& stopped = {});

  const std::string& failure() const { return failure_; }
  /// Whether after() gave up on the answers to its last frame, being stopped.
  bool has_missing_replies() const { return missing_ > 0; }

  /// Whoever publishes over it, too, has all messages of a frame on the wire before its turn.
  const std::shared_ptr<lcm::LCM>& connection() const { return lcm_; }

  struct Counts {
    std::string group;
    std::string channel;     ///< of the answers
    int64_t requests = 0;    ///< messages that asked, repeated ones too
    int64_t replies = 0;     ///< that moved somebody
    int64_t late = 0;        ///< to an earlier frame
    int64_t repeated = 0;    ///< to this frame, for avatars that had been answered for
    int64_t other_runs = 0;  ///< to another run
    int64_t refused = 0;     ///< damaged, hostile, to a frame to come, of avatars of others
    int64_t clamped = 0;     ///< numbers set to the nearest that is possible
    std::string refusal;     ///< the newest
  };
  /// One a driven group.
  const std::vector<Counts>& counts() const { return counts_; }
  double timeout_s() const { return timeout_s_; }
  double total_wait_s() const { return total_wait_s_; }  ///< over all frames, begin() left out
  double max_wait_s() const { return max_wait_s_; }      ///< of a frame

 private:
  using Clock = std::chrono::steady_clock;
  /// One a driven group.
  struct Controller {
    Lockstep* self = nullptr;
    size_t index = 0;    // into counts_
    uint16_t group = 0;  // of the run
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
  std::vector<std::unique_ptr<Controller>> controllers_;  // liblcm keeps pointers to them

  Simulation* simulation_ = nullptr;  // while it waits
  int64_t frame_ = 0;                 // the one to be answered
  int64_t utime_us_ = 0;
  bool is_first_ = false;
  std::vector<uint8_t> has_replied_;  // by avatar
  int64_t missing_ = 0;               // avatars that are driven and not answered for
  double total_wait_s_ = 0, max_wait_s_ = 0;
  std::string failure_;
  step_request_t request_{};
  step_reply_t reply_{};
};

}  // namespace throng
