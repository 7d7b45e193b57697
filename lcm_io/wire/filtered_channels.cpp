#include "lcm_io/wire/filtered_channels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cctype>
#include <charconv>
#include <chrono>

#include "base/errors.h"
#include "lcm_io/codec/rows.h"
#include "scenes/run/named_bodies.h"

namespace throng {
namespace {

constexpr size_t kMaxFilteredChannel =
    63 - std::string_view("_PROXIMITY").size();  // limit of liblcm, minus the longest suffix

int64_t now_ns() {
  return std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
}

int64_t body_of(const std::string& who) {
  int64_t body = -1;
  const auto [end, error] = std::from_chars(who.data(), who.data() + who.size(), body);
  return error == std::errc() && end == who.data() + who.size() ? body : -1;
}

}  // namespace

FilteredChannel parse_filtered_channel(const std::string& text) {
  const size_t colon = text.rfind(':');
  FilteredChannel own;
  if (colon != std::string::npos) own = {text.substr(0, colon), text.substr(colon + 1)};
  const auto is_fine = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; };
  if (own.who.empty() || own.channel.empty() || own.channel.size() > kMaxFilteredChannel ||
      own.channel.starts_with("THRONG_") ||
      !std::all_of(own.channel.begin(), own.channel.end(), is_fine))
    throw InputError("--publish-for",
                     fmt::format("WHO:CHANNEL, WHO a group, a body id or all, CHANNEL 1 "
                                 "to {} letters, digits or '_', not beginning with THRONG_",
                                 kMaxFilteredChannel),
                     fmt::format("'{}'", text));
  return own;
}

FilteredChannels::FilteredChannels(const RunInfo& run, std::span<const FilteredChannel> requested)
    : buffer_(kMaxMessageBytes) {
  const NamedBodies named(run);
  const int64_t bodies = run.avatar_count() + static_cast<int64_t>(run.scene->obstacles.size());
  for (const FilteredChannel& own : requested) {
    Subscriber& subscriber = subscribers_.emplace_back();
    PublishedTotals& totals = totals_.emplace_back();
    totals.to = own;
    subscriber.events.channel = own.channel + "_EVENTS";
    subscriber.proximity.channel = own.channel + "_PROXIMITY";
    subscriber.stamp.channel = own.channel + "_STAMP";
    const int64_t body = body_of(own.who);
    const bool is_body = body >= 0 && body < bodies;
    subscriber.is_selected = named.of(own.who);
    if (is_body) {
      std::fill(subscriber.is_selected.begin(), subscriber.is_selected.end(), uint8_t{0});
      subscriber.is_selected[static_cast<size_t>(body)] = 1;
    }
    totals.bodies = std::count(subscriber.is_selected.begin(), subscriber.is_selected.end(), 1);
    const std::string namesake =
        is_body || NamedBodies::is_kind(own.who) ? named.namesake(own.who) : "";
    if (totals.bodies == 0 && own.who != kAll)
      throw InputError(
          "--publish-for",
          fmt::format("a group of {}, a body id from 0 to {}, or all{}", run.scene->name,
                      bodies - 1, did_you_mean(own.who, named.names())),
          fmt::format("'{}'{}", own.who,
                      namesake.empty() ? "" : ", which is not a body id; " + namesake));
    if (!namesake.empty())
      notes_.push_back(fmt::format("--publish-for: '{}' means {}; {}", own.who,
                                   is_body ? "the body with this id" : "all of that kind",
                                   namesake));
  }
}

void FilteredChannels::begin(const RunInfo& run) {
  run_id_ = static_cast<int64_t>(run.run_id);
  instance_ = static_cast<int64_t>(run.instance);
}

bool FilteredChannels::involves(const Subscriber& subscriber, const PairKey& pair) {
  const auto is_selected = [&subscriber](uint32_t body) {
    return body < subscriber.is_selected.size() && subscriber.is_selected[body] != 0;
  };
  return is_selected(pair.a()) || is_selected(pair.b());
}

void FilteredChannels::frame(const RunInfo& run, const Frame& frame) {
  utime_us_ = frame.utime_us;
  frame_ = frame.number;
  for (size_t i = 0; i < subscribers_.size(); ++i) {
    send_events(i, frame.events);
    stamp_.proximity_rows = 0;
    if (run.culler.proximity.is_enabled()) send_proximity(i, run, frame);
    stamp_.events = static_cast<int32_t>(selected_events_.size());
    stamp_.culling_ns = frame.times == nullptr ? 0 : frame.times->culling_began_ns;
    stamp_.sent_ns = now_ns();
    send(i, subscribers_[i].stamp, stamp_, 0, 1);
  }
}

void FilteredChannels::end(const RunInfo&, const RunEnd& end) {
  utime_us_ = end.utime_us;
  frame_ = end.frames;
  for (size_t i = 0; i < subscribers_.size(); ++i) send_events(i, end.events);
}

void FilteredChannels::send_events(size_t i, std::span<const PairEvent> events) {
  selected_events_.clear();
  for (const PairEvent& event : events)
    if (involves(subscribers_[i], event.pair)) selected_events_.push_back(event);
  totals_[i].events += static_cast<int64_t>(selected_events_.size());
  const int chunks = chunks_of(selected_events_.size(), kRowsPerMessage<events_t>);
  for (int chunk = 0; chunk < chunks; ++chunk) {
    const size_t first = static_cast<size_t>(chunk) * kRowsPerMessage<events_t>;
    set_events(events_, std::span(selected_events_)
                            .subspan(first, std::min(kRowsPerMessage<events_t>,
                                                     selected_events_.size() - first)));
    send(i, subscribers_[i].events, events_, chunk, chunks);
  }
}

void FilteredChannels::send_proximity(size_t i, const RunInfo& run, const Frame& frame) {
  const auto choose = [&](const ProximityRows& all, std::vector<ProximityPair>& own) {
    own.clear();
    for (const ProximityPair& row : all)
      if (involves(subscribers_[i], row.pair)) own.push_back(row);
  };
  choose(frame.proximity_pairs, selected_pairs_);
  choose(frame.closest_parts, selected_closest_);
  const size_t rows = selected_pairs_.size() + selected_closest_.size();
  stamp_.proximity_rows = static_cast<int32_t>(rows);
  totals_[i].proximity_rows += static_cast<int64_t>(rows);
  // Sent also without rows, so that receivers learn of empty frames.
  const int chunks = std::max(1, chunks_of(rows, kRowsPerMessage<proximity_t>));
  for (int chunk = 0; chunk < chunks; ++chunk) {
    set_proximity_chunk(proximity_, run.culler.proximity, frame.proximity_hash, selected_pairs_,
                        selected_closest_,
                        static_cast<size_t>(chunk) * kRowsPerMessage<proximity_t>);
    send(i, subscribers_[i].proximity, proximity_, chunk, chunks);
  }
}

template <class Message>
void FilteredChannels::send(size_t i, OutputChannel& to, Message& message, int chunk, int chunks) {
  message.utime = utime_us_;
  message.run_id = run_id_;
  message.instance = instance_;
  message.frame = frame_;
  message.seq = to.seq++;
  message.chunk = chunk;
  message.chunk_count = chunks;
  message.schema = kSchema;
  const int size = message.encode(buffer_.data(), 0, static_cast<int>(buffer_.size()));
  assert(size > 0);
  ++totals_[i].messages;
  if (sink_ != nullptr) sink_->send(to.channel, {buffer_.data(), static_cast<size_t>(size)});
}

}  // namespace throng
