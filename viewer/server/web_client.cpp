#include <poll.h>
#include <sys/socket.h>

#include <cerrno>
#include <utility>

#include "viewer/server/web_protocol.h"
#include "viewer/server/web_server.h"

namespace throng {
namespace {

constexpr int kWriterPollMs = 200;  // how soon a writer sees that the server stops

}  // namespace

WebClient::WebClient(int descriptor) : descriptor_(descriptor) {
  writer_ = std::thread([this] { write_loop(); });
}

WebClient::~WebClient() {
  finish();
  writer_.join();
}

void WebClient::finish() {
  {
    // Between the writer's look at finished_ and its falling asleep nobody else may wake it.
    const std::lock_guard lock(mutex_);
    finished_ = true;
  }
  ::shutdown(descriptor_, SHUT_RDWR);
  changed_.notify_all();
}

void WebClient::enqueue(Message message) {
  {
    const std::lock_guard lock(mutex_);
    if (waiting_.size() < kMostWaiting)
      waiting_.push_back(std::move(message));
    else
      finished_ = true;
  }
  if (finished_) finish();
  changed_.notify_one();
}

void WebClient::send_text(std::string text) { enqueue({true, std::move(text), nullptr}); }

void WebClient::send_binary(SharedBytes bytes) { enqueue({false, {}, std::move(bytes)}); }

void WebClient::offer_frame(SharedBytes frame) {
  {
    const std::lock_guard lock(mutex_);
    if (frame_ != nullptr) ++frames_dropped_;
    frame_ = std::move(frame);
  }
  changed_.notify_one();
}

void WebClient::pong(std::string payload) {
  {
    const std::lock_guard lock(mutex_);
    if (pongs_.size() < kMostWaiting) pongs_.push_back(std::move(payload));
  }
  changed_.notify_one();
}

bool WebClient::write(std::string_view bytes) {
  while (!bytes.empty()) {
    if (finished_) return false;
    const ssize_t sent =
        ::send(descriptor_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent > 0) {
      bytes.remove_prefix(static_cast<size_t>(sent));
      continue;
    }
    if (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR) return false;
    pollfd writable{descriptor_, POLLOUT, 0};
    ::poll(&writable, 1, kWriterPollMs);
  }
  return true;
}

bool WebClient::write_message(const Message& message) {
  if (message.is_text)
    return write(frame_head(Opcode::kText, message.text.size())) && write(message.text);
  const auto* data = reinterpret_cast<const char*>(message.bytes->data());
  return write(frame_head(Opcode::kBinary, message.bytes->size())) &&
         write({data, message.bytes->size()});
}

void WebClient::write_loop() {
  bool good = true;
  while (good && !finished_) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] {
      return finished_ || !pongs_.empty() || !waiting_.empty() || frame_ != nullptr;
    });
    if (finished_) break;
    if (!pongs_.empty()) {
      const std::string payload = std::exchange(pongs_, {}).back();
      lock.unlock();
      good = write(frame_head(Opcode::kPong, payload.size())) && write(payload);
    } else if (!waiting_.empty()) {
      const Message message = std::move(waiting_.front());
      waiting_.pop_front();
      lock.unlock();
      good = write_message(message);
    } else {
      const Message frame{false, {}, std::exchange(frame_, nullptr)};
      lock.unlock();
      good = write_message(frame);
      if (good) ++frames_sent_;
    }
  }
  finish();
}

}  // namespace throng
