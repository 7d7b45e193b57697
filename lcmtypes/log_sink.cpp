#include "lcmtypes/log_sink.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "base/errors.h"
#include "lcmtypes/log_format.h"

namespace throng {
namespace {

// One write a megabyte: its cost disappears beside the encoding.
constexpr size_t kBufferBytes = size_t{1} << 20;

[[noreturn]] void fail(const std::filesystem::path& file, const char* what, int error) {
  throw EnvironmentError(
      fmt::format("{}: cannot {} the log: {}", file.string(), what, std::strerror(error)));
}

}  // namespace

LogFile::LogFile(const std::filesystem::path& file)
    : file_(file),
      descriptor_(::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644)) {
  if (descriptor_ < 0) fail(file_, "create", errno);
  buffer_.resize(kBufferBytes);
}

LogFile::~LogFile() {
  if (descriptor_ < 0) return;
  try {
    close();
  } catch (const EnvironmentError&) {
    // An error is already on its way, or the run was given up; close() tells who wants to know.
    if (descriptor_ >= 0) ::close(descriptor_);
  }
}

void LogFile::put(const void* data, size_t size) {
  const auto* from = static_cast<const uint8_t*>(data);
  while (size > 0) {
    if (used_ == buffer_.size()) flush();
    const size_t part = std::min(size, buffer_.size() - used_);
    std::memcpy(buffer_.data() + used_, from, part);
    used_ += part;
    from += part;
    size -= part;
  }
}

void LogFile::copy(int64_t number, std::string_view channel, int64_t stamp_us,
                   std::span<const uint8_t> data) {
  uint8_t head[kLogHeadBytes];
  put_log_head(head, {number, stamp_us, static_cast<int32_t>(channel.size()),
                      static_cast<int32_t>(data.size())});
  put(head, sizeof head);
  put(channel.data(), channel.size());
  put(data.data(), data.size());
  ++events_;
  bytes_ += sizeof head + channel.size() + data.size();
}

void LogFile::flush() {
  size_t written = 0;
  while (written < used_) {
    const ssize_t n = ::write(descriptor_, buffer_.data() + written, used_ - written);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) {
      const int error = errno;
      used_ = 0;  // what is lost is told here; the destructor does not try again
      fail(file_, "write", error);
    }
    written += static_cast<size_t>(n);
  }
  used_ = 0;
  expect_still_there();
}

/// Bytes written to a file that was deleted are lost without an error.
void LogFile::expect_still_there() const {
  struct stat status {};
  if (::fstat(descriptor_, &status) != 0) fail(file_, "write", errno);
  if (S_ISREG(status.st_mode) && status.st_nlink == 0)
    throw EnvironmentError(
        fmt::format("{}: cannot write the log: the file was deleted", file_.string()));
}

void LogFile::close() {
  if (descriptor_ < 0) return;
  flush();
  const int descriptor = descriptor_;
  descriptor_ = -1;
  if (::close(descriptor) != 0) fail(file_, "close", errno);
}

LogSink::LogSink(const std::filesystem::path& file, const LogOptions& options)
    : log_(file),
      encoder_({.with_instance = false,
                .with_clock_times = options.with_clock_times,
                .state_every = options.state_every,
                .part_poses = options.part_poses},
               *this),
      flush_interval_(options.flush_s) {}

void LogSink::begin(const RunInfo& run) {
  encoder_.begin(run);
  for (int chunk = 0; chunk < encoder_.description_chunks(); ++chunk)
    encoder_.send_description_chunk(chunk);
  log_.flush();
  last_frame_ = Clock::now();
}

void LogSink::frame(const RunInfo& run, const Frame& frame) {
  encoder_.frame(run, frame);
  flush_if_due();
}

void LogSink::flush_if_due() {
  const auto now = Clock::now();
  // The next chance comes one frame later: flush now if it would be too late then.
  const auto age_then = (now - oldest_unwritten_) + (now - last_frame_);
  if (log_.buffered() > 0 && age_then >= flush_interval_) log_.flush();
  last_frame_ = now;
}

void LogSink::end(const RunInfo& run, const RunEnd& end) {
  encoder_.end(run, end);
  log_.close();
}

void LogSink::message(Channel channel, int64_t utime_us, std::span<const uint8_t> bytes) {
  if (log_.buffered() == 0) oldest_unwritten_ = Clock::now();
  log_.write(name_of(channel), utime_us, bytes);
}

}  // namespace throng
