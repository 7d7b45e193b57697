// A WebSocket client for tests: says what a browser would say, or what it never would.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "viewer/server/web_protocol.h"

namespace throng {

class TestSocket {
 public:
  /// Connects; a small receive buffer makes a client that soon takes no more.
  explicit TestSocket(int port, int receive_buffer_bytes = 0);
  ~TestSocket();
  TestSocket(const TestSocket&) = delete;
  TestSocket& operator=(const TestSocket&) = delete;

  void send(std::string_view bytes);
  /// A masked frame of a client.
  void send_frame(Opcode opcode, std::string_view payload);
  /// Asks for the socket and reads the answer's first line.
  std::string open(const std::string& origin = "", const std::string& host = "");
  /// Reads up to an empty line; "" when the other side closed.
  std::string read_head();

  struct Message {
    Opcode opcode;
    std::string payload;
  };
  /// The next message; nothing when the other side closed or two seconds passed.
  std::optional<Message> read_message();
  /// True once the other side closed, within two seconds.
  bool is_closed();

 private:
  bool fill();
  int descriptor_;
  int port_;
  std::string buffer_;
};

}  // namespace throng
