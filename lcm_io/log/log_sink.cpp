#include "lcm_io/log/log_sink.h"

#include "lcm_io/codec/log_format.h"

namespace throng {

void LogFile::copy(int64_t number, std::string_view channel, int64_t stamp_us,
                   std::span<const uint8_t> data) {
  uint8_t head[kLogHeadBytes];
  put_log_head(head, {number, stamp_us, static_cast<int32_t>(channel.size()),
                      static_cast<int32_t>(data.size())});
  file_.put(head, sizeof head);
  file_.put(channel.data(), channel.size());
  file_.put(data.data(), data.size());
  ++events_;
  bytes_ += sizeof head + channel.size() + data.size();
}

LogSink::LogSink(const std::filesystem::path& file, const LogOptions& options)
    : log_(file), options_(options), flush_interval_(options.flush_s) {}

EncoderOptions LogSink::encoding() const {
  return {.with_instance = false,
          .with_clock_times = options_.with_clock_times,
          .state_every = options_.state_every,
          .part_poses = options_.part_poses,
          .threads = options_.threads};
}

void LogSink::after_begin(TargetState& target_state) {
  for (int chunk = 0; chunk < target_state.description_chunks(); ++chunk)
    target_state.send_description_chunk(chunk);
  log_.flush();
  last_frame_ = Clock::now();
}

void LogSink::after_frame(TargetState&) {
  log_.check();
  const auto now = Clock::now();
  // The next chance is one frame later; flush now if that would be too late.
  const auto age_after_next = (now - oldest_unwritten_) + (now - last_frame_);
  if (log_.buffered() > 0 && age_after_next >= flush_interval_) {
    log_.start_writing();
    if (flush_interval_.count() == 0) log_.flush();  // each frame is in the file before the next
  }
  last_frame_ = now;
}

void LogSink::after_end(TargetState& target_state) {
  target_state.send_last_checksums();
  log_.close();
}

void LogSink::message(Channel channel, int64_t utime_us, std::span<const uint8_t> bytes) {
  if (log_.buffered() == 0) oldest_unwritten_ = Clock::now();
  log_.write(name_of(channel), utime_us, bytes);
}

}  // namespace throng
