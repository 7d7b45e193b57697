#include "lcm_io/log/log_gaps.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "base/text.h"
#include "lcm_io/codec/message_validation.h"

namespace throng {
namespace {

std::string where_of(int64_t last_frame, double step_s) {
  return last_frame < 0 ? std::string("before its first frame")
                        : fmt::format("after frame {} ({:.2f} s)", last_frame,
                                      static_cast<double>(last_frame) * step_s);
}

}  // namespace

std::string describe_cut(int64_t last_frame, double step_s) {
  return fmt::format(
      "The log is cut off: it ends {} without the end of its run, and what came later is missing.",
      where_of(last_frame, step_s));
}

LogDamage skip_damage(LogReader& log, LogReader::Status status) {
  LogDamage damage{.problem = log.problem(), .from = log.offset()};
  damage.continues = log.resync();
  damage.bytes = log.offset() - damage.from;
  damage.is_torn = !damage.continues && status == LogReader::Status::kTorn;
  return damage;
}

bool LogGaps::next(LogReader& log, LogEvent& event) {
  for (;;) {
    const LogReader::Status status = log.next(event);
    if (status == LogReader::Status::kEvent) {
      note(event);
      return true;
    }
    if (status == LogReader::Status::kEnd) return false;
    const LogDamage damage = skip_damage(log, status);
    ++damaged_places_;
    is_torn_ = is_torn_ || damage.is_torn;
    if (!damage.is_torn) damaged_bytes_ += damage.bytes;
    if (!damage.continues) return false;
  }
}

void LogGaps::note(const LogEvent& event) {
  const std::optional<Channel> channel = channel_of(event.channel);
  MessageHeader header;
  if (!channel) return;
  const std::string defect = read_header(*channel, event.data, header);
  const bool has_header = defect.empty();
  if (!has_header && first_rejection_.empty())
    first_rejection_ = fmt::format("{}: {}", event.channel, defect);
  if (has_header && *channel == Channel::kChecksums) compare(event, header);
  spans_.add(*channel, event, has_header ? &header : nullptr);
  if (!has_header) return;
  if (!has_run_) {
    has_run_ = true;
    run_id_ = header.run_id;
    instance_ = header.instance;
  }
  if (header.run_id != run_id_ || header.instance != instance_) return;
  int64_t& next_seq = next_seq_[static_cast<size_t>(*channel)];
  if (header.seq > next_seq) missing_ += header.seq - next_seq;
  next_seq = std::max(next_seq, header.seq + 1);
  has_end_ = has_end_ || *channel == Channel::kEnd;
  if (*channel == Channel::kFrameStats) last_frame_ = std::max(last_frame_, header.frame);
}

void LogGaps::compare(const LogEvent& event, const MessageHeader& header) {
  checksums_t stated;
  if (!decode(event.data, stated).empty() || stated.checksum_kind != kChecksumKind) return;
  damaged_spans_ += spans_.differences(stated, event, header).size();
  spans_.adopt(stated, event);
}

std::string LogGaps::found_no_description() const {
  if (!first_rejection_.empty() && !has_run_)
    return fmt::format("none ({}); record the run again with this version", first_rejection_);
  if (is_torn_) return "none: the file ends inside a message";
  return "none; is it a log of `throng run`?";
}

std::string LogGaps::describe(double step_s) const {
  std::vector<std::string> sentences;
  if (is_torn_)
    sentences.push_back(
        fmt::format("The log is torn: it ends inside a message {}, and the rest is "
                    "missing.",
                    where_of(last_frame_, step_s)));
  else if (!has_end_)
    sentences.push_back(describe_cut(last_frame_, step_s));
  for (std::string& sentence : describe_damage()) sentences.push_back(std::move(sentence));
  return fmt::format("{}", fmt::join(sentences, " "));
}

std::vector<std::string> LogGaps::describe_damage() const {
  std::vector<std::string> sentences;
  if (damaged_bytes_ > 0)
    sentences.push_back(fmt::format("The log is damaged: {} of it could not be read.",
                                    counted(damaged_bytes_, "byte")));
  if (damaged_spans_ > 0)
    sentences.push_back(fmt::format(
        "The log is damaged: {} altered; `throng check` lists them.",
        counted(damaged_spans_, "stretch of messages is", "stretches of messages are")));
  if (missing_ > 0)
    sentences.push_back(fmt::format("The log lacks {} of its run.", counted(missing_, "message")));
  return sentences;
}

}  // namespace throng
