// Tests that browser requests and frames are parsed and all others rejected.
#include "viewer/server/web_protocol.h"

#include <gtest/gtest.h>

#include "base/random.h"

namespace throng::web_protocol_test {
namespace {

std::span<const uint8_t> as_bytes(const std::string& text) {
  return {reinterpret_cast<const uint8_t*>(text.data()), text.size()};
}

TEST(WebProtocol, ComputesTheKeyOfTheStandard) {
  // RFC 6455, section 1.3
  EXPECT_EQ(accept_key("dGhlIHNhbXBsZSBub25jZQ=="), "s3pPLMBiTxaQ9kYGzzhZRbK+xOo=");
}

TEST(WebProtocol, ParsesARequest) {
  const auto request = parse_request(
      "GET /ws?x=1 HTTP/1.1\r\nHost: localhost:7\r\nUPGRADE:  WebSocket \r\nSec-WebSocket-Key: "
      "k\r\n\r\n");
  ASSERT_TRUE(request);
  EXPECT_EQ(request->method, "GET");
  EXPECT_EQ(request->path, "/ws");
  EXPECT_EQ(request->header("upgrade"), "WebSocket");
  EXPECT_TRUE(request->is_web_socket_upgrade());
}

TEST(WebProtocol, RejectsMalformedRequests) {
  for (const char* text :
       {"", "GET", "GET /", "GET / SMTP\r\n\r\n", "GET / HTTP/1.1\r\nno colon\r\n\r\n"})
    EXPECT_FALSE(parse_request(text)) << text;
}

struct Visit {
  const char* host;
  const char* origin;
  bool loopback;
  bool is_own;
};

TEST(WebProtocol, AcceptsOnlyTheSameOrigin) {
  for (const Visit& visit : {
           Visit{"127.0.0.1:80", "", true, true},
           {"localhost:80", "http://localhost:80", true, true},
           {"[::1]:80", "http://[::1]:80", true, true},
           {"LOCALHOST:80", "http://localhost:80", true, true},
           {"127.0.0.1:80", "http://evil.example", true, false},
           {"127.0.0.1:80", "null", true, false},  // a page from disk, a sandboxed frame
           {"127.0.0.1:80", "http://127.0.0.1:81", true, false},
           {"evil.example:80", "http://evil.example:80", true, false},  // resolves to 127.0.0.1
           {"", "", true, false},
           {"crowd.lan:80", "http://crowd.lan:80", false, true},
           {"crowd.lan:80", "http://evil.example", false, false},
       }) {
    HttpRequest request;
    request.headers = {{"host", visit.host}, {"origin", visit.origin}};
    EXPECT_EQ(is_same_origin(request, visit.loopback), visit.is_own)
        << "host " << visit.host << ", origin " << visit.origin;
  }
}

std::string masked(std::string head, const std::string& payload) {
  head += std::string("\1\2\3\4", 4);
  for (size_t i = 0; i < payload.size(); ++i)
    head += static_cast<char>(payload[i] ^ static_cast<char>(i % 4 + 1));
  return head;
}

TEST(WebProtocol, UnmasksAFrame) {
  const std::string bytes = masked("\x81\x85", "hello") + "next";
  const ClientFrame frame = parse_frame(as_bytes(bytes), 100);
  ASSERT_EQ(frame.status, ClientFrame::Status::kComplete);
  EXPECT_EQ(frame.opcode, Opcode::kText);
  EXPECT_EQ(frame.payload, "hello");
  EXPECT_EQ(frame.bytes, bytes.size() - 4);
  for (size_t size = 0; size + 4 < bytes.size(); ++size)
    EXPECT_EQ(parse_frame(as_bytes(bytes.substr(0, size)), 100).status,
              ClientFrame::Status::kIncomplete)
        << size << " bytes";
}

TEST(WebProtocol, RejectsALongFrameByItsHead) {
  const std::string huge = std::string("\x82\xff\x00\x00\x00\x40\x00\x00\x00\x00", 10) + "mask";
  EXPECT_EQ(parse_frame(as_bytes(huge), 4096).status, ClientFrame::Status::kRejected);
  const std::string wraps = std::string("\x82\xff\xff\xff\xff\xff\xff\xff\xff\xff", 10) + "mask";
  EXPECT_EQ(parse_frame(as_bytes(wraps), 4096).status, ClientFrame::Status::kRejected);
}

TEST(WebProtocol, RejectsFramesThatBrowsersNeverSend) {
  EXPECT_EQ(parse_frame(as_bytes("\x81\x05hello"), 100).status, ClientFrame::Status::kRejected)
      << "not masked";
  EXPECT_EQ(parse_frame(as_bytes(masked("\x01\x85", "hello")), 100).status,
            ClientFrame::Status::kRejected)
      << "fragmented";
  EXPECT_EQ(parse_frame(as_bytes(masked("\xc1\x85", "hello")), 100).status,
            ClientFrame::Status::kRejected)
      << "compressed";
  EXPECT_EQ(parse_frame(as_bytes(masked("\x83\x85", "hello")), 100).status,
            ClientFrame::Status::kRejected)
      << "unknown opcode";
}

TEST(WebProtocol, SurvivesAnyBytes) {
  constexpr uint64_t kSeed = 20;
  int whole = 0;
  for (uint64_t round = 0; round < 20000; ++round) {
    std::string bytes;
    const uint64_t size = random_bits({.seed = kSeed, .id = round}) % 40;
    for (uint64_t i = 0; i < size; ++i)
      bytes += static_cast<char>(random_bits({.seed = kSeed, .id = round, .step = i + 1}));
    const ClientFrame frame = parse_frame(as_bytes(bytes), 64);
    if (frame.status != ClientFrame::Status::kComplete) continue;
    ++whole;
    ASSERT_LE(frame.bytes, bytes.size());
    ASSERT_LE(frame.payload.size(), 64u);
  }
  EXPECT_GT(whole, 0) << "the test makes no valid frames, seed " << kSeed;
}

}  // namespace
}  // namespace throng::web_protocol_test
