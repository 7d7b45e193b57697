// Publishes a run over LCM while it goes on.
// One rule: trouble on the network never stops or slows the run; it is counted and reported.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include "lcm_io/codec/encoder.h"

namespace lcm {
class LCM;
}

namespace throng {

struct LcmOptions {
  std::string url{kDefaultLcmUrl};
  double state_every = 1;  ///< see EncoderOptions
  bool part_poses = false;
  /// Where warnings go; stderr if empty.
  std::function<void(const std::string&)> warn = {};
};

class LcmSink final : public TargetSink {
 public:
  /// Warns once, with the way out, if LCM cannot use the URL; then frames go nowhere, and where a
  /// server is missing their messages are counted as dropped.
  explicit LcmSink(const LcmOptions& options);
  /// Publishes over a connection that the caller has; options.url only names it in messages.
  LcmSink(const LcmOptions& options, std::shared_ptr<lcm::LCM> lcm);
  ~LcmSink() override;

  EncoderOptions encoding() const override;
  /// Also for a server that is not there: what it misses is counted.
  bool wants_messages() const override { return good() || server_is_lost_; }
  void message(Channel channel, int64_t utime_us, std::span<const uint8_t> bytes) override;
  void after_begin(TargetState& target_state) override;
  /// The pieces of the description that are due: all of them once a second.
  void after_frame(TargetState& target_state) override;
  /// THRONG_END five times, 20 ms apart: nothing later makes up for it. Then the last checks.
  void after_end(TargetState& target_state) override;

  /// A message on another channel than the run's, which `channel` names; counted as the others.
  void send(const std::string& channel, std::span<const uint8_t> bytes);

  bool good() const;
  const std::string& url() const { return options_.url; }
  int64_t messages() const { return messages_; }  ///< that LCM took
  int64_t bytes() const { return bytes_; }
  int64_t dropped() const { return dropped_; }  ///< that LCM refused

 private:
  using Clock = std::chrono::steady_clock;

  LcmOptions options_;
  std::shared_ptr<lcm::LCM> lcm_;
  std::array<std::string, kChannelCount> channels_;  // LCM wants strings: made once
  Clock::time_point round_started_{};
  int next_chunk_ = 0;
  bool server_is_lost_ = false;  ///< tcpq only; it is not looked for again
  int64_t messages_ = 0;
  int64_t bytes_ = 0;
  int64_t dropped_ = 0;
};

}  // namespace throng
