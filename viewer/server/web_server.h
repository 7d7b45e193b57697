// Serves one page and pushes messages to whoever has it open, over HTTP and WebSocket.
// One rule: nobody waits for a browser. A frame that a client did not take yet is replaced by the
// next one and counted; what a client sends and how many there are is bounded.
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

#include "viewer/server/little_endian.h"

namespace throng {

using SharedBytes = std::shared_ptr<const Bytes>;

/// A page that is open somewhere.
class WebClient {
 public:
  /// `descriptor` stays the server's, which closes it after finish().
  explicit WebClient(int descriptor);
  ~WebClient();

  /// Messages that must arrive, in order. A client that lets kMaxWaiting of them pile up is let
  /// go.
  void send_text(std::string text);
  void send_binary(SharedBytes bytes);
  /// The newest frame: replaces one that is still waiting. Never blocks.
  void offer_frame(SharedBytes frame);

  uint64_t frames_sent() const { return frames_sent_; }
  uint64_t frames_dropped() const { return frames_dropped_; }
  /// Ends the connection; the writer stops within a moment whatever the browser does.
  void finish();

  /// For whoever answers the client's questions.
  std::shared_ptr<void> state;

 private:
  friend class WebServer;
  static constexpr size_t kMaxWaiting = 64;
  struct Message {
    bool is_text = false;
    std::string text;
    SharedBytes bytes;
  };
  void enqueue(Message message);
  void write_loop();
  bool write(std::string_view bytes);
  bool write_message(const Message& message);
  void pong(std::string payload);

  int descriptor_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Message> waiting_;
  std::deque<std::string> pongs_;
  SharedBytes frame_;
  std::atomic<bool> finished_{false};
  std::atomic<uint64_t> frames_sent_{0};
  std::atomic<uint64_t> frames_dropped_{0};
  std::thread writer_;
};

/// Called from the thread of the client that it is about.
struct WebHandlers {
  std::function<void(const std::shared_ptr<WebClient>&)> opened;
  std::function<void(WebClient&, std::string_view text)> on_text;
};

struct WebOptions {
  std::string address = "127.0.0.1";
  int port = 0;  ///< 0: any that is free
  int max_clients = 8;
  int send_buffer_bytes = 0;  ///< 0: what the system gives; tests want a small one
};

class WebServer {
 public:
  static constexpr size_t kMaxRequestBytes = 8192;
  static constexpr size_t kMaxClientMessageBytes = 4096;

  /// Listens; serves `page` under "/" and the socket under "/ws". Throws EnvironmentError if the
  /// port is taken.
  WebServer(const WebOptions& options, std::string_view page, WebHandlers handlers);
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  int port() const { return port_; }
  std::string url() const;

  /// To every client; the frame is shared, not copied.
  void offer_frame(const SharedBytes& frame);
  void send_text(const std::string& text);
  void send_binary(const SharedBytes& bytes);
  size_t client_count() const;
  /// Frames that were dropped for clients that are open or were.
  uint64_t frames_dropped() const;
  /// Requests that were turned away: another site's page, too many clients, no HTTP.
  uint64_t refused() const { return refused_; }

 private:
  struct Connection;
  void accept_loop();
  void serve(Connection& connection);
  void refuse_socket(int descriptor, const struct HttpRequest& request);
  void serve_socket(Connection& connection, const struct HttpRequest& request, Bytes rest);
  void read_messages(Connection& connection, WebClient& client, Bytes buffer);
  void reply(int descriptor, std::string_view status, std::string_view type, std::string_view body);
  void join_finished();
  template <typename Do>
  void for_each_client(const Do& act) const;

  WebOptions options_;
  std::string_view page_;
  WebHandlers handlers_;
  bool loopback_;
  int listener_ = -1;
  int port_ = 0;
  std::atomic<bool> stopping_{false};
  std::atomic<uint64_t> refused_{0};
  std::atomic<uint64_t> past_drops_{0};
  mutable std::mutex mutex_;
  std::list<std::unique_ptr<Connection>> connections_;
  std::list<std::shared_ptr<WebClient>> clients_;
  std::thread acceptor_;
};

}  // namespace throng
