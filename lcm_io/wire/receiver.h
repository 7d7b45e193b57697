// Receiver listens to live runs over LCM.
// Invariant: messages are taken as raw bytes and validated before decoding; damaged, foreign and
// missing ones are counted, never fatal.
#pragma once

#include <chrono>
#include <exception>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "lcm_io/codec/channels.h"
#include "lcm_io/wire/inbox.h"

namespace lcm {
class LCM;
}

namespace throng {

/// Valid during the callback.
struct ReceivedMessage {
  std::string_view channel;
  std::span<const uint8_t> bytes;
  RunReader::Update update;  ///< its effect on inbox().run()
};

class Receiver {
 public:
  using Listener = std::function<void(const ReceivedMessage&)>;

  /// Throws EnvironmentError with the remedy if LCM cannot use the URL.
  explicit Receiver(const std::string& url = std::string(kDefaultLcmUrl));
  /// Uses the caller's connection.
  explicit Receiver(std::shared_ptr<lcm::LCM> lcm);
  ~Receiver();
  Receiver(const Receiver&) = delete;
  Receiver& operator=(const Receiver&) = delete;

  /// Waits up to `wait` for a message, then takes all queued ones, at most a few thousand to return
  /// control. Returns their number. Rethrows exceptions of the listener.
  int receive(std::chrono::milliseconds wait, const Listener& listener = {});

  Inbox& inbox() { return inbox_; }

  /// After this time without a message of the followed run another run may take over.
  static constexpr std::chrono::seconds kSilence{3};

 private:
  using Clock = std::chrono::steady_clock;
  void subscribe();
  void take(std::string_view channel, std::span<const uint8_t> bytes);

  std::shared_ptr<lcm::LCM> lcm_;
  Inbox inbox_;
  const Listener* listener_ = nullptr;
  std::exception_ptr thrown_;
  Clock::time_point last_received_ = Clock::now();
};

}  // namespace throng
