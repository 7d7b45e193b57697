// PoseCommandReceiver moves externally controlled groups by LCM messages, without waiting for them.
// Invariant: a late, silent, wrong or malicious controller never stops the run. The avatar keeps
// its last pose, and the event is counted and reported.
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
  /// Listens on every control channel of the run. Throws EnvironmentError with the remedy if LCM
  /// cannot use the URL.
  PoseCommandReceiver(const RunInfo& run, const std::string& url);
  /// Uses the caller's connection.
  PoseCommandReceiver(const RunInfo& run, std::shared_ptr<lcm::LCM> lcm);
  ~PoseCommandReceiver();
  PoseCommandReceiver(const PoseCommandReceiver&) = delete;
  PoseCommandReceiver& operator=(const PoseCommandReceiver&) = delete;

  /// Call between two steps: applies the queued messages in order. Never waits.
  void apply(Simulation& simulation);

  struct Counts {
    std::string channel;
    std::string group;
    int64_t messages = 0;
    int64_t frames = 0;                  ///< number of calls of apply()
    int64_t frames_without_command = 0;  ///< frames without a new command, which keep the last pose
    int64_t missing = 0;                 ///< gaps in seq
    int64_t late = 0;                    ///< ignored, because a newer one arrived before
    int64_t rejected = 0;                ///< damaged, malicious or for avatars of another group
    int64_t restarts = 0;  ///< restarts of the numbering after a second without accepted messages
    int64_t clamped = 0;   ///< values clamped to the valid range
    std::string rejection;
  };
  const std::vector<Counts>& counts() const { return counts_; }

 private:
  using Clock = std::chrono::steady_clock;
  struct Listener {
    PoseCommandReceiver* self = nullptr;
    size_t index = 0;
    uint16_t group = 0;
    ChannelTally tally;
    bool is_new = false;
    Clock::time_point last{};
    int64_t last_hole = 0;  // gap in seq before that message
  };
  void subscribe();
  void take(Listener& listener, std::span<const uint8_t> bytes);
  bool is_current(Listener& listener, const pose_command_t& message, size_t bytes);
  void restart(Listener& listener, const pose_command_t& message, double silence_s);
  void move(Listener& listener, const pose_command_t& message);

  const RunInfo& run_;
  std::shared_ptr<lcm::LCM> lcm_;
  Simulation* simulation_ = nullptr;
  std::vector<Counts> counts_;
  std::vector<std::unique_ptr<Listener>> listeners_;  // stable addresses for liblcm
  pose_command_t message_;
};

}  // namespace throng
