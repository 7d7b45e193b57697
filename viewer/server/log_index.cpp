#include "viewer/server/log_index.h"

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>

#include "base/errors.h"

namespace throng {
namespace {

/// The newest mark at or before `frame`.
std::optional<LogIndex::Mark> newest(const std::vector<LogIndex::Mark>& marks, int64_t frame) {
  const auto after =
      std::upper_bound(marks.begin(), marks.end(), frame,
                       [](int64_t f, const LogIndex::Mark& mark) { return f < mark.frame; });
  if (after == marks.begin()) return std::nullopt;
  return *std::prev(after);
}

}  // namespace

LogIndex::LogIndex(const std::filesystem::path& log) : log_(log), reader_(log) {
  LogEvent event;
  while (run_.run() == nullptr && gaps_.next(reader_, event)) {
    if (event.channel == name_of(Channel::kRun))
      description_.emplace_back(event.data.begin(), event.data.end());
    run_.take(event.channel, event.data);
  }
  if (run_.run() == nullptr)
    throw InputError(log.string(), "a run's description", gaps_.found_no_description());
  touching_.push_back({0, reader_.offset()});  // before the first event nothing touches
  thread_ = std::thread([this] { read_on(); });
}

LogIndex::~LogIndex() {
  stopping_ = true;
  thread_.join();
}

void LogIndex::take(const LogEvent& event, Channel channel) {
  MessageHeader header;
  if (!read_header(channel, event.data, header).empty()) return;
  if (channel == Channel::kEvents || channel == Channel::kTouching) {
    begins_.take(run_, run_.take(event.channel, event.data));
    history_.add(begins_.changes());
  }
  const std::lock_guard lock(mutex_);
  const auto mark = [&](std::vector<Mark>& marks) {
    if (header.chunk == 0 && (marks.empty() || marks.back().frame < header.frame))
      marks.push_back({header.frame, event.offset});
  };
  if (channel == Channel::kStates) mark(states_);
  if (channel == Channel::kTouching) mark(touching_);
  if (channel == Channel::kCounters) {
    counters_t counters;
    if (!decode(event.data, counters).empty() || header.frame <= last_frame_) return;
    samples_.push_back({header.frame, static_cast<int32_t>(counters.touching),
                        static_cast<float>(counters.frame_ns * 1e-6)});
    last_frame_ = header.frame;
  }
}

void LogIndex::read_on() {
  LogEvent event;
  while (!stopping_ && gaps_.next(reader_, event))
    if (const std::optional<Channel> channel = channel_of(event.channel)) take(event, *channel);
  {
    const std::lock_guard lock(mutex_);
    if (!stopping_) problem_ = gaps_.describe(run_.run()->step_s);
  }
  complete_ = true;
}

void LogIndex::wait() const {
  while (!complete_) std::this_thread::sleep_for(std::chrono::milliseconds(2));
}

std::string LogIndex::problem() const {
  const std::lock_guard lock(mutex_);
  return problem_;
}

std::optional<LogIndex::Start> LogIndex::start_of(int64_t frame) const {
  const std::lock_guard lock(mutex_);
  const auto states = newest(states_, frame);
  if (!states) return std::nullopt;
  return Start{*states, newest(touching_, frame).value_or(touching_.front())};
}

std::string LogIndex::to_json(size_t most) const {
  const std::lock_guard lock(mutex_);
  const auto frames = static_cast<size_t>(last_frame_ + 1);
  const size_t every = frames / most + 1;
  std::vector<int32_t> pairs((frames + every - 1) / every);
  std::vector<float> frame_ms(pairs.size());
  for (const Sample& sample : samples_) {
    // A peak must not fall between two samples.
    const size_t i = static_cast<size_t>(sample.frame) / every;
    pairs[i] = std::max(pairs[i], sample.pairs);
    frame_ms[i] = std::max(frame_ms[i], sample.frame_ms);
  }
  return nlohmann::json{{"index",
                         {{"frames", frames},
                          {"complete", complete_.load()},
                          {"problem", problem_},
                          {"first_shown", states_.empty() ? 0 : states_.front().frame},
                          {"every", every},
                          {"pairs", pairs},
                          {"frame_ms", frame_ms}}}}
      .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace throng
