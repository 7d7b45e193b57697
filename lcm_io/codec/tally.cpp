#include "lcm_io/codec/tally.h"

#include <algorithm>
#include <optional>

namespace throng {
namespace {

// A network that loses every other message for a minute makes a few thousand.
constexpr size_t kMaxHoles = 4096;

}  // namespace

void ChannelTally::open(int64_t first, int64_t end) {
  missing += end - first;
  if (holes_.size() == kMaxHoles) holes_.erase(holes_.begin());
  const auto at = std::lower_bound(holes_.begin(), holes_.end(), first,
                                   [](const Hole& hole, int64_t seq) { return hole.first < seq; });
  holes_.insert(at, {first, end});
}

bool ChannelTally::fill(int64_t seq) {
  auto hole = std::upper_bound(holes_.begin(), holes_.end(), seq,
                               [](int64_t s, const Hole& h) { return s < h.first; });
  if (hole == holes_.begin()) return false;
  --hole;
  if (seq >= hole->end) return false;
  --missing;
  const Hole behind{seq + 1, hole->end};
  hole->end = seq;
  const bool is_before_empty = hole->first == hole->end;
  if (behind.first < behind.end) {
    if (is_before_empty)
      *hole = behind;
    else
      holes_.insert(hole + 1, behind);
  } else if (is_before_empty) {
    holes_.erase(hole);
  }
  return true;
}

void ChannelTally::count(const MessageHeader& header, size_t size) {
  const int64_t seq = header.seq;
  if (next_seq < 0) {
    next_seq = seq;
    before = seq;
  }
  if (seq >= next_seq) {
    if (seq > next_seq) open(next_seq, seq);
    next_seq = seq + 1;
  } else if (seq < before) {
    if (seq + 1 < before) open(seq + 1, before);
    before = seq;
    ++late;
  } else if (fill(seq)) {
    ++late;
  } else {
    ++repeated;
    return;
  }
  ++messages;
  bytes += static_cast<int64_t>(size);
  last_frame = std::max(last_frame, header.frame);
}

void ChannelTally::count_from_start() {
  if (next_seq < 0) next_seq = 0;
  if (before > 0) open(0, before);
  before = 0;
}

void ChannelTally::close(int64_t sent) {
  if (next_seq < 0) {
    next_seq = before = sent;  // no message was received: all may have been sent before
  } else if (sent > next_seq) {
    open(next_seq, sent);
    next_seq = sent;
  }
}

void RunTally::count(Channel channel, const MessageHeader& header, size_t bytes) {
  const bool is_start =
      header.frame == 0 || (channel == Channel::kRun && header.seq < header.chunk_count);
  if (is_start && !from_start) {
    from_start = true;
    for (ChannelTally& tally : channels) tally.count_from_start();
  }
  (*this)[channel].count(header, bytes);
}

void RunTally::close(const end_t& end) {
  ended = true;
  for (size_t i = 0; i < end.channels.size(); ++i)
    if (const std::optional<Channel> channel = channel_of(end.channels[i]))
      (*this)[*channel].close(end.messages[i]);
}

}  // namespace throng
