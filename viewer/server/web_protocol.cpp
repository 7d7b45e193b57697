#include "viewer/server/web_protocol.h"

#include <fmt/format.h>
#include <glib.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <memory>

#include "base/text.h"

namespace throng {
namespace {

std::string lower(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return out;
}

std::string_view trimmed(std::string_view text) {
  const size_t begin = text.find_first_not_of(" \t");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

/// Returns "localhost" for "localhost:8080" and "[::1]" for "[::1]:8080".
std::string_view name_in(std::string_view host) {
  const size_t bracket = host.find(']');
  const size_t colon = host.find(':', bracket == std::string_view::npos ? 0 : bracket);
  return host.substr(0, colon);
}

/// Returns "localhost:8080" for "https://localhost:8080"; "" if the page has no web address.
std::string_view host_of_origin(std::string_view origin) {
  for (const std::string_view scheme : {"http://", "https://"})
    if (origin.starts_with(scheme)) return origin.substr(scheme.size());
  return {};
}

}  // namespace

std::string_view HttpRequest::header(const std::string& name) const {
  const auto found = headers.find(name);
  return found == headers.end() ? std::string_view{} : found->second;
}

bool HttpRequest::is_web_socket_upgrade() const {
  return lower(header("upgrade")) == "websocket" && !header("sec-websocket-key").empty();
}

std::optional<HttpRequest> parse_request(std::string_view head) {
  HttpRequest request;
  const size_t first_end = head.find("\r\n");
  if (first_end == std::string_view::npos) return std::nullopt;
  const std::string_view first = head.substr(0, first_end);
  const size_t space = first.find(' ');
  const size_t second = space == std::string_view::npos ? space : first.find(' ', space + 1);
  if (second == std::string_view::npos || !first.substr(second + 1).starts_with("HTTP/1."))
    return std::nullopt;
  request.method = first.substr(0, space);
  const std::string_view target = first.substr(space + 1, second - space - 1);
  request.path = target.substr(0, target.find('?'));
  for (size_t at = first_end + 2; at < head.size();) {
    const size_t end = head.find("\r\n", at);
    if (end == std::string_view::npos || end == at) break;
    const std::string_view line = head.substr(at, end - at);
    const size_t colon = line.find(':');
    if (colon == std::string_view::npos) return std::nullopt;
    request.headers[lower(line.substr(0, colon))] = trimmed(line.substr(colon + 1));
    at = end + 2;
  }
  return request;
}

bool is_host_name(std::string_view text) {
  const bool is_bracketed = text.size() > 2 && text.front() == '[' && text.back() == ']';
  if (is_bracketed) text = text.substr(1, text.size() - 2);
  return !text.empty() && std::all_of(text.begin(), text.end(), [&](unsigned char c) {
    return is_bracketed ? std::isxdigit(c) != 0 || c == ':' || c == '.'
                        : std::isalnum(c) != 0 || c == '-' || c == '.' || c == '_';
  });
}

std::string refusal_of(const HttpRequest& request, std::span<const std::string> host_names) {
  const auto is_allowed = [&](std::string_view name) {
    return std::any_of(host_names.begin(), host_names.end(),
                       [&](const std::string& allowed) { return lower(allowed) == name; });
  };
  const std::string host = lower(request.header("host"));
  const std::string_view name = name_in(host);
  const bool is_local = name == "localhost" || name == "127.0.0.1" || name == "[::1]";
  if (!is_local && !is_allowed(name))
    return fmt::format("expected this machine or a --host-name as Host, found {}", in_quotes(host));
  const std::string origin = lower(request.header("origin"));
  if (origin.empty()) return "";
  const std::string_view from = host_of_origin(origin);
  if (from == host) return "";
  // A proxy on this machine may replace the public name in Host, but not in Origin.
  if (is_local && is_allowed(name_in(from))) return "";
  return fmt::format("expected this page or a --host-name as Origin, found {}", in_quotes(origin));
}

std::string accept_key(std::string_view key) {
  constexpr std::string_view kGuid = "258EAFA5-E914-47DA-95CA-C5AB0DC85B11";  // RFC 6455, 1.3
  const std::unique_ptr<GChecksum, void (*)(GChecksum*)> sum(g_checksum_new(G_CHECKSUM_SHA1),
                                                             g_checksum_free);
  for (const std::string_view text : {key, kGuid})
    g_checksum_update(sum.get(), reinterpret_cast<const guchar*>(text.data()),
                      static_cast<gssize>(text.size()));
  std::array<guchar, 20> digest{};
  gsize size = digest.size();
  g_checksum_get_digest(sum.get(), digest.data(), &size);
  const std::unique_ptr<gchar, void (*)(void*)> text(g_base64_encode(digest.data(), size), g_free);
  return text.get();
}

std::string frame_head(Opcode opcode, size_t size) {
  std::string head(1, static_cast<char>(0x80 | static_cast<int>(opcode)));
  int length_bytes = 0;
  if (size < 126) {
    head += static_cast<char>(size);
  } else {
    length_bytes = size < 65536 ? 2 : 8;
    head += static_cast<char>(length_bytes == 2 ? 126 : 127);
  }
  for (int i = length_bytes - 1; i >= 0; --i) head += static_cast<char>(size >> (8 * i) & 0xff);
  return head;
}

std::string close_payload(uint16_t code, std::string_view reason) {
  std::string payload = {static_cast<char>(code >> 8), static_cast<char>(code & 0xff)};
  return payload.append(reason);
}

ClientFrame parse_frame(std::span<const uint8_t> bytes, size_t max_bytes) {
  ClientFrame frame;
  if (bytes.size() < 2) return frame;
  frame.status = ClientFrame::Status::kRejected;
  const bool is_whole = (bytes[0] & 0x80) != 0;
  const bool is_masked = (bytes[1] & 0x80) != 0;
  const bool has_extension = (bytes[0] & 0x70) != 0;
  frame.opcode = static_cast<Opcode>(bytes[0] & 0x0f);
  constexpr std::array kKnownOpcodes = {Opcode::kText, Opcode::kBinary, Opcode::kClose,
                                        Opcode::kPing, Opcode::kPong};
  if (!is_whole || !is_masked || has_extension ||
      std::find(kKnownOpcodes.begin(), kKnownOpcodes.end(), frame.opcode) == kKnownOpcodes.end())
    return frame;
  uint64_t size = bytes[1] & 0x7f;
  const size_t length_bytes = size == 126 ? 2 : size == 127 ? 8 : 0;
  const size_t head = 2 + length_bytes + 4;
  if (bytes.size() < head) {
    frame.status = ClientFrame::Status::kIncomplete;
    return frame;
  }
  if (length_bytes > 0) size = 0;
  for (size_t i = 0; i < length_bytes; ++i) size = size << 8 | bytes[2 + i];
  if (size > max_bytes) return frame;
  frame.bytes = head + static_cast<size_t>(size);
  if (bytes.size() < frame.bytes) {
    frame.status = ClientFrame::Status::kIncomplete;
    return frame;
  }
  frame.payload.resize(static_cast<size_t>(size));
  for (size_t i = 0; i < frame.payload.size(); ++i)
    frame.payload[i] = static_cast<char>(bytes[head + i] ^ bytes[head - 4 + i % 4]);
  frame.status = ClientFrame::Status::kComplete;
  return frame;
}

}  // namespace throng
