// LcmSink publishes a run over LCM.
// Invariant: network problems never stop or slow the run; they are counted and reported.
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
  double state_every = 1;
  bool part_poses = false;
  /// Receives warnings; stderr if empty.
  std::function<void(const std::string&)> warn = {};
};

class LcmSink final : public TargetSink {
 public:
  /// Warns once, with the remedy, if LCM cannot use the URL; then nothing is published. If only a
  /// server is missing, messages count as dropped.
  explicit LcmSink(const LcmOptions& options);
  /// Uses the caller's connection; options.url only names it in messages.
  LcmSink(const LcmOptions& options, std::shared_ptr<lcm::LCM> lcm);
  ~LcmSink() override;

  EncoderOptions encoding() const override;
  /// True also for a missing server, so that dropped messages are counted.
  bool wants_messages() const override { return good() || server_is_lost_; }
  void message(Channel channel, int64_t utime_us, std::span<const uint8_t> bytes) override;
  void after_begin(TargetState& target_state) override;
  /// Sends the due chunks of the description; all of them once per second.
  void after_frame(TargetState& target_state) override;
  /// Sends THRONG_END five times, 20 ms apart, because nothing repeats it later; then the last
  /// checksums.
  void after_end(TargetState& target_state) override;

  /// Sends a message on `channel`, a channel in addition to those of the run; it is counted.
  void send(const std::string& channel, std::span<const uint8_t> bytes);

  bool good() const;
  const std::string& url() const { return options_.url; }
  int64_t messages() const { return messages_; }
  int64_t bytes() const { return bytes_; }
  int64_t dropped() const { return dropped_; }

 private:
  using Clock = std::chrono::steady_clock;

  LcmOptions options_;
  std::shared_ptr<lcm::LCM> lcm_;
  std::array<std::string, kChannelCount> channels_;  // created once, because LCM needs strings
  Clock::time_point round_started_{};
  int next_chunk_ = 0;
  bool server_is_lost_ = false;  ///< for tcpq only; the server is not looked for again
  int64_t messages_ = 0;
  int64_t bytes_ = 0;
  int64_t dropped_ = 0;
};

}  // namespace throng
