#include "viewer/server/live_view.h"

#include <chrono>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/errors.h"
#include "lcmtypes/codec/guard.h"
#include "viewer/server/questions.h"

namespace throng {
namespace {

using Clock = std::chrono::steady_clock;
using nlohmann::json;

constexpr std::chrono::milliseconds kWait{50};
constexpr std::chrono::milliseconds kStatusPeriod{500};

std::string text_of(const json& message) {
  return message.dump(-1, ' ', false, json::error_handler_t::replace);
}

}  // namespace

LiveView::LiveView(const std::string& lcm_url, const WebOptions& options, std::string_view page)
    : LiveView(std::make_unique<Receiver>(lcm_url), options, page) {}

LiveView::LiveView(std::unique_ptr<Receiver> receiver, const WebOptions& options,
                   std::string_view page)
    : receiver_(std::move(receiver)),
      server_(options, page,
              {[this](const std::shared_ptr<WebClient>& client) { opened(client); },
               [this](WebClient& client, std::string_view text) { said(client, text); }}),
      thread_([this] { listen(); }) {}

LiveView::~LiveView() {
  stopping_ = true;
  thread_.join();
}

void LiveView::opened(const std::shared_ptr<WebClient>& client) {
  const std::lock_guard lock(mutex_);
  if (run_message_ != nullptr)
    client->send_binary(run_message_);
  else
    client->send_text(text_of({{"waiting", trouble_}}));
}

void LiveView::said(WebClient& client, std::string_view text) {
  const Question question = parse_question(text);
  if (question.person) client.send_text(history_.of(*question.person, INT64_MAX, kHistoryPairs));
}

void LiveView::begin_run() {
  RunReader& run = receiver_->inbox().run();
  messages_.reset();
  history_.clear();
  SharedBytes message;
  std::string trouble;
  try {
    geometry_ = std::make_unique<RunGeometry>(run);
    messages_ = std::make_unique<FrameMessages>(run, *geometry_);
    message = std::make_shared<Bytes>(throng::run_message(run, *geometry_, ViewMode::kLive));
  } catch (const InputError& error) {
    messages_.reset();
    trouble = error.what();
  }
  {
    const std::lock_guard lock(mutex_);
    run_message_ = message;
    trouble_ = trouble;
  }
  if (message != nullptr)
    server_.send_binary(message);
  else
    server_.send_text(text_of({{"waiting", trouble}}));
}

void LiveView::take(const ReceivedMessage& message) {
  const RunReader& run = receiver_->inbox().run();
  switch (message.update) {
    case RunReader::Update::kRun:
      begin_run();
      break;
    case RunReader::Update::kEvents: {
      MessageHeader header;
      if (read_header(Channel::kEvents, message.bytes, header).empty())
        history_.add(header.frame, run.new_events());
      break;
    }
    case RunReader::Update::kCounters:
      ++heard_;
      is_fresh_ = true;
      break;
    case RunReader::Update::kEnd:
      server_.send_text(R"({"end":true})");
      break;
    default:
      break;
  }
}

int64_t LiveView::missing() const {
  int64_t missing = 0;
  for (const Channel channel : kAllChannels)
    missing += receiver_->inbox().run().tally(channel).missing;
  return missing;
}

void LiveView::tell_status() {
  const Inbox& inbox = receiver_->inbox();
  server_.send_text(text_of({{"status",
                              {{"heard", heard_.load()},
                               {"dropped", server_.frames_dropped()},
                               {"lost", missing()},
                               {"refused", inbox.refused()},
                               {"pages", server_.client_count()}}}}));
}

void LiveView::listen() {
  auto next_status = Clock::now();
  while (!stopping_) {
    receiver_->receive(kWait, [this](const ReceivedMessage& message) { take(message); });
    // One frame for all that came: whoever is behind gets the newest.
    const RunReader& run = receiver_->inbox().run();
    if (std::exchange(is_fresh_, false) && messages_ != nullptr && server_.client_count() > 0 &&
        run.run() != nullptr && run.state().frame >= 0) {
      server_.offer_frame(
          messages_->build(static_cast<double>(heard_), run.state().frame, missing()));
      ++built_;
    }
    if (Clock::now() < next_status) continue;
    tell_status();
    next_status = Clock::now() + kStatusPeriod;
  }
}

}  // namespace throng
