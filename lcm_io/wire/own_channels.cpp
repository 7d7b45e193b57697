#include "lcm_io/wire/own_channels.h"

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

constexpr size_t kMaxOwnChannel =
    63 - std::string_view("_EVENTS").size();  // liblcm's, of the longest

int64_t now_ns() {
  return std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
}

/// The number of a body, or -1.
int64_t body_of(const std::string& who) {
  int64_t body = -1;
  const auto [end, error] = std::from_chars(who.data(), who.data() + who.size(), body);
  return error == std::errc() && end == who.data() + who.size() ? body : -1;
}

}  // namespace

OwnChannel own_channel_of(const std::string& text) {
  const size_t colon = text.rfind(':');
  OwnChannel own;
  if (colon != std::string::npos) own = {text.substr(0, colon), text.substr(colon + 1)};
  const auto is_fine = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; };
  if (own.who.empty() || own.channel.empty() || own.channel.size() > kMaxOwnChannel ||
      own.channel.starts_with("THRONG_") ||
      !std::all_of(own.channel.begin(), own.channel.end(), is_fine))
    throw InputError("--tell",
                     fmt::format("WHO:CHANNEL, WHO a group, the number of a body or all, CHANNEL 1 "
                                 "to {} letters, digits or '_', not beginning with THRONG_",
                                 kMaxOwnChannel),
                     fmt::format("'{}'", text));
  return own;
}

OwnChannels::OwnChannels(const RunInfo& run, std::span<const OwnChannel> asked)
    : buffer_(kMaxMessageBytes) {
  const NamedBodies named(run);
  const int64_t bodies = run.avatar_count() + static_cast<int64_t>(run.scene->obstacles.size());
  for (const OwnChannel& own : asked) {
    Party& party = parties_.emplace_back();
    Told& told = told_.emplace_back();
    told.to = own;
    party.events.channel = own.channel + "_EVENTS";
    party.near.channel = own.channel + "_NEAR";
    party.stamp.channel = own.channel + "_STAMP";
    const int64_t body = body_of(own.who);
    const bool is_body = body >= 0 && body < bodies;
    party.is_own = named.of(own.who);
    if (is_body) {
      std::fill(party.is_own.begin(), party.is_own.end(), uint8_t{0});
      party.is_own[static_cast<size_t>(body)] = 1;
    }
    told.bodies = std::count(party.is_own.begin(), party.is_own.end(), 1);
    const std::string namesake =
        is_body || NamedBodies::is_kind(own.who) ? named.namesake(own.who) : "";
    if (told.bodies == 0 && own.who != kAll)
      throw InputError("--tell",
                       fmt::format("a group of {}, a body from 0 to {}, or all{}", run.scene->name,
                                   bodies - 1, did_you_mean(own.who, named.names())),
                       fmt::format("'{}'{}", own.who,
                                   namesake.empty() ? "" : ", which no body is; " + namesake));
    if (!namesake.empty())
      notes_.push_back(fmt::format("--tell: '{}' means {}; {}", own.who,
                                   is_body ? "the body of this number" : "all of that kind",
                                   namesake));
  }
}

void OwnChannels::begin(const RunInfo& run) {
  run_id_ = static_cast<int64_t>(run.run_id);
  instance_ = static_cast<int64_t>(run.instance);
}

bool OwnChannels::names(const Party& party, const PairKey& pair) {
  const auto is_own = [&party](uint32_t body) {
    return body < party.is_own.size() && party.is_own[body] != 0;
  };
  return is_own(pair.a()) || is_own(pair.b());
}

void OwnChannels::frame(const RunInfo& run, const Frame& frame) {
  utime_us_ = frame.utime_us;
  frame_ = frame.number;
  for (size_t i = 0; i < parties_.size(); ++i) {
    tell_events(i, frame.events);
    stamp_.near_rows = 0;
    if (run.culler.near.is_asked()) tell_near(i, run, frame);
    stamp_.events = static_cast<int32_t>(own_events_.size());
    stamp_.culling_ns = frame.times == nullptr ? 0 : frame.times->culling_began_ns;
    stamp_.sent_ns = now_ns();
    send(i, parties_[i].stamp, stamp_, 0, 1);
  }
}

void OwnChannels::end(const RunInfo&, const RunEnd& end) {
  utime_us_ = end.utime_us;
  frame_ = end.frames;
  for (size_t i = 0; i < parties_.size(); ++i) tell_events(i, end.events);
}

void OwnChannels::tell_events(size_t i, std::span<const PairEvent> events) {
  own_events_.clear();
  for (const PairEvent& event : events)
    if (names(parties_[i], event.pair)) own_events_.push_back(event);
  told_[i].events += static_cast<int64_t>(own_events_.size());
  const int chunks = chunks_of(own_events_.size(), kRowsPerMessage<events_t>);
  for (int chunk = 0; chunk < chunks; ++chunk) {
    const size_t first = static_cast<size_t>(chunk) * kRowsPerMessage<events_t>;
    set_events(events_, std::span(own_events_)
                            .subspan(first, std::min(kRowsPerMessage<events_t>,
                                                     own_events_.size() - first)));
    send(i, parties_[i].events, events_, chunk, chunks);
  }
}

void OwnChannels::tell_near(size_t i, const RunInfo& run, const Frame& frame) {
  const auto choose = [&](const NearRows& all, std::vector<NearPair>& own) {
    own.clear();
    for (const NearPair& row : all)
      if (names(parties_[i], row.pair)) own.push_back(row);
  };
  choose(frame.near_pairs, own_near_);
  choose(frame.near_bodies, own_people_);
  const size_t rows = own_near_.size() + own_people_.size();
  stamp_.near_rows = static_cast<int32_t>(rows);
  told_[i].near_rows += static_cast<int64_t>(rows);
  // Also when nothing is near: a receiver learns that nothing is.
  const int chunks = std::max(1, chunks_of(rows, kRowsPerMessage<near_t>));
  for (int chunk = 0; chunk < chunks; ++chunk) {
    set_near_chunk(near_, run.culler.near, frame.near_hash, own_near_, own_people_,
                   static_cast<size_t>(chunk) * kRowsPerMessage<near_t>);
    send(i, parties_[i].near, near_, chunk, chunks);
  }
}

template <class Message>
void OwnChannels::send(size_t i, Numbered& to, Message& message, int chunk, int chunks) {
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
  ++told_[i].messages;
  if (sink_ != nullptr) sink_->send(to.channel, {buffer_.data(), static_cast<size_t>(size)});
}

}  // namespace throng
