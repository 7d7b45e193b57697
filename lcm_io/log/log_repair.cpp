#include <optional>

#include "base/errors.h"
#include "lcm_io/codec/run_reader.h"
#include "lcm_io/log/check_spans.h"
#include "lcm_io/log/log_check.h"
#include "lcm_io/log/log_reader.h"
#include "lcm_io/log/log_sink.h"

namespace throng {
namespace {

/// Copies sound messages. It counts them with the code of the checker, so that its checksums are
/// right.
class LogRepairer {
 public:
  LogRepairer(const LogReport& report, const std::filesystem::path& out)
      : report_(report), out_(out) {}

  void take(const LogEvent& event) {
    const std::optional<Channel> channel = channel_of(event.channel);
    if (!channel) {
      if (!report_.unknown_channels.contains(event.channel)) write(event, event.data);
      return;
    }
    MessageHeader header;
    if (!check_message(*channel, event.data).empty() ||
        !read_header(*channel, event.data, header).empty() || !has_stamp_of_log(event, header))
      return;
    if (*channel == Channel::kChecksums)
      take_checks(event, header);
    else if (!is_damaged(*channel, event.offset))
      keep(*channel, event, header, event.data);
  }

  int64_t close() {
    out_.close();
    return out_.events();
  }

 private:
  bool has_stamp_of_log(const LogEvent& event, const MessageHeader& header) {
    const bool is_recorders = is_recorders_stamp(header, event);
    if (!is_recording_) is_recording_ = is_recorders;
    return is_recorders == *is_recording_ && (is_recorders || event.stamp_us == header.utime_us);
  }

  bool is_damaged(Channel channel, uint64_t byte) const {
    // Spans are in the order of the log; those before this byte are finished.
    while (next_span_ < report_.damage.size() && report_.damage[next_span_].to_byte <= byte)
      ++next_span_;
    for (size_t i = next_span_; i < report_.damage.size(); ++i) {
      if (report_.damage[i].contains(channel, byte)) return true;
      if (report_.damage[i].from_byte > byte) break;
    }
    return false;
  }

  void keep(Channel channel, const LogEvent& event, const MessageHeader& header,
            std::span<const uint8_t> data) {
    LogEvent copied = event;
    copied.data = data;
    spans_.add(channel, copied, &header);
    if (channel == Channel::kEvents) add_to_hash(header.frame, data);
    write(event, data);
  }

  void write(const LogEvent& event, std::span<const uint8_t> data) {
    out_.copy(event.number, event.channel, event.stamp_us, data);
  }

  void add_to_hash(int64_t frame, std::span<const uint8_t> data) {
    RunReader reader;  // without a description it accepts every pair
    reader.take(name_of(Channel::kEvents), data);
    hash_.add(frame, reader.new_events());
  }

  void take_checks(const LogEvent& event, const MessageHeader& header) {
    checksums_t stated;
    if (!decode(event.data, stated).empty()) return;
    const checksums_t sent = stated;
    if (stated.checksum_kind == kChecksumKind && spans_.is_gap(stated, event, header)) {
      spans_.adopt(stated, event);
      adopt_hash(stated);
    } else if (stated.checksum_kind == kChecksumKind) {
      if (!spans_.differences(stated, event, header).empty()) spans_.fill(stated, event, header);
      update_hash(stated);
    }
    const bool is_changed = stated.message_index != sent.message_index ||
                            stated.hash != sent.hash || stated.channels != sent.channels ||
                            stated.messages != sent.messages || stated.bytes != sent.bytes ||
                            stated.checksums != sent.checksums;
    if (!is_changed) {
      keep(Channel::kChecksums, event, header, event.data);
    } else {
      stated.is_repaired = 1;
      std::vector<uint8_t> bytes(static_cast<size_t>(stated.getEncodedSize()));
      stated.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
      seal(bytes);
      keep(Channel::kChecksums, event, header, bytes);
    }
  }

  void adopt_hash(const checksums_t& stated) {
    if (LogHash::is_known(stated.hash_kind))
      hash_.resume_from(static_cast<EventHashKind>(stated.hash_kind),
                        static_cast<uint64_t>(stated.hash));
  }

  void update_hash(checksums_t& stated) {
    if (!LogHash::is_known(stated.hash_kind)) return;
    hash_.start_from(static_cast<uint64_t>(stated.hash_at_start));
    stated.hash = static_cast<int64_t>(hash_.value(static_cast<EventHashKind>(stated.hash_kind)));
  }

  const LogReport& report_;
  LogFile out_;
  CheckSpans spans_;
  LogHash hash_;
  std::optional<bool> is_recording_;
  mutable size_t next_span_ = 0;
};

/// Copies the sound messages by the report on `in`; returns their number.
int64_t repair(const std::filesystem::path& in, const std::filesystem::path& out) {
  const LogReport report = check_log(in);
  LogReader log(in);
  LogRepairer repairer(report, out);
  LogEvent event;
  for (;;) {
    const LogReader::Status status = log.next(event);
    if (status == LogReader::Status::kEnd) break;
    if (status == LogReader::Status::kEvent)
      repairer.take(event);
    else if (!log.resync())
      break;
  }
  return repairer.close();
}

}  // namespace

int64_t repair_log(const std::filesystem::path& in, const std::filesystem::path& out) {
  std::error_code error;
  if (std::filesystem::equivalent(in, out, error))
    throw EnvironmentError(out.string() +
                           ": expected a file other than the damaged log, found the same file");
  const int64_t messages = repair(in, out);
  // Pieces of several logs with equal numbers may agree with checksums of another piece, until
  // messages between them are removed. Messages before the first remaining problem are sound.
  const LogReport repaired = check_log(out);
  if (repaired.damage.empty()) return messages;
  std::filesystem::resize_file(out, repaired.damage.front().from_byte);
  return check_log(out).log_events;
}

}  // namespace throng
