// LiveView receives runs over LCM and serves them to open pages.
// Invariant: it only listens, validates messages before use, and offers each page the newest frame.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "lcm_io/wire/receiver.h"
#include "viewer/server/frame_message.h"
#include "viewer/server/pair_history.h"
#include "viewer/server/proximity_message.h"
#include "viewer/server/web_server.h"

namespace throng {

class LiveView {
 public:
  /// Throws EnvironmentError if LCM cannot use the URL or the port is taken.
  LiveView(const std::string& lcm_url, const WebOptions& options, std::string_view page);
  LiveView(std::unique_ptr<Receiver> receiver, const WebOptions& options, std::string_view page,
           std::string lcm_url = std::string(kDefaultLcmUrl));
  ~LiveView();

  WebServer& server() { return server_; }
  uint64_t frames_received() const { return received_; }
  uint64_t frames_built() const { return built_; }

 private:
  void listen();
  void take(const ReceivedMessage& message);
  void begin_run();
  void note_ends();
  void end_run();
  void offer_frame();
  std::string waiting_message() const;
  int64_t missing() const;
  void send_status();
  void opened(const std::shared_ptr<WebClient>& client);
  void on_text(WebClient& client, std::string_view text);

  std::string lcm_url_;
  std::unique_ptr<Receiver> receiver_;
  // Used by the listening thread only.
  std::unique_ptr<RunGeometry> geometry_;
  std::unique_ptr<FrameMessages> messages_;
  PairBegins begins_;
  bool is_fresh_ = false;
  // A run ends all its pairs after its last frame, which keeps them.
  RunReader::Touching last_touching_;
  PairBegins::Begins last_begins_;

  std::atomic<uint64_t> received_{0}, built_{0};
  PairHistory history_;
  ProximityHistory proximity_;
  std::mutex mutex_;
  SharedBytes run_message_;
  std::string problem_;  ///< reason why the received run cannot be shown
  bool has_ended_ = false;
  std::atomic<bool> has_new_client_{false};  ///< a new page has no frame yet
  std::atomic<bool> stopping_{false};
  WebServer server_;
  std::thread thread_;  // last: uses all members above
};

}  // namespace throng
