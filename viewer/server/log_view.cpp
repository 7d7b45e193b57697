#include "viewer/server/log_view.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <nlohmann/json.hpp>

#include "base/errors.h"
#include "viewer/picture/recorded_frame.h"
#include "viewer/server/view_query.h"

namespace throng {
namespace {

/// Returns the newest mark at or before `frame`.
std::optional<LogIndex::Mark> newest(const std::vector<LogIndex::Mark>& marks, int64_t frame) {
  const auto after =
      std::upper_bound(marks.begin(), marks.end(), frame,
                       [](int64_t f, const LogIndex::Mark& mark) { return f < mark.frame; });
  if (after == marks.begin()) return std::nullopt;
  return *std::prev(after);
}

/// Returns the first mark at or after `frame`.
std::vector<LogIndex::Mark>::const_iterator first_from(const std::vector<LogIndex::Mark>& marks,
                                                       int64_t frame) {
  return std::lower_bound(marks.begin(), marks.end(), frame,
                          [](const LogIndex::Mark& mark, int64_t f) { return mark.frame < f; });
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
  touching_.push_back({0, reader_.offset()});  // nothing touches before the first event
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
  if (channel == Channel::kStates) run_.take(event.channel, event.data);
  const bool has_shortfalls =
      channel == Channel::kSeparation &&
      run_.take(event.channel, event.data) == RunReader::Update::kSeparation;
  const std::lock_guard lock(mutex_);
  const auto mark = [&](std::vector<Mark>& marks) {
    if (header.chunk == 0 && (marks.empty() || marks.back().frame < header.frame))
      marks.push_back({header.frame, event.offset});
  };
  if (channel == Channel::kStates) mark(states_);
  if (channel == Channel::kTouching) mark(touching_);
  if (channel == Channel::kProximity) mark(proximity_);
  if (has_shortfalls) shortfalls_.take(header.frame, run_.new_shortfalls());
  if (channel == Channel::kFrameStats) {
    frame_stats_t stats;
    if (!decode(event.data, stats).empty() || header.frame <= last_frame_) return;
    samples_.push_back({header.frame, static_cast<int32_t>(stats.touching),
                        static_cast<float>(stats.frame_ns * 1e-6)});
    history_.complete(header.frame, run_.state());
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

void LogIndex::describe(RunReader& run) const {
  for (const std::vector<uint8_t>& piece : description_) run.take(name_of(Channel::kRun), piece);
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

std::vector<LogIndex::Mark> LogIndex::states_marks(int64_t first, int64_t last, int64_t every,
                                                   size_t max) const {
  const std::lock_guard lock(mutex_);
  std::vector<Mark> marks;
  for (int64_t next = first; next <= last && marks.size() < max;) {
    const auto mark = first_from(states_, next);
    if (mark == states_.end() || mark->frame > last) break;
    marks.push_back(*mark);
    next = mark->frame + every;
  }
  return marks;
}

std::vector<LogIndex::Mark> LogIndex::proximity_marks(int64_t first, int64_t last,
                                                      size_t max) const {
  const std::lock_guard lock(mutex_);
  std::vector<Mark> marks;
  for (auto mark = first_from(proximity_, first);
       mark != proximity_.end() && mark->frame <= last && marks.size() < max; ++mark)
    marks.push_back(*mark);
  return marks;
}

bool LogIndex::has_proximity() const {
  const std::lock_guard lock(mutex_);
  return !proximity_.empty();
}

std::string LogIndex::to_json(size_t max_samples) const {
  const std::lock_guard lock(mutex_);
  const auto frames = static_cast<size_t>(last_frame_ + 1);
  const size_t every = frames / max_samples + 1;
  std::vector<int32_t> pairs((frames + every - 1) / every);
  std::vector<float> frame_ms(pairs.size());
  for (const Sample& sample : samples_) {
    // A maximum, because a peak must not fall between two samples.
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
                          {"frame_ms", frame_ms},
                          {"shortfalls", shortfalls_.to_json()}}}}
      .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

LogPlayer::LogPlayer(const LogIndex& index, const RunGeometry& geometry)
    : index_(index), reader_(index.log()), messages_(run_, geometry) {
  index.describe(run_);
}

void LogPlayer::jump(const LogIndex::Start& start) {
  run_.rewind();
  if (start.states.offset < start.touching.offset) {
    // The states are older than the list of touching pairs: read them first.
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
      if (!skip_damage(reader_, status).continues) return;
      continue;
    }
    // States that newer ones replace are not decoded.
    if (event.channel == name_of(Channel::kStates) && event.offset < start.states.offset) continue;
    // frame_stats_t is the last message of a frame.
    if (take(event) == RunReader::Update::kFrameStats) frame_ = run_.frame_stats()->frame;
  }
}

std::shared_ptr<const Bytes> LogPlayer::frame(int64_t number) {
  const int64_t target = std::clamp(number, int64_t{0}, std::max(int64_t{0}, index_.last_frame()));
  const std::optional<LogIndex::Start> start = index_.start_of(target);
  if (!start) return nullptr;
  // Reading on is cheaper than a jump if no list of touching pairs lies in between.
  const bool jumps = target < frame_ || reader_.offset() < start->touching.offset || frame_ < 0;
  if (jumps) {
    jump(*start);
    frame_ = -1;
  }
  read_to(target, *start);
  // The index knows the skipped begins: it is ahead of every player.
  if (jumps) begins_.set(index_.history().begins_at(target, run_.touching()), run_);
  return messages_.build(++built_, target, run_.touching(), begins_.all());
}

LogSampler::LogSampler(const LogIndex& index) : index_(index), reader_(index.log()) {
  index.describe(run_);
}

/// Reads a frame's messages of a channel, which follow each other. Returns whether all were read,
/// which `whole` reports.
bool LogSampler::read(const LogIndex::Mark& mark, Channel channel, RunReader::Update whole) {
  reader_.seek(mark.offset);
  LogEvent event;
  while (reader_.next(event) == LogReader::Status::kEvent && event.channel == name_of(channel)) {
    const RunReader::Update update = run_.take(event.channel, event.data);
    if (update == whole) return run_.header()->frame == mark.frame;
    if (update == RunReader::Update::kRejected) return false;
  }
  return false;
}

Bytes LogSampler::proximity(uint32_t body, int64_t since, std::chrono::milliseconds limit) {
  constexpr size_t kMaxFrames = 2000, kMaxRows = 50'000;
  const auto end = std::chrono::steady_clock::now() + limit;
  ProximityMessage message(body, since);
  const int64_t last = index_.last_frame();
  const std::vector<LogIndex::Mark> marks = index_.proximity_marks(since, last, kMaxFrames);
  int64_t to = std::max(since, last + 1);
  run_.rewind();
  for (size_t i = 0; i < marks.size(); ++i) {
    if (read(marks[i], Channel::kProximity, RunReader::Update::kProximity))
      message.add(marks[i].frame, nearest_parts(run_, body));
    const bool is_full = message.size() > kMaxRows || std::chrono::steady_clock::now() > end;
    if (!is_full && i + 1 < kMaxFrames) continue;
    to = marks[i].frame + 1;
    break;
  }
  return message.finish(to, index_.has_proximity());
}

Bytes LogSampler::positions(int64_t first, int64_t last, int64_t every,
                            std::chrono::milliseconds limit) {
  constexpr size_t kMaxSamples = 1000, kMaxBytes = size_t{4} << 20;
  const auto end = std::chrono::steady_clock::now() + limit;
  last = std::min(last, index_.last_frame());
  const std::vector<LogIndex::Mark> marks = index_.states_marks(first, last, every, kMaxSamples);
  PositionsHead head;
  head.avatars = static_cast<uint32_t>(run_.run()->avatar_count);
  head.from = static_cast<double>(first);
  head.to = static_cast<double>(std::max(first, last + 1));
  std::vector<float> places;
  run_.rewind();
  for (size_t i = 0; i < marks.size(); ++i) {
    if (read(marks[i], Channel::kStates, RunReader::Update::kState)) {
      ++head.samples;
      const CrowdState& crowd = run_.state();
      for (size_t id = 0; id < crowd.roots.size(); ++id)
        for (const int axis : {0, 1})
          places.push_back(crowd.present[id] != 0
                               ? static_cast<float>(crowd.roots[id].position_m[axis])
                               : std::numeric_limits<float>::quiet_NaN());
    }
    const bool is_full =
        places.size() * sizeof(float) > kMaxBytes || std::chrono::steady_clock::now() > end;
    if (!is_full && i + 1 < kMaxSamples) continue;
    // The next sample is due `every` frames after this one.
    head.to = std::min(head.to, static_cast<double>(marks[i].frame + every));
    break;
  }
  Bytes out;
  put(out, head);
  put_all(out, std::span<const float>(places));
  return out;
}

namespace {

constexpr size_t kIndexSamples = 2000;
/// Time of an answer that reads the log; other requests of the client wait.
constexpr std::chrono::milliseconds kReadTime{25};

RunReader described(const LogIndex& index) {
  RunReader run;
  index.describe(run);
  require_people(*run.run(), index.log().string());
  return run;
}

}  // namespace

/// Stored in WebClient::state and used by the client's own thread only.
struct LogView::Player {
  Player(const LogIndex& index, const RunGeometry& geometry)
      : player(index, geometry), sampler(index) {}
  LogPlayer player;
  LogSampler sampler;
};

LogView::LogView(const std::filesystem::path& log, const WebOptions& options, std::string_view page)
    : index_(log),
      description_(described(index_)),
      geometry_(description_),
      run_message_(
          std::make_shared<Bytes>(throng::run_message(description_, geometry_, ViewMode::kLog))),
      server_(options, page,
              {[this](const std::shared_ptr<WebClient>& client) { opened(client); },
               [this](WebClient& client, std::string_view text) { on_text(client, text); }}) {}

void LogView::opened(const std::shared_ptr<WebClient>& client) {
  client->state = std::make_shared<Player>(index_, geometry_);
  client->send_binary(run_message_);
  client->send_text(index_.to_json(kIndexSamples));
}

void LogView::on_text(WebClient& client, std::string_view text) {
  auto& player = *static_cast<Player*>(client.state.get());
  const ViewQuery query = parse_view_query(text);
  if (query.index) client.send_text(index_.to_json(kIndexSamples));
  if (query.contacts)
    client.send_binary(std::make_shared<Bytes>(
        index_.history().changes_from(*query.contacts, query.since.value_or(0), kMaxContacts)));
  if (query.proximity)
    client.send_binary(std::make_shared<Bytes>(
        player.sampler.proximity(*query.proximity, query.since.value_or(0), kReadTime)));
  if (query.positions)
    client.send_binary(std::make_shared<Bytes>(
        player.sampler.positions(*query.positions, query.to, query.every, kReadTime)));
  if (query.person) {
    client.send_text(
        index_.history().of(*query.person, query.frame.value_or(INT64_MAX), kHistoryPairs));
  } else if (query.frame) {
    if (SharedBytes frame = player.player.frame(*query.frame)) client.offer_frame(frame);
  }
}

}  // namespace throng
