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
};

/// Returns whether a browser with this visit gets the page of a server with these host names.
bool is_served(const Visit& visit, const std::vector<std::string>& host_names) {
  HttpRequest request;
  request.headers = {{"host", visit.host}, {"origin", visit.origin}};
  return refusal_of(request, host_names).empty();
}

TEST(WebProtocol, ServesPagesOfThisMachineOnly) {
  for (const Visit& visit : {Visit{"127.0.0.1:80", ""},
                             {"localhost:80", "http://localhost:80"},
                             {"[::1]:80", "http://[::1]:80"},
                             {"LOCALHOST:80", "http://localhost:80"},
                             {"localhost:80", "https://localhost:80"}})  // a proxy with a key
    EXPECT_TRUE(is_served(visit, {})) << "host " << visit.host << ", origin " << visit.origin;
  for (const Visit& visit : {Visit{"127.0.0.1:80", "http://evil.example"},
                             {"127.0.0.1:80", "null"},  // a page from disk, a sandboxed frame
                             {"127.0.0.1:80", "http://127.0.0.1:81"},
                             {"127.0.0.1:80", "http://127.0.0.1:80.evil.example"},
                             {"127.0.0.1:80", "ftp://127.0.0.1:80"},
                             {"evil.example:80", "http://evil.example:80"},  // names 127.0.0.1
                             {"evil.example:80", ""},
                             {"localhost.evil.example", ""},
                             {"crowd.lan:80", "http://crowd.lan:80"},
                             {"", ""}})
    EXPECT_FALSE(is_served(visit, {})) << "host " << visit.host << ", origin " << visit.origin;
}

TEST(WebProtocol, ServesPagesOfAllowedHostNames) {
  const std::vector<std::string> names = {"Hub.example.org", "10.0.0.7"};
  for (const Visit& visit : {Visit{"hub.example.org", "https://hub.example.org"},
                             {"hub.example.org:8443", "https://hub.example.org:8443"},
                             {"HUB.example.org", "https://HUB.example.org"},
                             {"10.0.0.7:80", "http://10.0.0.7:80"},
                             {"localhost:80", "http://localhost:80"},
                             {"127.0.0.1:80", "https://hub.example.org"}})  // a proxy set Host
    EXPECT_TRUE(is_served(visit, names)) << "host " << visit.host << ", origin " << visit.origin;
  for (const Visit& visit : {Visit{"hub.example.org", "https://evil.example"},
                             {"hub.example.org", "http://hub.example.org:81"},
                             {"hub.example.org", "https://10.0.0.7"},
                             {"a.hub.example.org", ""},
                             {"hub.example.org.evil.example", ""},
                             {"127.0.0.1:80", "https://hub.example.org.evil.example"},
                             {"127.0.0.1:80", "null"},
                             {"evil.example", "https://hub.example.org"}})
    EXPECT_FALSE(is_served(visit, names)) << "host " << visit.host << ", origin " << visit.origin;
}

TEST(WebProtocol, NamesTheRefusedHostOrOriginAndTheRemedy) {
  HttpRequest request;
  request.headers = {{"host", "hub.example.org"}};
  EXPECT_EQ(refusal_of(request, {}),
            "expected this machine or a --host-name as Host, found 'hub.example.org'");
  request.headers = {{"host", "127.0.0.1"}, {"origin", "https://evil.example"}};
  EXPECT_EQ(refusal_of(request, {}),
            "expected this page or a --host-name as Origin, found 'https://evil.example'");
}

TEST(WebProtocol, TellsHostNamesFromAddressesOfPages) {
  for (const char* name : {"localhost", "crowd.lan", "10.0.0.7", "[fd00::7]", "a-b.example.org"})
    EXPECT_TRUE(is_host_name(name)) << name;
  for (const char* text : {"", "http://crowd.lan", "crowd.lan:80", "crowd.lan/x", "*.lan", "[]",
                           "[crowd]", "a b", "a,b"})
    EXPECT_FALSE(is_host_name(text)) << text;
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
