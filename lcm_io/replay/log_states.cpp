#include "lcm_io/replay/log_states.h"

#include "base/checksum.h"

namespace throng {

LogStates::LogStates(const std::filesystem::path& file, std::vector<DamagedSpan> damage)
    : log_(file), damage_(std::move(damage)) {}

bool LogStates::next() {
  LogEvent event;
  while (!is_over_) {
    const LogReader::Status status = log_.next(event);
    if (status == LogReader::Status::kEvent) {
      if (take(event)) return true;
    } else if (status == LogReader::Status::kEnd) {
      is_over_ = true;
    } else {
      is_damaged_ = has_gap_ = true;
      is_over_ = !log_.resync();
    }
  }
  return false;
}

/// Returns true if the message completes states.
bool LogStates::take(const LogEvent& event) {
  const std::optional<Channel> channel = channel_of(event.channel);
  if (channel != Channel::kRun && channel != Channel::kStates) return false;
  MessageHeader header;
  if (!read_header(*channel, event.data, header).empty() || !belongs_to_run(*channel, header))
    return false;
  if (is_damaged_at(*channel, event.offset)) {
    has_gap_ = has_gap_ || channel == Channel::kStates;
    rejection_ = "damaged, according to the checksums in the log";
    return false;
  }
  if (channel == Channel::kRun) {
    if (run_.run() == nullptr) hash_.add(checksum(event.data.subspan(kHeaderBytes)));
    if (run_.take(event.channel, event.data) == RunReader::Update::kRejected)
      rejection_ = run_.rejection();
    return false;
  }
  has_gap_ = has_gap_ || header.seq != next_seq_;
  next_seq_ = header.seq < INT64_MAX ? header.seq + 1 : 0;
  hash_.add(checksum(event.data.subspan(kHeaderBytes)));
  const RunReader::Update update = run_.take(event.channel, event.data);
  if (update == RunReader::Update::kRejected) {
    has_gap_ = true;
    rejection_ = run_.rejection();
  }
  if (update != RunReader::Update::kState) return false;
  is_behind_gap_ = has_gap_ && frame_ >= 0;
  has_gap_ = false;
  frames_since_ = frame_ < 0 ? 0 : state().frame - frame_;
  frame_ = state().frame;
  hash_.add(static_cast<uint64_t>(frames_since_));
  return true;
}

/// Follows the run that is described first.
bool LogStates::belongs_to_run(Channel channel, const MessageHeader& header) {
  const std::pair id(header.run_id, header.instance);
  if (!id_ && channel == Channel::kRun) id_ = id;
  if (!id_) return false;
  // The same run starts again in this log.
  const bool begins_anew = channel == Channel::kRun && header.seq == 0 && frame_ >= 0;
  if (id == id_ && !begins_anew) return true;
  has_other_runs_ = true;
  is_over_ = is_over_ || begins_anew;
  return false;
}

bool LogStates::is_damaged_at(Channel channel, uint64_t byte) {
  while (next_damage_ < damage_.size() && damage_[next_damage_].to_byte <= byte) ++next_damage_;
  for (size_t i = next_damage_; i < damage_.size() && damage_[i].from_byte <= byte; ++i)
    if (damage_[i].contains(channel, byte)) return true;
  return false;
}

}  // namespace throng
