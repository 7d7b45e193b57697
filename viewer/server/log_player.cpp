#include "viewer/server/log_player.h"

#include <algorithm>

namespace throng {

LogPlayer::LogPlayer(const LogIndex& index, const RunGeometry& geometry)
    : index_(index), reader_(index.log()), messages_(run_, geometry) {
  for (const std::vector<uint8_t>& piece : index.description())
    run_.take(name_of(Channel::kRun), piece);
}

void LogPlayer::jump(const LogIndex::Start& start) {
  run_.rewind();
  if (start.states.offset < start.touching.offset) {
    // The states are older than the list: they come alone.
    reader_.seek(start.states.offset);
    LogEvent event;
    while (run_.state().frame < start.states.frame &&
           reader_.next(event) == LogReader::Status::kEvent)
      if (event.channel == name_of(Channel::kStates)) run_.take(event.channel, event.data);
  }
  reader_.seek(start.touching.offset);
}

RunReader::Update LogPlayer::take(const LogEvent& event) {
  const RunReader::Update update = run_.take(event.channel, event.data);
  begins_.take(run_, update);
  return update;
}

void LogPlayer::read_to(int64_t frame, const LogIndex::Start& start) {
  LogEvent event;
  while (frame_ < frame) {
    const LogReader::Status status = reader_.next(event);
    if (status == LogReader::Status::kEnd) return;
    if (status != LogReader::Status::kEvent) {
      if (!skip_damage(reader_, status).goes_on) return;
      continue;
    }
    // States that newer ones replace before anybody sees them are not decoded.
    if (event.channel == name_of(Channel::kStates) && event.offset < start.states.offset) continue;
    // The counters are the last message of a frame.
    if (take(event) == RunReader::Update::kCounters) frame_ = run_.counters()->frame;
  }
}

std::shared_ptr<const Bytes> LogPlayer::frame(int64_t number) {
  const int64_t wanted = std::clamp(number, int64_t{0}, std::max(int64_t{0}, index_.last_frame()));
  const std::optional<LogIndex::Start> start = index_.start_of(wanted);
  if (!start) return nullptr;
  // Forward within a stretch is cheaper to read on than to jump, and so is a short way.
  const bool jumps = wanted < frame_ || reader_.offset() < start->touching.offset || frame_ < 0;
  if (jumps) {
    jump(*start);
    frame_ = -1;
  }
  read_to(wanted, *start);
  // What was skipped is known to the index, which is ahead of every player.
  if (jumps) begins_.set(index_.history().begins_at(wanted, run_.touching()), run_);
  return messages_.build(++built_, wanted, run_.touching(), begins_.all());
}

}  // namespace throng
