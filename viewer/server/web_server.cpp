#include "viewer/server/web_server.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <utility>

#include "base/errors.h"
#include "base/text.h"
#include "viewer/server/web_protocol.h"

namespace throng {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kPollMs = 200;
constexpr std::chrono::seconds kRequestTime{5};
constexpr size_t kExtraConnections = 24;  // pending requests, in addition to open sockets

/// The browser contacts no other address and never embeds the page in another one.
constexpr std::string_view kSafety =
    "Cache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\nX-Frame-Options: DENY\r\n"
    "Referrer-Policy: no-referrer\r\nCross-Origin-Resource-Policy: same-origin\r\n";

bool write_all(int descriptor, std::string_view bytes, const std::atomic<bool>& stopping) {
  const auto end = Clock::now() + kRequestTime;
  while (!bytes.empty() && !stopping && Clock::now() < end) {
    const ssize_t sent =
        ::send(descriptor, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent > 0) {
      bytes.remove_prefix(static_cast<size_t>(sent));
      continue;
    }
    if (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR) return false;
    pollfd writable{descriptor, POLLOUT, 0};
    ::poll(&writable, 1, kPollMs);
  }
  return bytes.empty();
}

/// Ends the connection of a machine that sleeps or has left the network within about a minute.
void detect_lost_peer(int descriptor) {
  const int yes = 1, idle_s = 30, period_s = 10, probes = 3;
  ::setsockopt(descriptor, SOL_SOCKET, SO_KEEPALIVE, &yes, sizeof yes);
  ::setsockopt(descriptor, IPPROTO_TCP, TCP_KEEPIDLE, &idle_s, sizeof idle_s);
  ::setsockopt(descriptor, IPPROTO_TCP, TCP_KEEPINTVL, &period_s, sizeof period_s);
  ::setsockopt(descriptor, IPPROTO_TCP, TCP_KEEPCNT, &probes, sizeof probes);
}

/// Appends received bytes; returns false when the peer is gone. Waits at most kPollMs.
bool read_some(int descriptor, Bytes& buffer) {
  pollfd readable{descriptor, POLLIN, 0};
  if (::poll(&readable, 1, kPollMs) <= 0) return true;
  uint8_t chunk[4096];
  const ssize_t got = ::recv(descriptor, chunk, sizeof chunk, MSG_DONTWAIT);
  if (got > 0) buffer.insert(buffer.end(), chunk, chunk + got);
  return got > 0 || (got < 0 && (errno == EAGAIN || errno == EINTR));
}

/// Returns the name of this machine, as other machines of the network may know it.
std::string host_name() {
  char name[256] = {};
  return ::gethostname(name, sizeof name - 1) == 0 && is_host_name(name) ? name : "NAME";
}

std::string socket_hello(const HttpRequest& request) {
  return fmt::format(
      "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
      "Sec-WebSocket-Accept: {}\r\n\r\n",
      accept_key(request.header("sec-websocket-key")));
}

/// Returns the size of the head including the empty line; 0 if incomplete.
size_t head_bytes(const Bytes& buffer) {
  const std::string_view text(reinterpret_cast<const char*>(buffer.data()), buffer.size());
  const size_t end = text.find("\r\n\r\n");
  return end == std::string_view::npos ? 0 : end + 4;
}

}  // namespace

struct WebServer::Connection {
  explicit Connection(int fd) : descriptor(fd) {}
  ~Connection() {
    thread.join();
    ::close(descriptor);
  }
  int descriptor;
  std::atomic<bool> done{false};
  std::thread thread;
};

WebServer::WebServer(const WebOptions& options, std::string_view page, WebHandlers handlers)
    : options_(options), page_(page), handlers_(std::move(handlers)) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<uint16_t>(options.port));
  if (inet_pton(AF_INET, options.address.c_str(), &address.sin_addr) != 1)
    throw InputError(options.address, "an IPv4 address to listen on, such as 127.0.0.1",
                     fmt::format("'{}'", options.address));
  if (address.sin_addr.s_addr != htonl(INADDR_ANY)) {
    options_.host_names.push_back(options.address);
  } else if (options.host_names.empty()) {
    throw InputError("--address " + options.address, "a --host-name NAME that browsers use",
                     fmt::format("none; add for example --host-name {}", host_name()));
  }
  listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const int yes = 1;
  ::setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  socklen_t size = sizeof address;
  if (listener_ < 0 || ::bind(listener_, reinterpret_cast<sockaddr*>(&address), size) != 0 ||
      ::listen(listener_, 16) != 0) {
    const std::string why = std::strerror(errno);
    if (listener_ >= 0) ::close(listener_);
    throw EnvironmentError(fmt::format("cannot listen on {}:{}: {}; choose another with --port",
                                       options.address, options.port, why));
  }
  ::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size);
  port_ = ntohs(address.sin_port);
  acceptor_ = std::thread([this] { accept_loop(); });
}

WebServer::~WebServer() {
  stopping_ = true;
  acceptor_.join();
  for_each_client([](WebClient& client) { client.finish(); });
  connections_.clear();  // joins their threads
  ::close(listener_);
}

std::string WebServer::url() const {
  return fmt::format("http://{}:{}/",
                     options_.address == "0.0.0.0" ? options_.host_names.front() : options_.address,
                     port_);
}

std::string WebServer::refusal() const {
  const std::lock_guard lock(mutex_);
  return refusal_;
}

template <typename Do>
void WebServer::for_each_client(const Do& act) const {
  const std::lock_guard lock(mutex_);
  for (const std::shared_ptr<WebClient>& client : clients_) act(*client);
}

void WebServer::offer_frame(const SharedBytes& frame) {
  for_each_client([&](WebClient& client) { client.offer_frame(frame); });
}

void WebServer::send_text(const std::string& text) {
  for_each_client([&](WebClient& client) { client.send_text(text); });
}

void WebServer::send_binary(const SharedBytes& bytes) {
  for_each_client([&](WebClient& client) { client.send_binary(bytes); });
}

size_t WebServer::client_count() const {
  const std::lock_guard lock(mutex_);
  return clients_.size();
}

uint64_t WebServer::frames_dropped() const {
  uint64_t dropped = past_drops_;
  for_each_client([&](WebClient& client) { dropped += client.frames_dropped(); });
  return dropped;
}

void WebServer::join_finished() {
  connections_.remove_if([](const std::unique_ptr<Connection>& c) { return c->done.load(); });
}

void WebServer::accept_loop() {
  while (!stopping_) {
    pollfd readable{listener_, POLLIN, 0};
    const int ready = ::poll(&readable, 1, kPollMs);
    join_finished();
    if (ready <= 0) continue;
    const int descriptor = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
    if (descriptor < 0) continue;
    const int yes = 1;
    ::setsockopt(descriptor, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    detect_lost_peer(descriptor);
    if (options_.send_buffer_bytes > 0)
      ::setsockopt(descriptor, SOL_SOCKET, SO_SNDBUF, &options_.send_buffer_bytes, sizeof(int));
    if (connections_.size() >= static_cast<size_t>(options_.max_clients) + kExtraConnections) {
      ++rejected_;
      ::close(descriptor);
      continue;
    }
    connections_.push_back(std::make_unique<Connection>(descriptor));
    Connection& connection = *connections_.back();
    connection.thread = std::thread([this, &connection] {
      serve(connection);
      ::shutdown(connection.descriptor, SHUT_RDWR);
      connection.done = true;
    });
  }
}

void WebServer::reply(int descriptor, std::string_view status, std::string_view type,
                      std::string_view body) {
  const std::string head = fmt::format(
      "HTTP/1.1 {}\r\nContent-Type: {}\r\nContent-Length: {}\r\n{}Connection: close\r\n\r\n",
      status, type, body.size(), kSafety);
  if (write_all(descriptor, head, stopping_)) write_all(descriptor, body, stopping_);
}

void WebServer::serve(Connection& connection) {
  const int descriptor = connection.descriptor;
  Bytes buffer;
  const auto end = Clock::now() + kRequestTime;
  while (head_bytes(buffer) == 0) {
    if (stopping_ || Clock::now() > end || buffer.size() > kMaxRequestBytes) {
      ++rejected_;
      return;
    }
    if (!read_some(descriptor, buffer)) return;
  }
  const size_t head = head_bytes(buffer);
  const auto request = parse_request({reinterpret_cast<const char*>(buffer.data()), head});
  const auto reject = [&](std::string_view status, const std::string& why = "") {
    ++rejected_;
    reply(descriptor, status, "text/plain; charset=utf-8",
          fmt::format("{}{}{}\n", status, why.empty() ? "" : ": ", why));
  };
  if (!request || head > kMaxRequestBytes) return reject("400 Bad Request");
  if (const std::string why = refusal_of(*request, options_.host_names); !why.empty()) {
    {
      const std::lock_guard lock(mutex_);
      refusal_ = why;
    }
    return reject("403 Forbidden", why);
  }
  if (request->method != "GET") return reject("405 Method Not Allowed");
  if (request->path == "/ws") {
    if (!request->is_web_socket_upgrade()) return reject("426 Upgrade Required");
    return serve_socket(connection, *request,
                        Bytes(buffer.begin() + static_cast<std::ptrdiff_t>(head), buffer.end()));
  }
  if (request->path == "/") return reply(descriptor, "200 OK", "text/html; charset=utf-8", page_);
  reply(descriptor, "404 Not Found", "text/plain; charset=utf-8", "404 Not Found\n");
}

/// A browser hides the status of a rejected socket from its page. The page gets a socket that
/// closes at once, with the reason; a program without Origin gets the status.
void WebServer::reject_socket(int descriptor, const HttpRequest& request) {
  ++rejected_;
  const std::string reason = counted(options_.max_clients, "page is", "pages are") + " open";
  if (request.header("origin").empty())
    return reply(descriptor, "503 Service Unavailable", "text/plain; charset=utf-8",
                 reason + " already\n");
  const std::string payload = close_payload(kTryAgainLater, reason);
  write_all(descriptor,
            socket_hello(request) + frame_head(Opcode::kClose, payload.size()) + payload,
            stopping_);
}

void WebServer::serve_socket(Connection& connection, const HttpRequest& request, Bytes rest) {
  const int descriptor = connection.descriptor;
  std::shared_ptr<WebClient> client;
  {
    const std::lock_guard lock(mutex_);
    if (!stopping_ && clients_.size() < static_cast<size_t>(options_.max_clients)) {
      const std::string hello = socket_hello(request);
      if (!write_all(descriptor, hello, stopping_)) return;
      client = std::make_shared<WebClient>(descriptor, options_.max_stall);
      clients_.push_back(client);
    }
  }
  if (client == nullptr) return reject_socket(descriptor, request);
  if (handlers_.opened) handlers_.opened(client);
  read_messages(connection, *client, std::move(rest));
  client->finish();
  if (client->has_stalled()) ++stalled_;
  const std::lock_guard lock(mutex_);
  past_drops_ += client->frames_dropped();
  clients_.remove(client);
}

void WebServer::read_messages(Connection& connection, WebClient& client, Bytes buffer) {
  while (!stopping_ && !client.finished_) {
    const ClientFrame frame = parse_frame(buffer, kMaxClientMessageBytes);
    if (frame.status == ClientFrame::Status::kRejected) return;
    if (frame.status == ClientFrame::Status::kIncomplete) {
      if (!read_some(connection.descriptor, buffer)) return;
      continue;
    }
    buffer.erase(buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(frame.bytes));
    client.unanswered_pings_ = 0;
    if (frame.opcode == Opcode::kClose) return;
    if (frame.opcode == Opcode::kPing) client.pong(frame.payload);
    if (frame.opcode == Opcode::kText && handlers_.on_text)
      handlers_.on_text(client, frame.payload);
  }
}

namespace {

constexpr int kWriterPollMs = 200;  // time until a writer notices that the server stops

}  // namespace

WebClient::WebClient(int descriptor, std::chrono::milliseconds max_stall)
    : descriptor_(descriptor), max_stall_(max_stall) {
  writer_ = std::thread([this] { write_loop(); });
}

WebClient::~WebClient() {
  finish();
  writer_.join();
}

void WebClient::finish() {
  {
    // The lock: no wake-up may be lost between the writer's check of finished_ and its wait.
    const std::lock_guard lock(mutex_);
    finished_ = true;
  }
  ::shutdown(descriptor_, SHUT_RDWR);
  changed_.notify_all();
}

void WebClient::enqueue(Message message) {
  {
    const std::lock_guard lock(mutex_);
    const size_t bytes = waiting_bytes_ + message.size();
    if (waiting_.empty() || (waiting_.size() < kMaxWaiting && bytes <= kMaxWaitingBytes)) {
      waiting_.push_back(std::move(message));
      waiting_bytes_ = bytes;
    } else {
      finished_ = has_stalled_ = true;
    }
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
    if (pongs_.size() < kMaxWaiting) pongs_.push_back(std::move(payload));
  }
  changed_.notify_one();
}

bool WebClient::write(std::string_view bytes) {
  auto last_sent = Clock::now();
  while (!bytes.empty()) {
    if (finished_) return false;
    const ssize_t sent =
        ::send(descriptor_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent > 0) {
      bytes.remove_prefix(static_cast<size_t>(sent));
      last_sent = Clock::now();
      continue;
    }
    if (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR) return false;
    if (Clock::now() - last_sent >= max_stall_) {
      has_stalled_ = true;
      return false;
    }
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

/// A client that never reads, but for which little waits, would keep its place.
bool WebClient::ping() {
  if (++unanswered_pings_ <= kMaxUnansweredPings) return write(frame_head(Opcode::kPing, 0));
  has_stalled_ = true;
  return false;
}

void WebClient::write_loop() {
  bool good = true;
  auto next_ping = Clock::now() + max_stall_;
  while (good && !finished_) {
    std::unique_lock lock(mutex_);
    changed_.wait_until(lock, next_ping, [this] {
      return finished_ || !pongs_.empty() || !waiting_.empty() || frame_ != nullptr;
    });
    if (finished_) break;
    if (Clock::now() >= next_ping) {
      lock.unlock();
      good = ping();
      next_ping = Clock::now() + max_stall_;
    } else if (!pongs_.empty()) {
      const std::string payload = std::exchange(pongs_, {}).back();
      lock.unlock();
      good = write(frame_head(Opcode::kPong, payload.size())) && write(payload);
    } else if (!waiting_.empty()) {
      const Message message = std::move(waiting_.front());
      waiting_.pop_front();
      waiting_bytes_ -= message.size();
      lock.unlock();
      good = write_message(message);
    } else if (frame_ != nullptr) {
      const Message frame{false, {}, std::exchange(frame_, nullptr)};
      lock.unlock();
      good = write_message(frame);
      if (good) ++frames_sent_;
    }
  }
  finish();
}

}  // namespace throng
