// Records a run as an LCM log that LCM's own tools read.
// One rule: the bytes depend on the run alone (stamps are simulation time, instance is 0), and a
// byte that could not be written is an error at the next frame.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "lcm_io/codec/encoder.h"
#include "lcm_io/log/file_writer.h"

namespace throng {

/// An LCM log file. An event is, big-endian:
/// u32 0xEDA1DA01 | i64 number | i64 stamp | i32 channel length | i32 data length | channel | data.
/// liblcm's own file provider stamps wall-clock time and does not report a full disk.
class LogFile {
 public:
  /// Opens or creates the file; the first event, or close(), empties it. Throws EnvironmentError
  /// naming it.
  explicit LogFile(const std::filesystem::path& file) : file_(file) {}

  /// Throws EnvironmentError when a buffer could not be written.
  void write(std::string_view channel, int64_t stamp_us, std::span<const uint8_t> data) {
    copy(events_, channel, stamp_us, data);
  }
  /// Writes an event under the number that it had elsewhere.
  void copy(int64_t number, std::string_view channel, int64_t stamp_us,
            std::span<const uint8_t> data);
  /// Throws EnvironmentError, once, when something could not be written.
  void check() { file_.check(); }
  /// What was written so far goes to the file from now on.
  void start_writing() { file_.start_writing(); }
  void flush() { file_.flush(); }
  void close() { file_.close(); }

  uint64_t bytes() const { return bytes_; }  ///< written and buffered
  int64_t events() const { return events_; }
  size_t buffered() const { return file_.buffered(); }

 private:
  FileWriter file_;
  uint64_t bytes_ = 0;
  int64_t events_ = 0;
};

struct LogOptions {
  double state_every = 1;  ///< see EncoderOptions
  bool part_poses = false;
  bool with_clock_times = false;  ///< true: the log differs from run to run
  int threads = 1;                ///< that encode
  /// A frame goes to the file after at most this, unless a single frame takes longer; 0: it is
  /// there before the next one. A kill -9 costs that much, and the 16 MB at most that a slow disk
  /// has not taken.
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
  size_t buffered() const { return log_.buffered(); }  ///< bytes that wait for flush_s

 private:
  using Clock = std::chrono::steady_clock;

  LogFile log_;
  LogOptions options_;
  std::chrono::duration<double> flush_interval_;
  Clock::time_point oldest_unwritten_{};
  Clock::time_point last_frame_{};
};

}  // namespace throng
