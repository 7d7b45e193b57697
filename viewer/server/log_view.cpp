#include "viewer/server/log_view.h"

#include "viewer/picture/recorded_frame.h"
#include "viewer/server/questions.h"

namespace throng {
namespace {

constexpr size_t kIndexSamples = 2000;

RunReader described(const LogIndex& index) {
  RunReader run;
  for (const std::vector<uint8_t>& piece : index.description())
    run.take(name_of(Channel::kRun), piece);
  require_people(*run.run(), index.log().string());
  return run;
}

}  // namespace

/// Behind WebClient::state; used by the client's own thread only.
struct LogView::Player {
  Player(const LogIndex& index, const RunGeometry& geometry) : player(index, geometry) {}
  LogPlayer player;
};

LogView::LogView(const std::filesystem::path& log, const WebOptions& options, std::string_view page)
    : index_(log),
      description_(described(index_)),
      geometry_(description_),
      run_message_(
          std::make_shared<Bytes>(throng::run_message(description_, geometry_, ViewMode::kLog))),
      server_(options, page,
              {[this](const std::shared_ptr<WebClient>& client) { opened(client); },
               [this](WebClient& client, std::string_view text) { said(client, text); }}) {}

void LogView::opened(const std::shared_ptr<WebClient>& client) {
  client->state = std::make_shared<Player>(index_, geometry_);
  client->send_binary(run_message_);
  client->send_text(index_.to_json(kIndexSamples));
}

void LogView::said(WebClient& client, std::string_view text) {
  auto& player = *static_cast<Player*>(client.state.get());
  const Question question = parse_question(text);
  if (question.index) client.send_text(index_.to_json(kIndexSamples));
  if (question.person) {
    client.send_text(
        index_.history().of(*question.person, question.frame.value_or(INT64_MAX), kHistoryPairs));
  } else if (question.frame) {
    if (SharedBytes frame = player.player.frame(*question.frame)) client.offer_frame(frame);
  }
}

}  // namespace throng
