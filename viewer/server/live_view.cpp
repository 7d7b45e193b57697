#include "viewer/server/live_view.h"

#include <fmt/format.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/errors.h"
#include "lcm_io/codec/message_validation.h"
#include "viewer/picture/recorded_frame.h"
#include "viewer/server/view_query.h"

namespace throng {
namespace {

using Clock = std::chrono::steady_clock;
using nlohmann::json;

constexpr std::chrono::milliseconds kWait{50};
constexpr std::chrono::milliseconds kStatusPeriod{500};
constexpr const char* kEnded = R"({"end":true})";

std::string text_of(const json& message) {
  return message.dump(-1, ' ', false, json::error_handler_t::replace);
}

}  // namespace

LiveView::LiveView(const std::string& lcm_url, const WebOptions& options, std::string_view page)
    : LiveView(std::make_unique<Receiver>(lcm_url), options, page, lcm_url) {}

LiveView::LiveView(std::unique_ptr<Receiver> receiver, const WebOptions& options,
                   std::string_view page, std::string lcm_url)
    : lcm_url_(std::move(lcm_url)),
      receiver_(std::move(receiver)),
      server_(options, page,
              {[this](const std::shared_ptr<WebClient>& client) { opened(client); },
               [this](WebClient& client, std::string_view text) { on_text(client, text); }}),
      thread_([this] { listen(); }) {}

LiveView::~LiveView() {
  stopping_ = true;
  thread_.join();
}

/// Returns the text of the waiting page. The caller holds the lock.
std::string LiveView::waiting_message() const {
  std::string start = "throng run plaza --pace 1";
  if (lcm_url_ != kDefaultLcmUrl) start += fmt::format(" --lcm '{}'", lcm_url_);
  return text_of({{"waiting", problem_}, {"lcm", lcm_url_}, {"start", start}});
}

void LiveView::opened(const std::shared_ptr<WebClient>& client) {
  const std::lock_guard lock(mutex_);
  if (run_message_ == nullptr) return client->send_text(waiting_message());
  client->send_binary(run_message_);
  if (has_ended_) client->send_text(kEnded);
  has_new_client_ = true;
}

void LiveView::on_text(WebClient& client, std::string_view text) {
  const ViewQuery query = parse_view_query(text);
  if (query.person)
    client.send_text(history_.of(*query.person, query.frame.value_or(INT64_MAX), kHistoryPairs));
  if (query.contacts)
    client.send_binary(std::make_shared<Bytes>(
        history_.changes_from(*query.contacts, query.since.value_or(0), kMaxContacts)));
  if (query.proximity)
    client.send_binary(
        std::make_shared<Bytes>(proximity_.of(*query.proximity, query.since.value_or(0))));
}

void LiveView::begin_run() {
  RunReader& run = receiver_->inbox().run();
  messages_.reset();
  SharedBytes message;
  std::string trouble;
  try {
    require_people(*run.run(), lcm_url_);
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
    problem_ = trouble;
    has_ended_ = false;
    if (message == nullptr) server_.send_text(waiting_message());
  }
  if (message != nullptr) server_.send_binary(message);
}

void LiveView::take(const ReceivedMessage& message) {
  const RunReader& run = receiver_->inbox().run();
  if (begins_.take(run, message.update)) {
    history_.clear();
    proximity_.clear();
  }
  history_.add(begins_.changes());
  switch (message.update) {
    case RunReader::Update::kRun:
      begin_run();
      break;
    case RunReader::Update::kEvents:
      note_ends();
      break;
    case RunReader::Update::kProximity:
      proximity_.add(run);
      break;
    case RunReader::Update::kFrameStats:
      last_touching_.clear();
      last_begins_.clear();
      history_.complete(run.frame_stats()->frame, run.state());
      ++received_;
      is_fresh_ = true;
      break;
    case RunReader::Update::kEnd:
      end_run();
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

void LiveView::send_status() {
  const Inbox& inbox = receiver_->inbox();
  server_.send_text(text_of({{"status",
                              {{"received", received_.load()},
                               {"dropped", server_.frames_dropped()},
                               {"lost", missing()},
                               {"rejected", inbox.rejected()},
                               {"pages", server_.client_count()}}}}));
}

/// Keeps the pairs that ended after the newest frame, with their level in it.
void LiveView::note_ends() {
  for (const PairEvent& event : receiver_->inbox().run().new_events())
    if (event.kind == EventKind::kEnd) last_touching_.emplace(event.pair, event.level);
  for (const PairBegins::Change& change : begins_.changes())
    if (change.kind == PairBegins::ChangeKind::kEnded)
      last_begins_.emplace(change.pair, change.began);
}

void LiveView::end_run() {
  const RunReader::Touching& touching = receiver_->inbox().run().touching();
  last_touching_.insert(touching.begin(), touching.end());
  last_begins_.insert(begins_.all().begin(), begins_.all().end());
  const std::lock_guard lock(mutex_);
  has_ended_ = is_fresh_ = true;
  server_.send_text(kEnded);
}

void LiveView::offer_frame() {
  const RunReader& run = receiver_->inbox().run();
  if (messages_ == nullptr || server_.client_count() == 0 || run.run() == nullptr ||
      run.state().frame < 0 || !run.frame_stats())
    return;
  const bool is_over = run.end().has_value();
  server_.offer_frame(messages_->build(static_cast<double>(received_), run.frame_stats()->frame,
                                       is_over ? last_touching_ : run.touching(),
                                       is_over ? last_begins_ : begins_.all(), missing()));
  ++built_;
}

void LiveView::listen() {
  auto next_status = Clock::now();
  while (!stopping_) {
    receiver_->receive(kWait, [this](const ReceivedMessage& message) { take(message); });
    // One frame for all received messages: a slow page gets the newest.
    const bool is_due = std::exchange(is_fresh_, false);
    if (has_new_client_.exchange(false) || is_due) offer_frame();
    if (Clock::now() < next_status) continue;
    send_status();
    next_status = Clock::now() + kStatusPeriod;
  }
}

}  // namespace throng
