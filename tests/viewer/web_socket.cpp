#include "tests/viewer/web_socket.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <stdexcept>

namespace throng {
namespace {

// A busy machine under a sanitizer needs time for the first message of a run.
constexpr int kTimeoutMs = 60'000;

}  // namespace

TestSocket::TestSocket(int port, int receive_buffer_bytes)
    : descriptor_(::socket(AF_INET, SOCK_STREAM, 0)), port_(port) {
  if (receive_buffer_bytes > 0)
    ::setsockopt(descriptor_, SOL_SOCKET, SO_RCVBUF, &receive_buffer_bytes, sizeof(int));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(descriptor_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0)
    throw std::runtime_error("cannot connect to the server under test");
}

TestSocket::~TestSocket() { ::close(descriptor_); }

void TestSocket::send(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(descriptor_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent <= 0) return;  // the server closed; the test reads its reply
    bytes.remove_prefix(static_cast<size_t>(sent));
  }
}

void TestSocket::send_frame(Opcode opcode, std::string_view payload) {
  std::string bytes = frame_head(opcode, payload.size());
  bytes[1] = static_cast<char>(bytes[1] | '\x80');
  const std::string mask = "\x12\x34\x56\x78";
  bytes += mask;
  for (size_t i = 0; i < payload.size(); ++i)
    bytes += static_cast<char>(payload[i] ^ mask[i % mask.size()]);
  send(bytes);
}

std::string TestSocket::open(const std::string& origin, const std::string& host) {
  const std::string name = host.empty() ? "127.0.0.1:" + std::to_string(port_) : host;
  send("GET /ws HTTP/1.1\r\nHost: " + name +
       "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
       "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n" +
       (origin.empty() ? "" : "Origin: " + origin + "\r\n") + "\r\n");
  const std::string head = read_head();
  return head.substr(0, head.find("\r\n"));
}

bool TestSocket::fill() {
  pollfd readable{descriptor_, POLLIN, 0};
  if (::poll(&readable, 1, kTimeoutMs) <= 0) return false;
  char chunk[65536];
  const ssize_t got = ::recv(descriptor_, chunk, sizeof chunk, 0);
  if (got <= 0) return false;
  buffer_.append(chunk, static_cast<size_t>(got));
  return true;
}

std::string TestSocket::read_head() {
  size_t end;
  while ((end = buffer_.find("\r\n\r\n")) == std::string::npos)
    if (!fill()) return "";
  std::string head = buffer_.substr(0, end + 4);
  buffer_.erase(0, end + 4);
  return head;
}

std::optional<TestSocket::Message> TestSocket::read_message() {
  const auto byte = [this](size_t i) { return static_cast<uint8_t>(buffer_[i]); };
  const auto need = [this](size_t size) {
    while (buffer_.size() < size)
      if (!fill()) return false;
    return true;
  };
  if (!need(2)) return std::nullopt;
  const Opcode opcode = static_cast<Opcode>(byte(0) & 15);
  size_t size = byte(1), head = 2;
  const size_t length_bytes = size == 126 ? 2 : size == 127 ? 8 : 0;
  if (!need(head + length_bytes)) return std::nullopt;
  if (length_bytes > 0) size = 0;
  for (size_t i = 0; i < length_bytes; ++i) size = size << 8 | byte(head + i);
  head += length_bytes;
  if (!need(head + size)) return std::nullopt;
  Message message{opcode, buffer_.substr(head, size)};
  buffer_.erase(0, head + size);
  if (opcode != Opcode::kPing) return message;
  send_frame(Opcode::kPong, message.payload);
  return read_message();
}

bool TestSocket::is_closed() {
  buffer_.clear();
  for (;;) {
    pollfd readable{descriptor_, POLLIN, 0};
    if (::poll(&readable, 1, kTimeoutMs) <= 0) return false;
    char chunk[65536];
    if (::recv(descriptor_, chunk, sizeof chunk, 0) <= 0) return true;
  }
}

}  // namespace throng
