// HTTP requests and WebSocket frames (RFC 6455) as far as a page on this machine needs them.
// One rule: pure functions over bytes that anybody may have sent; every length is checked before
// it is believed.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "viewer/server/little_endian.h"

namespace throng {

struct HttpRequest {
  std::string method;
  std::string path;                            ///< without the query
  std::map<std::string, std::string> headers;  ///< names in lower case

  std::string_view header(const std::string& name) const;
  bool is_web_socket_upgrade() const;
};

/// The request of a head that ends in an empty line; nothing if it is none.
std::optional<HttpRequest> parse_request(std::string_view head);

/// Whether the page may be served and the socket opened: a browser that another site's page drives
/// sends that site as Origin, or its name as Host. `loopback`: only names of this machine are
/// believed. Programs that send no Origin are no browsers.
bool is_same_origin(const HttpRequest& request, bool loopback);

/// Sec-WebSocket-Accept for a client's Sec-WebSocket-Key.
std::string accept_key(std::string_view key);

enum class Opcode : uint8_t { kText = 1, kBinary = 2, kClose = 8, kPing = 9, kPong = 10 };

/// The head of a server's frame of `size` bytes.
std::string frame_head(Opcode opcode, size_t size);

/// Of a close frame: why, to try again later (IANA's registry of WebSocket close codes).
inline constexpr uint16_t kTryAgainLater = 1013;
/// The payload of a close frame. `reason`: at most 123 bytes.
std::string close_payload(uint16_t code, std::string_view reason);

/// A client's frame at the start of `bytes`.
struct ClientFrame {
  enum class Status { kComplete, kIncomplete, kRefused };
  Status status = Status::kIncomplete;
  Opcode opcode = Opcode::kText;
  std::string payload;  ///< unmasked
  size_t bytes = 0;     ///< of the whole frame
};

/// Refused: longer than `most` bytes, unmasked, in pieces, or of no kind that we know.
ClientFrame parse_frame(std::span<const uint8_t> bytes, size_t max_bytes);

}  // namespace throng
