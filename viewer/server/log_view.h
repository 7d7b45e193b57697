// A log behind the page: each client plays, steps and scrubs on its own.
// One rule: the client asks for a frame and gets it; no clock runs here.
#pragma once

#include <filesystem>

#include "viewer/server/log_player.h"
#include "viewer/server/web_server.h"

namespace throng {

class LogView {
 public:
  /// Throws InputError if the log cannot be shown, EnvironmentError if the port is taken. Keeps no
  /// reference to `page` but its bytes, which must outlive it.
  LogView(const std::filesystem::path& log, const WebOptions& options, std::string_view page);

  WebServer& server() { return server_; }
  const LogIndex& index() const { return index_; }

 private:
  struct Player;
  void opened(const std::shared_ptr<WebClient>& client);
  void said(WebClient& client, std::string_view text);

  LogIndex index_;
  RunReader description_;
  RunGeometry geometry_;
  SharedBytes run_message_;
  WebServer server_;  // last: its threads use the rest
};

}  // namespace throng
