// HTTP requests and WebSocket frames (RFC 6455), limited to the needs of a page on this machine.
// Invariant: pure functions over untrusted bytes; every length is checked before use.
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

/// Parses a request head that ends in an empty line; empty if it is none.
std::optional<HttpRequest> parse_request(std::string_view head);

/// Returns whether a text is a host name or address without scheme, port and path.
bool is_host_name(std::string_view text);

/// Returns why a request must not get the page or the socket; "" if it may. Browsers that another
/// site's page controls send that site as Origin or Host. `host_names`: further names of this
/// server or of a proxy. Requests without Origin do not come from scripts of a browser.
std::string refusal_of(const HttpRequest& request, std::span<const std::string> host_names);

std::string accept_key(std::string_view key);

enum class Opcode : uint8_t { kText = 1, kBinary = 2, kClose = 8, kPing = 9, kPong = 10 };

std::string frame_head(Opcode opcode, size_t size);

/// Close code: try again later (IANA's registry of WebSocket close codes).
inline constexpr uint16_t kTryAgainLater = 1013;
/// Returns the payload of a close frame. `reason`: at most 123 bytes.
std::string close_payload(uint16_t code, std::string_view reason);

/// A client frame at the start of a buffer.
struct ClientFrame {
  enum class Status { kComplete, kIncomplete, kRejected };
  Status status = Status::kIncomplete;
  Opcode opcode = Opcode::kText;
  std::string payload;  ///< unmasked
  size_t bytes = 0;     ///< size of the whole frame
};

/// Rejects frames that are longer than `max_bytes`, unmasked, fragmented or of an unknown kind.
ClientFrame parse_frame(std::span<const uint8_t> bytes, size_t max_bytes);

}  // namespace throng
