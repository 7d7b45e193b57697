// CrowdChangeReceiver applies LCM messages that add, remove and redirect agents.
// Invariant: a wrong or malicious message changes nothing and never stops the run; it is counted
// and reported.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "lcm_io/codec/tally.h"
#include "scenes/run/simulation.h"
#include "throng/crowd_change_t.hpp"

namespace lcm {
class LCM;
}

namespace throng {

class CrowdChangeReceiver {
 public:
  /// Listens on the scene's change_channel. Throws EnvironmentError with the remedy if LCM cannot
  /// use the URL.
  CrowdChangeReceiver(const RunInfo& run, const std::string& url);
  /// Uses the caller's connection.
  CrowdChangeReceiver(const RunInfo& run, std::shared_ptr<lcm::LCM> lcm);
  ~CrowdChangeReceiver();
  CrowdChangeReceiver(const CrowdChangeReceiver&) = delete;
  CrowdChangeReceiver& operator=(const CrowdChangeReceiver&) = delete;

  /// Call between two steps: applies the queued messages in the order of arrival. Never waits.
  void apply(Simulation& simulation);

  struct Counts {
    std::string channel;
    int64_t messages = 0;   ///< applied
    int64_t missing = 0;    ///< gaps in seq
    int64_t rejected = 0;   ///< damaged, for another run, or changes that the run cannot make
    std::string rejection;  ///< reason of the latest
  };
  const Counts& counts() const { return counts_; }

 private:
  void subscribe();
  void take(std::span<const uint8_t> bytes);

  const RunInfo& run_;
  std::shared_ptr<lcm::LCM> lcm_;
  Simulation* simulation_ = nullptr;
  ChannelTally tally_;
  Counts counts_;
  int goals_ = 0;  ///< that were set before this frame
  crowd_change_t message_;
};

}  // namespace throng
