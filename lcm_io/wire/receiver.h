// Listens to runs over LCM, live.
// One rule: messages are taken as raw bytes and judged by the guard before anything decodes them;
// what is damaged, foreign or missing is counted, never fatal.
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

/// Valid during the call that it is passed to.
struct ReceivedMessage {
  std::string_view channel;
  std::span<const uint8_t> bytes;
  RunReader::Update update;  ///< what it did to inbox().run()
};

class Receiver {
 public:
  using Listener = std::function<void(const ReceivedMessage&)>;

  /// Throws EnvironmentError, with the way out, if LCM cannot use the URL.
  explicit Receiver(const std::string& url = std::string(kDefaultLcmUrl));
  /// Over a connection that the caller has.
  explicit Receiver(std::shared_ptr<lcm::LCM> lcm);
  ~Receiver();
  Receiver(const Receiver&) = delete;
  Receiver& operator=(const Receiver&) = delete;

  /// Waits for a message as long as said, then takes all that are there (at most a few thousand, so
  /// that the caller gets its turn); returns how many. Rethrows what the listener threw.
  int receive(std::chrono::milliseconds wait, const Listener& listener = {});

  Inbox& inbox() { return inbox_; }

  /// After this long without a message of the run that is followed, another may take over.
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
