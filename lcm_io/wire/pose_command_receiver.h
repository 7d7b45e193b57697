// Moves the driven groups of a simulation by what comes over LCM.
// One rule: a controller that is late, silent, wrong or hostile never stops the run: the avatar
// holds its last pose, and what happened is counted and said.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "lcm_io/codec/tally.h"
#include "scenes/run/simulation.h"
#include "throng/pose_command_t.hpp"

namespace lcm {
class LCM;
}

namespace throng {

class PoseCommandReceiver {
 public:
  /// Listens on every drive channel of the run. Throws EnvironmentError, with the way out, if LCM
  /// cannot use the URL.
  PoseCommandReceiver(const RunInfo& run, const std::string& url);
  /// Over a connection that the caller has.
  PoseCommandReceiver(const RunInfo& run, std::shared_ptr<lcm::LCM> lcm);
  ~PoseCommandReceiver();
  PoseCommandReceiver(const PoseCommandReceiver&) = delete;
  PoseCommandReceiver& operator=(const PoseCommandReceiver&) = delete;

  /// Between two steps: takes what has come and hands it to the simulation, in order. Never waits.
  void apply(Simulation& simulation);

  struct Counts {
    std::string channel;
    std::string group;
    int64_t messages = 0;  ///< that moved somebody
    int64_t frames = 0;    ///< steps that apply() was called for
    int64_t frames_without_command =
        0;                 ///< of them, those with nothing new: the last pose was held
    int64_t missing = 0;   ///< holes in seq
    int64_t late = 0;      ///< overtaken by a newer one and not used
    int64_t refused = 0;   ///< damaged, hostile or of avatars that the channel does not drive
    int64_t restarts = 0;  ///< numbering begun anew after a second in which nothing was accepted
    int64_t clamped = 0;   ///< numbers set to the nearest that is possible
    std::string refusal;   ///< the newest
  };
  /// One a driven group.
  const std::vector<Counts>& counts() const { return counts_; }

 private:
  using Clock = std::chrono::steady_clock;
  /// One a driven group.
  struct Listener {
    PoseCommandReceiver* self = nullptr;
    size_t index = 0;    // into counts_
    uint16_t group = 0;  // of the run
    ChannelTally tally;
    bool is_new = false;       // something came since the last apply()
    Clock::time_point last{};  // when a message was accepted
    int64_t last_hole = 0;     // in seq, before that message
  };
  void subscribe();
  void take(Listener& listener, std::span<const uint8_t> bytes);
  bool is_current(Listener& listener, const pose_command_t& message, size_t bytes);
  void restart(Listener& listener, const pose_command_t& message, double silence_s);
  void move(Listener& listener, const pose_command_t& message);

  const RunInfo& run_;
  std::shared_ptr<lcm::LCM> lcm_;
  Simulation* simulation_ = nullptr;  // during apply()
  std::vector<Counts> counts_;
  std::vector<std::unique_ptr<Listener>> listeners_;  // liblcm keeps pointers to them
  pose_command_t message_;
};

}  // namespace throng
