#include "lcm_io/log/log_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "base/errors.h"
#include "base/text.h"
#include "lcm_io/codec/run_reader.h"
#include "lcm_io/log/log_gaps.h"
#include "lcm_io/log/log_reader.h"

namespace throng {
namespace {

size_t index_of(Channel channel) { return static_cast<size_t>(channel); }

class LogChecker {
 public:
  explicit LogChecker(const std::filesystem::path& file) : file_(file), log_(file) {
    report_.bytes = log_.size();
  }

  LogReport run() {
    LogEvent event;
    for (;;) {
      const LogReader::Status status = log_.next(event);
      if (status == LogReader::Status::kEvent) {
        take(event);
      } else if (status == LogReader::Status::kEnd || !skip_damage(status)) {
        break;
      }
    }
    require_this_version();
    finish();
    return report_;
  }
  const RunReader& reader() const { return reader_; }

 private:
  bool skip_damage(LogReader::Status status) {
    const LogDamage damage = throng::skip_damage(log_, status);
    problem(damage.problem);
    (damage.is_torn ? report_.torn : report_.damaged) = true;
    if (damage.continues)
      problem(fmt::format("byte {}: {} bytes skipped", damage.from, damage.bytes));
    return damage.continues;
  }

  void take(const LogEvent& event) {
    if (event.number != next_number_)
      problem(fmt::format("byte {}: expected event number {}, found {}", event.offset, next_number_,
                          event.number));
    next_number_ = event.number < INT64_MAX ? event.number + 1 : 0;
    if (event.stamp_us < last_stamp_us_)
      problem(fmt::format("byte {}: stamp {} us after {} us", event.offset, event.stamp_us,
                          last_stamp_us_));
    last_stamp_us_ = event.stamp_us;
    ++report_.log_events;
    report_.sound_bytes += event.bytes;
    const std::optional<Channel> channel = channel_of(event.channel);
    if (!channel) {
      ++report_.foreign_messages;
      if (foreign_.size() < kMaxForeign) foreign_.emplace(event.channel, event.offset);
      return;
    }
    MessageHeader header;
    const bool has_header = read_header(*channel, event.data, header).empty();
    take(*channel, event);
    spans_.add(*channel, event, has_header ? &header : nullptr);
    ++report_.uncovered;
    if (has_header && *channel == Channel::kChecksums && is_covered_) {
      report_.uncovered = 0;
      is_covered_ = false;
    }
  }

  void take(Channel channel, const LogEvent& event) {
    LogReport::ChannelReport& sum = report_.channels[index_of(channel)];
    ++sum.messages;
    sum.bytes += static_cast<int64_t>(event.data.size());
    MessageHeader header;
    std::string defect = check_message(channel, event.data);
    if (defect.empty()) defect = read_header(channel, event.data, header);
    if (!defect.empty()) {
      ++sum.rejected;
      if (first_rejection_.empty()) first_rejection_ = fmt::format("{}: {}", event.channel, defect);
      problem(fmt::format("byte {}: {}: {}", event.offset, event.channel, defect));
      return;
    }
    number(channel, event, header);
    compare_stamp(event, header);
    if (is_over_ && !is_recording_)
      problem(fmt::format("byte {}: {}: a message after the last one of the run", event.offset,
                          event.channel));
    // After the last frame come the last ends, numbered as one more frame.
    if (channel == Channel::kFrameStats)
      report_.last_frame = std::max(report_.last_frame, header.frame);
    report_.last_utime_us = std::max(report_.last_utime_us, header.utime_us);
    const int64_t foreign = reader_.foreign();
    const auto update = reader_.take(event.channel, event.data);
    if (update == RunReader::Update::kRejected)
      problem(fmt::format("byte {}: {}", event.offset, reader_.rejection()));
    if (reader_.foreign() != foreign)
      problem(fmt::format("byte {}: {}: of another run ({:016x})", event.offset, event.channel,
                          static_cast<uint64_t>(header.run_id)));
    if (update == RunReader::Update::kTouching && !has_frames_ && adopted_frame_ < 0)
      adopt_touching(header.frame);
    if (!has_frames_ && channel != Channel::kRun && channel != Channel::kTouching) {
      has_frames_ = true;
      was_resumed_ = adopted_frame_ >= 0 && header.frame > adopted_frame_;
    }
    if (update == RunReader::Update::kEvents) {
      hash_.add(header.frame, reader_.new_events());
      pair_up(event);
    }
    if (update == RunReader::Update::kChecksums) compare_checks(event, header);
    if (update == RunReader::Update::kFrameStats) {
      compare_touching(event);
      compare_present(event);
    }
    if (update == RunReader::Update::kEnd) compare_totals(event);
  }

  void number(Channel channel, const LogEvent& event, const MessageHeader& header) {
    int64_t& next = next_seq_[index_of(channel)];
    if (header.seq != next)
      problem(fmt::format("byte {}: {}: expected seq {}, found {}", event.offset, event.channel,
                          next, header.seq));
    if (header.seq > next) report_.channels[index_of(channel)].missing += header.seq - next;
    next = header.seq + 1;
  }

  /// Throng stamps with simulation time, a recorder with its clock; a log has one of them.
  void compare_stamp(const LogEvent& event, const MessageHeader& header) {
    const bool is_recorders = is_recorders_stamp(header, event);
    if (!has_stamp_) is_recording_ = is_recorders;
    has_stamp_ = true;
    if (is_recorders != is_recording_ || (!is_recorders && event.stamp_us != header.utime_us))
      problem(fmt::format("byte {}: {}: stamp {} us, its message has {} us", event.offset,
                          event.channel, event.stamp_us, header.utime_us));
  }

  void compare_checks(const LogEvent& event, const MessageHeader& header) {
    const checksums_t& stated = *reader_.checks();
    if (!report_.has_checks) describe(stated);
    report_.has_checks = true;
    report_.repaired = report_.repaired || stated.is_repaired != 0;
    for (const DamagedSpan& span : spans_.differences(stated, event, header)) report_damage(span);
    compare_hash(stated, event, spans_.is_gap(stated, event, header));
    if (stated.checksum_kind != kChecksumKind) {
      problem(fmt::format("byte {}: checksums of kind {}, this program knows kind {}", event.offset,
                          stated.checksum_kind, kChecksumKind));
      return;
    }
    spans_.adopt(stated, event);
    last_checks_byte_ = event.offset;
    report_.checked_frame = stated.frame;
    is_covered_ = true;
    is_over_ = is_over_ || stated.is_last != 0;
  }

  void report_damage(const DamagedSpan& span) {
    report_.damage.push_back(span);
    const std::string from = span.from_frame < 0
                                 ? std::string("the beginning")
                                 : fmt::format("the checksums of frame {}", span.from_frame);
    const std::string what =
        span.written == span.found
            ? "damaged, " + counted(span.found, "message")
            : fmt::format("{} instead of {}", counted(span.found, "message"), span.written);
    problem(fmt::format("bytes {} to {}: {}: {}, between {} and those of frame {}", span.from_byte,
                        span.to_byte, name_of(span.channel), what, from, span.to_frame));
  }

  void compare_hash(const checksums_t& stated, const LogEvent& event, bool is_gap) {
    if (!LogHash::is_known(stated.hash_kind)) return;
    const auto kind = static_cast<EventHashKind>(stated.hash_kind);
    hash_.start_from(static_cast<uint64_t>(stated.hash_at_start));
    const auto written = static_cast<uint64_t>(stated.hash);
    const uint64_t found = hash_.value(kind);
    if (found == written) return;
    const bool is_known =
        std::any_of(report_.damage.begin(), report_.damage.end(), [&](const DamagedSpan& span) {
          return span.channel == Channel::kEvents && span.to_byte == event.offset;
        });
    if (!is_known && !is_gap) {
      DamagedSpan span{Channel::kEvents, report_.checked_frame, stated.frame, last_checks_byte_,
                       event.offset};
      report_.damage.push_back(span);
      problem(
          fmt::format("byte {}: the run states hash {:016x} of its events up to frame {}, those in "
                      "the log have {:016x}",
                      event.offset, written, stated.frame, found));
    }
    hash_.resume_from(kind, written);
  }

  void compare_hash(const end_t& end, const LogEvent& event) {
    const auto written = static_cast<uint64_t>(end.hash);
    if (!report_.has_checks) {
      report_.finished = false;
      problem(fmt::format("byte {}: expected THRONG_CHECKSUMS before THRONG_END, found none",
                          event.offset));
      return;
    }
    if (!LogHash::is_known(reader_.checks()->hash_kind)) return;
    const auto kind = static_cast<EventHashKind>(reader_.checks()->hash_kind);
    report_.hash_agrees = hash_.value(kind) == written;
    if (report_.hash_agrees) return;
    report_.finished = false;
    problem(fmt::format("byte {}: the run states hash {:016x}, the events in the log have another",
                        event.offset, written));
  }

  void describe(const checksums_t& stated) {
    report_.version = printable(stated.version);
    report_.commit = printable(stated.commit.substr(0, stated.commit.find(' ')));
    report_.strategy = printable(stated.strategy);
    report_.omits = printable(stated.omits, 200);
  }

  /// A resumed run begins with the pairs that touched when it was stopped.
  void adopt_touching(int64_t frame) {
    for (const auto& [pair, level] : reader_.touching()) open_.insert(pair);
    adopted_ = static_cast<int64_t>(open_.size());
    adopted_frame_ = frame;
  }

  void pair_up(const LogEvent& event) {
    for (const PairEvent& e : reader_.new_events()) {
      const bool is_begin = e.kind == EventKind::kBegin;
      ++(is_begin ? report_.begins : report_.ends);
      if (is_begin) ++report_.begins_by_level[static_cast<size_t>(e.level)];
      const bool whole = e.pair.part_a() == kWholeBody;
      if (whole ? e.level > PairLevel::kBox : e.level == PairLevel::kSphere)
        problem(fmt::format("byte {}: pair {}:{} - {}:{} at level {}", event.offset, e.pair.a(),
                            e.pair.part_a(), e.pair.b(), e.pair.part_b(),
                            static_cast<int>(e.level)));
      const bool fits = is_begin ? open_.insert(e.pair).second : open_.erase(e.pair) == 1;
      if (fits) continue;
      problem(fmt::format("byte {}: pair {}:{} - {}:{} {}", event.offset, e.pair.a(),
                          e.pair.part_a(), e.pair.b(), e.pair.part_b(),
                          is_begin ? "begins twice" : "ends without a begin"));
    }
  }

  void compare_touching(const LogEvent& event) {
    const int64_t stated = reader_.frame_stats()->touching;
    if (stated != static_cast<int64_t>(open_.size()))
      problem(fmt::format("byte {}: {} touching pairs by the counters, {} by the events",
                          event.offset, stated, open_.size()));
  }

  /// An absent avatar has no contacts.
  void compare_present(const LogEvent& event) {
    const CrowdState& crowd = reader_.state();
    if (crowd.frame != reader_.frame_stats()->frame) return;
    const auto is_absent = [&crowd](uint32_t body) {
      return body < crowd.present.size() && crowd.present[body] == 0;
    };
    for (const PairKey& pair : open_)
      if (is_absent(pair.a()) || is_absent(pair.b()))
        problem(fmt::format("byte {}: pair {}:{} - {}:{} of an avatar that is absent", event.offset,
                            pair.a(), pair.part_a(), pair.b(), pair.part_b()));
  }

  void compare_totals(const LogEvent& event) {
    const end_t& end = *reader_.end();
    report_.finished = has_end_ = true;
    // The totals cover the whole run; the log may hold its last part only.
    const int64_t begins_before = end.begins - report_.begins;
    const int64_t ends_before = end.ends - report_.ends;
    const bool is_complete = begins_before == 0 && ends_before == 0;
    const bool is_rest =
        was_resumed_ && ends_before >= 0 && begins_before - ends_before == adopted_;
    if (!(is_complete || is_rest) || !open_.empty()) {
      report_.finished = false;
      problem(fmt::format(
          "byte {}: the run states {} begins and {} ends, the log has {} and {}, {} pairs open",
          event.offset, end.begins, end.ends, report_.begins, report_.ends, open_.size()));
    }
    for (size_t i = 0; i < end.channels.size(); ++i) {
      const std::optional<Channel> channel = channel_of(end.channels[i]);
      if (!channel) continue;
      const LogReport::ChannelReport& found = report_.channels[index_of(*channel)];
      if (found.messages == end.messages[i] && found.bytes == end.bytes[i]) continue;
      report_.finished = false;
      problem(
          fmt::format("byte {}: the run states {} messages of {} bytes on {}, the log has {} of {}",
                      event.offset, end.messages[i], end.bytes[i], end.channels[i], found.messages,
                      found.bytes));
    }
    compare_hash(end, event);
  }

  void require_this_version() const {
    int64_t messages = 0, rejected = 0;
    for (const LogReport::ChannelReport& sum : report_.channels) {
      messages += sum.messages;
      rejected += sum.rejected;
    }
    throng::require_this_version(file_, messages, rejected, first_rejection_);
  }

  void finish() {
    report_.open_pairs = static_cast<int64_t>(open_.size());
    if (!reader_.run()) problem("no complete run description");
    if (report_.has_checks && report_.uncovered > 0) report_.finished = false;
    if (!report_.has_checks) report_.uncovered = 0;
    if (reader_.run() && !has_end_ && !report_.torn)
      report_.cut_off = describe_cut(report_.last_frame, reader_.run()->step_s);
    name_foreign();
  }

  /// A recorder stores all it receives; Throng writes messages of the run only.
  void name_foreign() {
    if (is_recording_) return;
    for (const auto& [name, offset] : foreign_) {
      const std::vector<std::string> none;
      const std::vector<std::string>& known = reader_.checks() ? reader_.checks()->channels : none;
      if (std::find(known.begin(), known.end(), name) != known.end()) continue;
      report_.unknown_channels.insert(name);
      problem(fmt::format("byte {}: '{}' is not a channel of a run", offset, printable(name)));
    }
  }

  void problem(std::string_view text) {
    if (++report_.problem_count <= static_cast<int64_t>(LogReport::kMaxProblems))
      report_.problems.emplace_back(text);
  }

  std::filesystem::path file_;
  LogReader log_;
  LogReport report_;
  std::string first_rejection_;
  RunReader reader_;
  std::set<PairKey> open_;
  CheckSpans spans_;
  uint64_t last_checks_byte_ = 0;
  LogHash hash_;
  bool is_covered_ = false;  // by the last checksums
  bool is_over_ = false;     // the last checksums were read
  bool has_end_ = false;
  bool has_stamp_ = false, is_recording_ = false;
  static constexpr size_t kMaxForeign = 64;
  std::map<std::string, uint64_t, std::less<>> foreign_;  // name -> byte of its first message
  int64_t adopted_ = 0;  // pairs that touched before the first frame of a resumed run
  int64_t adopted_frame_ = -1;
  bool has_frames_ = false, was_resumed_ = false;
  std::array<int64_t, kChannelCount> next_seq_{};
  int64_t next_number_ = 0;
  int64_t last_stamp_us_ = 0;
};

std::string describe_run(const run_description_t& run) {
  std::string out =
      fmt::format("scene {}, seed {}, {}, step {:.6g} s, parts by {}{}\n", printable(run.scene),
                  run.seed, counted(run.avatar_count, "avatar"), run.step_s,
                  printable(run.part_volume), run.exact ? ", decided by triangles" : "");
  for (const model_t& model : run.models) {
    size_t vertices = 0;
    for (const part_t& part : model.parts) vertices += part.mesh.coordinates_m.size() / 3;
    out += fmt::format("model {}: {} ({} moving), {}, {}, {:.2f} m\n", printable(model.name),
                       counted(model.joint_count, "joint"), model.column_count,
                       counted(model.part_count, "part"), counted(vertices, "vertex", "vertices"),
                       model.height_m);
  }
  std::vector<int64_t> members(run.groups.size());
  for (const int16_t group : run.group_of_avatar) ++members[static_cast<size_t>(group)];
  for (size_t i = 0; i < run.groups.size(); ++i)
    out += fmt::format("group {}: {}{}\n", printable(run.groups[i]), counted(members[i], "avatar"),
                       run.control_channels[i].empty()
                           ? ""
                           : ", controlled by " + printable(run.control_channels[i]));
  out += fmt::format("ground {:.1f} x {:.1f} m, {}\n", run.ground_max_m[0] - run.ground_min_m[0],
                     run.ground_max_m[1] - run.ground_min_m[1],
                     counted(run.obstacle_count, "obstacle"));
  return out;
}

std::string describe_channels(const LogReport& report) {
  std::string out = fmt::format("{:<21}{:>10}{:>14}{:>12}{:>12}{:>9}\n", "channel", "messages",
                                "bytes", "per s", "kB/s", "missing");
  const double seconds = static_cast<double>(report.last_utime_us) * 1e-6;
  for (const Channel channel : kAllChannels) {
    const LogReport::ChannelReport& sum = report.channels[index_of(channel)];
    if (sum.messages == 0) continue;
    const double per_s = seconds > 0 ? static_cast<double>(sum.messages) / seconds : 0;
    const double kb_per_s = seconds > 0 ? static_cast<double>(sum.bytes) * 1e-3 / seconds : 0;
    out += fmt::format("{:<21}{:>10}{:>14}{:>12.1f}{:>12.1f}{:>9}\n", name_of(channel),
                       sum.messages, sum.bytes, per_s, kb_per_s, sum.missing);
  }
  if (report.foreign_messages > 0)
    out += fmt::format("{:<21}{:>10}\n", "other channels", report.foreign_messages);
  return out;
}

}  // namespace

void require_this_version(const std::filesystem::path& file, int64_t messages, int64_t rejected,
                          const std::string& first_rejection) {
  if (messages > 1 && rejected == messages)
    throw InputError(file.string(), "messages of this version of Throng",
                     first_rejection + "; record the run again with this version");
}

std::vector<std::string> describe_coverage(const LogReport& report) {
  if (!report.has_checks) return {"none: cut off before the first; damage may not be detected"};
  std::vector<std::string> out = {fmt::format("up to frame {}", report.checked_frame)};
  if (report.uncovered > 0)
    out.push_back("not covered: " + counted(report.uncovered, "message") + " after them");
  if (report.repaired)
    out.push_back("repaired: the damaged part is left out, checksums cover the rest");
  return out;
}

LogReport check_log(const std::filesystem::path& file) { return LogChecker(file).run(); }

std::string describe_log(const std::filesystem::path& file) {
  LogChecker checker(file);
  const LogReport report = checker.run();
  std::string out = fmt::format("LCM log, {} bytes, {} events, {:.3f} s, {}\n", report.bytes,
                                report.log_events, static_cast<double>(report.last_utime_us) * 1e-6,
                                report.finished ? "finished" : "not finished");
  if (const run_description_t* run = checker.reader().run())
    out += fmt::format("run {:016x}\n", static_cast<uint64_t>(checker.reader().run_id())) +
           describe_run(*run);
  if (!report.version.empty())
    out += fmt::format("made by Throng {}, commit {}\n", report.version, report.commit);
  if (!report.strategy.empty() && report.strategy != name_of(Strategy::kPipeline))
    out += fmt::format("strategy {}\n", report.strategy);
  if (!report.omits.empty()) out += fmt::format("omits {}\n", report.omits);
  out += describe_channels(report);
  for (const std::string& line : describe_coverage(report))
    out += fmt::format("checksums {}\n", line);
  out += fmt::format("pair events: {}, {}, {} open\n", counted(report.begins, "begin"),
                     counted(report.ends, "end"), counted(report.open_pairs, "pair"));
  if (report.torn)
    out += fmt::format("torn: the last {} bytes are an incomplete event\n",
                       report.bytes - report.sound_bytes);
  for (const std::string& problem : report.problems) out += "problem: " + problem + "\n";
  const auto shown = static_cast<int64_t>(report.problems.size());
  if (report.problem_count > shown)
    out += fmt::format("and {} more problems\n", report.problem_count - shown);
  return out;
}

}  // namespace throng
