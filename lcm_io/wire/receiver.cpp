#include "lcm_io/wire/receiver.h"

#include <lcm/lcm-cpp.hpp>
#include <utility>

#include "lcm_io/wire/lcm_url.h"

namespace throng {
namespace {

// liblcm queues 30 messages per subscription; a frame of 5000 people has ten. This holds some
// seconds of a large crowd, at most 120 MB.
constexpr int kQueuedMessages = 2000;
constexpr int kMaxMessagesPerCall = 4096;

}  // namespace

Receiver::Receiver(const std::string& url) : Receiver(listening(url)) {}

Receiver::Receiver(std::shared_ptr<lcm::LCM> lcm) : lcm_(std::move(lcm)) { subscribe(); }

Receiver::~Receiver() = default;

void Receiver::subscribe() {
  // A function, because the sanitizer of g++ 12 mistakes LCM's call through a member pointer.
  static constexpr auto on_message = [](const lcm::ReceiveBuffer* buffer,
                                        const std::string& channel, Receiver* self) {
    self->take(channel, {static_cast<const uint8_t*>(buffer->data), buffer->data_size});
  };
  lcm_->subscribeFunction("THRONG_.*", +on_message, this)->setQueueCapacity(kQueuedMessages);
}

void Receiver::take(std::string_view channel, std::span<const uint8_t> bytes) {
  // No exception may pass through the C code between here and receive().
  try {
    const int64_t foreign = inbox_.run().foreign();
    const RunReader::Update update = inbox_.take(channel, bytes);
    const bool is_followed = inbox_.run().header() && inbox_.run().foreign() == foreign;
    if (is_followed) last_received_ = Clock::now();
    if (listener_ && *listener_) (*listener_)({channel, bytes, update});
  } catch (...) {
    if (!thrown_) thrown_ = std::current_exception();
  }
}

int Receiver::receive(std::chrono::milliseconds wait, const Listener& listener) {
  if (Clock::now() - last_received_ > kSilence) inbox_.run().forget();
  listener_ = &listener;
  int taken = 0;
  int timeout_ms = static_cast<int>(wait.count());
  while (taken < kMaxMessagesPerCall && !thrown_ && lcm_->handleTimeout(timeout_ms) > 0) {
    ++taken;
    timeout_ms = 0;
  }
  listener_ = nullptr;
  if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
  return taken;
}

}  // namespace throng
