// TestSocket is a WebSocket client that sends valid and invalid bytes to a server under test.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "viewer/server/web_protocol.h"

namespace throng {

class TestSocket {
 public:
  /// Connects. A small receive buffer makes the client stop accepting data early.
  explicit TestSocket(int port, int receive_buffer_bytes = 0);
  ~TestSocket();
  TestSocket(const TestSocket&) = delete;
  TestSocket& operator=(const TestSocket&) = delete;

  void send(std::string_view bytes);
  /// Sends a masked client frame.
  void send_frame(Opcode opcode, std::string_view payload);
  /// Requests the socket and returns the first line of the reply.
  std::string open(const std::string& origin = "", const std::string& host = "");
  /// Reads up to an empty line; empty if the peer closed.
  std::string read_head();

  struct Message {
    Opcode opcode;
    std::string payload;
  };
  /// Returns the next message; none if the peer closed or kTimeoutMs passed. Answers pings.
  std::optional<Message> read_message();
  /// Returns true once the peer has closed; false after kTimeoutMs.
  bool is_closed();

 private:
  bool fill();
  int descriptor_;
  int port_;
  std::string buffer_;
};

}  // namespace throng
