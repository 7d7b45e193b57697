// Tests the server: one page, a limited number of clients, no caller that waits.
#include "viewer/server/web_server.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <future>
#include <list>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "base/errors.h"
#include "tests/viewer/web_socket.h"

namespace throng::web_server_test {
namespace {

using namespace std::chrono_literals;

constexpr std::string_view kPage = "<!doctype html><p>crowd";
constexpr const char* kAccepted = "HTTP/1.1 101 Switching Protocols";

SharedBytes frame_of(size_t size, uint8_t value) { return std::make_shared<Bytes>(size, value); }

/// Waits for a condition that another thread fulfils, up to 5 s.
template <typename Condition>
bool soon(const Condition& condition) {
  for (int i = 0; i < 1000 && !condition(); ++i) std::this_thread::sleep_for(5ms);
  return condition();
}

TEST(WebServer, ServesThePage) {
  WebServer server({}, kPage, {});
  TestSocket browser(server.port());
  browser.send("GET / HTTP/1.1\r\nHost: localhost\r\n\r\n");
  const std::string head = browser.read_head();
  EXPECT_TRUE(head.starts_with("HTTP/1.1 200 OK\r\n")) << head;
  EXPECT_NE(head.find("Content-Length: " + std::to_string(kPage.size())), std::string::npos);
  EXPECT_NE(head.find("X-Frame-Options: DENY"), std::string::npos);
}

TEST(WebServer, ReturnsErrorStatuses) {
  WebServer server({}, kPage, {});
  const std::pair<const char*, const char*> cases[] = {
      {"GET /etc/passwd HTTP/1.1\r\nHost: localhost\r\n\r\n", "404"},
      {"GET /../page HTTP/1.1\r\nHost: localhost\r\n\r\n", "404"},
      {"POST / HTTP/1.1\r\nHost: localhost\r\n\r\n", "405"},
      {"GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n", "403"},
      {"GET /ws HTTP/1.1\r\nHost: localhost\r\n\r\n", "426"},
      {"nonsense\r\n\r\n", "400"},
  };
  for (const auto& [request, status] : cases) {
    TestSocket browser(server.port());
    browser.send(request);
    EXPECT_EQ(browser.read_head().substr(9, 3), status) << request;
  }
}

TEST(WebServer, ClosesOnAnEndlessHead) {
  WebServer server({}, kPage, {});
  TestSocket browser(server.port());
  browser.send("GET / HTTP/1.1\r\nX: " + std::string(3 * WebServer::kMaxRequestBytes, 'x'));
  EXPECT_TRUE(browser.is_closed());
  EXPECT_EQ(server.rejected(), 1u);
}

TEST(WebServer, RejectsForeignOrigins) {
  WebServer server({}, kPage, {});
  TestSocket evil(server.port());
  EXPECT_EQ(evil.open("http://evil.example"), "HTTP/1.1 403 Forbidden");
  TestSocket rebound(server.port());
  EXPECT_EQ(rebound.open("http://evil.example:80", "evil.example:80"), "HTTP/1.1 403 Forbidden");
  TestSocket own(server.port());
  EXPECT_EQ(own.open("http://127.0.0.1:" + std::to_string(server.port())), kAccepted);
  EXPECT_EQ(server.rejected(), 2u);
}

TEST(WebServer, StatesWhyItRefusedAPage) {
  WebServer server({}, kPage, {});
  EXPECT_EQ(server.refusal(), "");
  TestSocket browser(server.port());
  browser.send("GET / HTTP/1.1\r\nHost: hub.example.org\r\n\r\n");
  EXPECT_TRUE(browser.read_head().starts_with("HTTP/1.1 403 Forbidden\r\n"));
  EXPECT_EQ(server.refusal(),
            "expected this machine or a --host-name as Host, found 'hub.example.org'");
}

TEST(WebServer, ServesAProxyWithAnAllowedHostName) {
  WebServer server({.host_names = {"hub.example.org"}}, kPage, {});
  TestSocket browser(server.port());
  EXPECT_EQ(browser.open("https://hub.example.org", "hub.example.org"), kAccepted);
  TestSocket evil(server.port());
  EXPECT_EQ(evil.open("https://evil.example", "hub.example.org"), "HTTP/1.1 403 Forbidden");
  EXPECT_EQ(server.url(), "http://127.0.0.1:" + std::to_string(server.port()) + "/");
}

TEST(WebServer, NeedsAHostNameOnTheNetwork) {
  try {
    const WebServer server({.address = "0.0.0.0"}, kPage, {});
    FAIL() << "a server that no browser may name";
  } catch (const InputError& error) {
    const std::string what = error.what();
    EXPECT_TRUE(
        what.starts_with("--address 0.0.0.0: expected a --host-name NAME that browsers "
                         "use, found none; add for example --host-name "))
        << what;
  }
  WebServer server({.address = "0.0.0.0", .host_names = {"crowd.lan"}}, kPage, {});
  const std::string host = "crowd.lan:" + std::to_string(server.port());
  EXPECT_EQ(server.url(), "http://" + host + "/");
  TestSocket own(server.port()), rebound(server.port());
  EXPECT_EQ(own.open("http://" + host, host), kAccepted);
  EXPECT_EQ(rebound.open("http://evil.example", "evil.example"), "HTTP/1.1 403 Forbidden");
}

TEST(WebServer, LimitsTheNumberOfClients) {
  WebServer server({.max_clients = 2}, kPage, {});
  TestSocket first(server.port()), third(server.port());
  {
    TestSocket second(server.port());
    EXPECT_EQ(first.open(), kAccepted);
    EXPECT_EQ(second.open(), kAccepted);
    EXPECT_EQ(third.open(), "HTTP/1.1 503 Service Unavailable");
  }
  // A browser hides the status from its page: the socket states the reason.
  {
    const std::string own = "http://127.0.0.1:" + std::to_string(server.port());
    TestSocket second(server.port()), page(server.port());
    ASSERT_TRUE(soon([&] { return server.client_count() == 1; }));
    EXPECT_EQ(second.open(), kAccepted);
    EXPECT_EQ(page.open(own), kAccepted);
    const auto message = page.read_message();
    ASSERT_TRUE(message);
    EXPECT_EQ(message->opcode, Opcode::kClose);
    EXPECT_EQ(message->payload, close_payload(kTryAgainLater, "2 pages are open"));
    EXPECT_TRUE(page.is_closed());
    EXPECT_EQ(server.client_count(), 2u);
  }
  // A client that left frees its place.
  ASSERT_TRUE(soon([&] { return server.client_count() == 1; }));
  TestSocket fourth(server.port());
  EXPECT_EQ(fourth.open(), kAccepted);
}

TEST(WebServer, SendsMessagesInOrder) {
  WebServer server({}, kPage,
                   {[](const std::shared_ptr<WebClient>& client) {
                      client->send_binary(frame_of(70000, 1));
                      client->send_text("then this");
                    },
                    {}});
  TestSocket browser(server.port());
  ASSERT_EQ(browser.open(), kAccepted);
  auto message = browser.read_message();
  ASSERT_TRUE(message);
  EXPECT_EQ(message->opcode, Opcode::kBinary);
  EXPECT_EQ(message->payload, std::string(70000, '\1'));
  message = browser.read_message();
  ASSERT_TRUE(message);
  EXPECT_EQ(message->payload, "then this");
  server.offer_frame(frame_of(200, 2));
  message = browser.read_message();
  ASSERT_TRUE(message);
  EXPECT_EQ(message->payload, std::string(200, '\2'));
}

TEST(WebServer, ReceivesTextAndAnswersPings) {
  std::string received;
  WebServer server({}, kPage, {{}, [&](WebClient& client, std::string_view text) {
                                 received += text;
                                 client.send_text("received");
                               }});
  TestSocket browser(server.port());
  ASSERT_EQ(browser.open(), kAccepted);
  browser.send_frame(Opcode::kText, "who is ");
  browser.send_frame(Opcode::kText, "there");
  EXPECT_TRUE(browser.read_message() && browser.read_message());
  EXPECT_EQ(received, "who is there");
  browser.send_frame(Opcode::kPing, "alive?");
  const auto pong = browser.read_message();
  ASSERT_TRUE(pong);
  EXPECT_EQ(pong->opcode, Opcode::kPong);
  EXPECT_EQ(pong->payload, "alive?");
}

TEST(WebServer, DisconnectsClientsWithLongMessages) {
  WebServer server({}, kPage, {});
  TestSocket browser(server.port());
  ASSERT_EQ(browser.open(), kAccepted);
  browser.send_frame(Opcode::kText, std::string(WebServer::kMaxClientMessageBytes + 1, 'x'));
  EXPECT_TRUE(browser.is_closed());
  EXPECT_TRUE(soon([&] { return server.client_count() == 0; }));
}

// Offering frames returns at once even if a client stalls. Dropped frames are counted, and other
// clients get every frame.
TEST(WebServer, ServesOthersDespiteAStalledClient) {
  WebServer server({.max_stall = 10min, .send_buffer_bytes = 65536}, kPage, {});
  TestSocket stalled(server.port(), 4096), reader(server.port());
  ASSERT_EQ(stalled.open(), kAccepted);
  ASSERT_EQ(reader.open(), kAccepted);
  ASSERT_TRUE(soon([&] { return server.client_count() == 2; }));
  constexpr int kFrames = 60;
  for (int i = 0; i < kFrames; ++i) {
    server.offer_frame(frame_of(1 << 19, static_cast<uint8_t>(i)));
    const auto got = reader.read_message();  // `stalled` never reads
    ASSERT_TRUE(got) << "frame " << i;
    ASSERT_EQ(static_cast<uint8_t>(got->payload[0]), i) << "the reader missed a frame";
  }
  // One frame is being sent, one waits as the newest; all others were dropped.
  EXPECT_EQ(server.frames_dropped(), static_cast<uint64_t>(kFrames) - 2);
}

// Twenty pages that never read neither take the places of others for good nor keep frames.
TEST(WebServer, DisconnectsClientsThatStoppedReading) {
  constexpr size_t kStalled = 20;
  WebServer server({.max_clients = kStalled + 1, .max_stall = 2s, .send_buffer_bytes = 4096}, kPage,
                   {});
  std::list<TestSocket> stalled;
  for (size_t i = 0; i < kStalled; ++i)
    ASSERT_EQ(stalled.emplace_back(server.port(), 4096).open(), kAccepted);
  TestSocket reader(server.port());
  ASSERT_EQ(reader.open(), kAccepted);
  ASSERT_TRUE(soon([&] { return server.client_count() == kStalled + 1; }));
  std::vector<std::weak_ptr<const Bytes>> offered;
  for (int i = 0; server.client_count() > 1; ++i) {
    ASSERT_LT(i, 1000) << server.client_count() - 1 << " pages that do not read stay connected";
    const SharedBytes frame = frame_of(1 << 18, static_cast<uint8_t>(i));
    server.offer_frame(frame);
    offered.push_back(frame);
    const auto got = reader.read_message();
    ASSERT_TRUE(got) << "frame " << i;
    ASSERT_EQ(static_cast<uint8_t>(got->payload[0]), static_cast<uint8_t>(i))
        << "the reader missed a frame";
    // Each page may hold the frame that is being sent to it, and the newest.
    const auto alive = std::count_if(offered.begin(), offered.end(),
                                     [](const auto& each) { return !each.expired(); });
    ASSERT_LE(alive, static_cast<std::ptrdiff_t>(kStalled) + 2);
    std::this_thread::sleep_for(10ms);
  }
  EXPECT_EQ(server.stalled(), kStalled);
  TestSocket next(server.port());
  EXPECT_EQ(next.open(), kAccepted);
}

TEST(WebServer, DisconnectsIdleClientsThatAnswerNoPings) {
  WebServer server({.max_stall = 1s}, kPage, {});
  TestSocket idle(server.port()), reader(server.port());
  ASSERT_EQ(idle.open(), kAccepted);
  ASSERT_EQ(reader.open(), kAccepted);
  ASSERT_TRUE(soon([&] { return server.client_count() == 2; }));
  for (int i = 0; server.client_count() == 2; ++i) {
    ASSERT_LT(i, 1000) << "an idle client stays connected";
    server.send_text("all of this fits into the buffers of a socket");
    ASSERT_TRUE(reader.read_message());
    std::this_thread::sleep_for(20ms);
  }
  EXPECT_TRUE(idle.is_closed());
  EXPECT_EQ(server.stalled(), 1u);
}

TEST(WebServer, LimitsWhatWaitsForAClient) {
  std::promise<std::shared_ptr<WebClient>> opened;
  WebServer server(
      {.send_buffer_bytes = 4096}, kPage,
      {[&](const std::shared_ptr<WebClient>& client) { opened.set_value(client); }, {}});
  TestSocket stalled(server.port(), 4096);
  ASSERT_EQ(stalled.open(), kAccepted);
  const std::shared_ptr<WebClient> client = opened.get_future().get();
  std::vector<std::weak_ptr<const Bytes>> sent;
  for (int i = 0; i < 60; ++i) {
    const SharedBytes answer = frame_of(1 << 20, 0);
    client->send_binary(answer);
    sent.push_back(answer);
  }
  EXPECT_TRUE(soon([&] { return server.client_count() == 0; }));
  EXPECT_TRUE(client->has_stalled());
  const auto alive =
      std::count_if(sent.begin(), sent.end(), [](const auto& each) { return !each.expired(); });
  EXPECT_LE(alive, 17) << "megabytes wait for a client that does not read";
}

TEST(WebServer, ReportsATakenPort) {
  const WebServer first({}, kPage, {});
  try {
    const WebServer second({.port = first.port()}, kPage, {});
    FAIL() << "two servers on one port";
  } catch (const EnvironmentError& error) {
    EXPECT_NE(std::string(error.what()).find("--port"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace throng::web_server_test
