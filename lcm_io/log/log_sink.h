// LogSink records a run as an LCM log that LCM's tools read.
// Invariant: the bytes depend on the run only (stamps are simulation time, instance is 0). A failed
// write throws in the next frame.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "lcm_io/codec/encoder.h"
#include "lcm_io/log/file_writer.h"

namespace throng {

/// An LCM log file. An event is, big-endian: u32 0xEDA1DA01, i64 number, i64 stamp, i32 channel
/// length, i32 data length, channel, data. It replaces liblcm's file provider, which stamps clock
/// time and does not report a full disk.
class LogFile {
 public:
  /// Opens or creates the file; the first event, or close(), empties it. Throws EnvironmentError
  /// naming it.
  explicit LogFile(const std::filesystem::path& file) : file_(file) {}

  /// Throws EnvironmentError if a buffer could not be written.
  void write(std::string_view channel, int64_t stamp_us, std::span<const uint8_t> data) {
    copy(events_, channel, stamp_us, data);
  }
  /// Writes an event with its number from another log.
  void copy(int64_t number, std::string_view channel, int64_t stamp_us,
            std::span<const uint8_t> data);
  /// Throws EnvironmentError once after a failed write.
  void check() { file_.check(); }
  /// Starts writing the buffered events, without waiting.
  void start_writing() { file_.start_writing(); }
  void flush() { file_.flush(); }
  void close() { file_.close(); }

  uint64_t bytes() const { return bytes_; }
  int64_t events() const { return events_; }
  size_t buffered() const { return file_.buffered(); }

 private:
  FileWriter file_;
  uint64_t bytes_ = 0;
  int64_t events_ = 0;
};

struct LogOptions {
  double state_every = 1;
  bool part_poses = false;
  bool with_clock_times = false;  ///< true: the log differs from run to run
  int threads = 1;
  /// Maximum time until a frame is in the file, unless a single frame takes longer; 0: before the
  /// next frame. A kill -9 loses this much, and up to 16 MB that a slow disk has not taken.
  double flush_s = 0.25;
};

class LogSink final : public TargetSink {
 public:
  /// Throws EnvironmentError naming the file.
  LogSink(const std::filesystem::path& file, const LogOptions& options = {});

  EncoderOptions encoding() const override;
  void message(Channel channel, int64_t utime_us, std::span<const uint8_t> bytes) override;
  void after_begin(TargetState& target_state) override;
  void after_frame(TargetState& target_state) override;
  void after_end(TargetState& target_state) override;

  uint64_t bytes() const { return log_.bytes(); }
  int64_t messages() const { return log_.events(); }
  size_t buffered() const { return log_.buffered(); }

 private:
  using Clock = std::chrono::steady_clock;

  LogFile log_;
  LogOptions options_;
  std::chrono::duration<double> flush_interval_;
  Clock::time_point oldest_unwritten_{};
  Clock::time_point last_frame_{};
};

}  // namespace throng
