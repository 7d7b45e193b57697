#include "lcm_io/wire/inbox.h"

#include <algorithm>

namespace throng {

RunTally& Inbox::run_of(const MessageHeader& header) {
  const auto is_same = [&header](const RunTally& run) {
    return run.run_id == header.run_id && run.instance == header.instance;
  };
  if (!runs_.empty() && is_same(runs_.back())) return runs_.back();
  const auto found = std::find_if(runs_.begin(), runs_.end(), is_same);
  RunTally run;
  if (found != runs_.end()) {
    run = std::move(*found);
    runs_.erase(found);
  } else {
    run.run_id = header.run_id;
    run.instance = header.instance;
    if (runs_.size() == kMaxRuns) runs_.pop_front();
  }
  runs_.push_back(std::move(run));
  return runs_.back();
}

RunReader::Update Inbox::take(std::string_view name, std::span<const uint8_t> bytes) {
  const std::optional<Channel> channel = channel_of(name);
  if (!channel) {
    ++others_;
    return RunReader::Update::kNothing;
  }
  ChannelTotals& totals = totals_[static_cast<size_t>(*channel)];
  ++totals.messages;
  totals.bytes += static_cast<int64_t>(bytes.size());
  const RunReader::Update update = run_.take(name, bytes);
  if (update == RunReader::Update::kRejected) {
    ++totals.rejected;
    totals.rejection = run_.rejection();
  }
  if (const MessageHeader* header = run_.header()) {
    RunTally& run = run_of(*header);
    run.count(*channel, *header, bytes.size());
    if (*channel == Channel::kEnd && !run.ended) {
      end_t end;
      if (decode(bytes, end).empty()) run.close(end);
    }
  }
  return update;
}

int64_t Inbox::rejected() const {
  int64_t sum = 0;
  for (const ChannelTotals& totals : totals_) sum += totals.rejected;
  return sum;
}

}  // namespace throng
