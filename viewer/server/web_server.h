// WebServer serves one page and pushes messages to its clients over HTTP and WebSocket.
// Invariant: no caller waits for a browser. A newer frame replaces one that a client has not taken.
// The sizes of client messages, the number of clients and what waits for each are bounded. A client
// that stops reading is disconnected.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "viewer/server/little_endian.h"

namespace throng {

using SharedBytes = std::shared_ptr<const Bytes>;

/// WebClient is one open page. All functions are thread-safe.
class WebClient {
 public:
  /// The server owns `descriptor` and closes it after finish(). `max_stall`: time without progress
  /// of a message after which the client is disconnected. Pings have the same period.
  WebClient(int descriptor, std::chrono::milliseconds max_stall);
  ~WebClient();

  /// Queues messages that must arrive, in order. A client is disconnected if more than kMaxWaiting
  /// messages would wait, or several of more than kMaxWaitingBytes.
  void send_text(std::string text);
  void send_binary(SharedBytes bytes);
  /// Offers the newest frame, which replaces a waiting one. Never blocks.
  void offer_frame(SharedBytes frame);

  uint64_t frames_sent() const { return frames_sent_; }
  uint64_t frames_dropped() const { return frames_dropped_; }
  /// Returns whether the client was disconnected because it had stopped reading.
  bool has_stalled() const { return has_stalled_; }
  /// Ends the connection; the writer stops promptly whether or not the browser reads.
  void finish();

  /// Owned by the handler of the client's messages.
  std::shared_ptr<void> state;

 private:
  friend class WebServer;
  static constexpr size_t kMaxWaiting = 64;
  static constexpr size_t kMaxWaitingBytes = size_t{16} << 20;
  static constexpr int kMaxUnansweredPings = 3;
  struct Message {
    bool is_text = false;
    std::string text;
    SharedBytes bytes;

    size_t size() const { return is_text ? text.size() : bytes->size(); }
  };
  void enqueue(Message message);
  void write_loop();
  bool ping();
  bool write(std::string_view bytes);
  bool write_message(const Message& message);
  void pong(std::string payload);

  int descriptor_;
  std::chrono::milliseconds max_stall_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Message> waiting_;
  size_t waiting_bytes_ = 0;
  std::deque<std::string> pongs_;
  SharedBytes frame_;
  std::atomic<bool> finished_{false}, has_stalled_{false};
  std::atomic<int> unanswered_pings_{0};
  std::atomic<uint64_t> frames_sent_{0};
  std::atomic<uint64_t> frames_dropped_{0};
  std::thread writer_;
};

/// Called in the thread of the client concerned.
struct WebHandlers {
  std::function<void(const std::shared_ptr<WebClient>&)> opened;
  std::function<void(WebClient&, std::string_view text)> on_text;
};

struct WebOptions {
  std::string address = "127.0.0.1";
  /// Names by which browsers reach the server, in addition to its address and those of this
  /// machine; required for 0.0.0.0.
  std::vector<std::string> host_names = {};
  int port = 0;  ///< 0: any free port
  int max_clients = 8;
  /// Time after which a client that has stopped reading is disconnected; its page connects again.
  std::chrono::milliseconds max_stall{10'000};
  int send_buffer_bytes = 0;  ///< 0: the system's default; tests use a small one
};

/// WebServer owns the listening socket, a thread per connection and a writer per client.
class WebServer {
 public:
  static constexpr size_t kMaxRequestBytes = 32768;  // proxies add headers and cookies
  static constexpr size_t kMaxClientMessageBytes = 4096;

  /// Listens and serves `page` at "/" and the socket at "/ws". Throws EnvironmentError if the port
  /// is taken, InputError if no browser could name the address.
  WebServer(const WebOptions& options, std::string_view page, WebHandlers handlers);
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  int port() const { return port_; }
  std::string url() const;

  /// These send to every client; frames are shared, not copied.
  void offer_frame(const SharedBytes& frame);
  void send_text(const std::string& text);
  void send_binary(const SharedBytes& bytes);
  size_t client_count() const;
  /// Returns the number of frames dropped for present and former clients.
  uint64_t frames_dropped() const;
  /// Returns the number of clients that were disconnected because they had stopped reading.
  uint64_t stalled() const { return stalled_; }
  /// Returns the number of rejected requests: foreign origin, excess clients, malformed HTTP.
  uint64_t rejected() const { return rejected_; }
  /// Returns why a page or its socket was refused last; "" if none was.
  std::string refusal() const;

 private:
  struct Connection;
  void accept_loop();
  void serve(Connection& connection);
  void reject_socket(int descriptor, const struct HttpRequest& request);
  void serve_socket(Connection& connection, const struct HttpRequest& request, Bytes rest);
  void read_messages(Connection& connection, WebClient& client, Bytes buffer);
  void reply(int descriptor, std::string_view status, std::string_view type, std::string_view body);
  void join_finished();
  template <typename Do>
  void for_each_client(const Do& act) const;

  WebOptions options_;
  std::string_view page_;
  WebHandlers handlers_;
  int listener_ = -1;
  int port_ = 0;
  std::atomic<bool> stopping_{false};
  std::atomic<uint64_t> rejected_{0};
  std::atomic<uint64_t> past_drops_{0};
  std::atomic<uint64_t> stalled_{0};
  mutable std::mutex mutex_;
  std::string refusal_;
  std::list<std::unique_ptr<Connection>> connections_;
  std::list<std::shared_ptr<WebClient>> clients_;
  std::thread acceptor_;
};

}  // namespace throng
