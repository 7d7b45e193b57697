#include "lcm_io/log/file_writer.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "base/errors.h"

namespace throng {
namespace {

// One write per megabyte costs little compared with encoding.
constexpr size_t kBufferBytes = size_t{1} << 20;

/// Blocks signals in this thread; the thread of the simulation handles them.
class WithoutSignals {
 public:
  WithoutSignals() {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before_);
  }
  ~WithoutSignals() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  WithoutSignals(const WithoutSignals&) = delete;
  WithoutSignals& operator=(const WithoutSignals&) = delete;

 private:
  sigset_t before_;
};

}  // namespace

FileWriter::FileWriter(const std::filesystem::path& file)
    : file_(file), descriptor_(::open(file.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0644)) {
  if (descriptor_ < 0) fail("create", errno);
  for (std::vector<uint8_t>& buffer : buffers_) buffer.reserve(kBufferBytes);
  const WithoutSignals inherited;
  thread_ = std::thread([this] { work(); });
}

FileWriter::~FileWriter() {
  try {
    if (is_empty_) close();
  } catch (const EnvironmentError&) {
    // Another error is reported already, or the run was abandoned; close() reports this one.
  }
  {
    const std::lock_guard lock(mutex_);
    is_over_ = true;
  }
  changed_.notify_all();
  thread_.join();
  if (descriptor_ >= 0) ::close(descriptor_);
}

void FileWriter::fail(const char* what, int error) const {
  throw EnvironmentError(
      fmt::format("{}: cannot {} the log: {}", file_.string(), what, std::strerror(error)));
}

void FileWriter::empty() {
  if (is_empty_) return;
  // A pipe or device cannot be truncated (EINVAL).
  if (::ftruncate(descriptor_, 0) != 0 && errno != EINVAL) fail("write", errno);
  is_empty_ = true;
}

void FileWriter::put(const void* data, size_t size) {
  empty();
  const auto* from = static_cast<const uint8_t*>(data);
  while (size > 0) {
    if (filled().size() == kBufferBytes) start_writing();
    std::vector<uint8_t>& to = filled();
    const size_t part = std::min(size, kBufferBytes - to.size());
    to.insert(to.end(), from, from + part);
    from += part;
    size -= part;
  }
}

/// Returns when at most that many buffers are not written yet.
void FileWriter::wait_until_pending(size_t max_buffers) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return handed_ - written_ <= max_buffers; });
  throw_if_failed();
}

void FileWriter::check() {
  const std::lock_guard lock(mutex_);
  throw_if_failed();
}

void FileWriter::throw_if_failed() {
  if (error_ == 0 && !is_deleted_) return;
  filled().clear();  // reported here; the destructor does not try again
  const int error = std::exchange(error_, 0);
  if (error != 0) fail("write", error);
  is_deleted_ = false;
  throw EnvironmentError(
      fmt::format("{}: cannot write the log: the file was deleted", file_.string()));
}

void FileWriter::start_writing() {
  wait_until_pending(kBuffers - 2);
  if (filled().empty()) return;
  {
    const std::lock_guard lock(mutex_);
    ++handed_;
  }
  changed_.notify_all();
}

void FileWriter::flush() {
  start_writing();
  wait_until_pending(0);
}

void FileWriter::close() {
  if (descriptor_ < 0) return;
  empty();
  flush();
  const int descriptor = std::exchange(descriptor_, -1);
  if (::close(descriptor) != 0) fail("close", errno);
}

void FileWriter::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return is_over_ || written_ < handed_; });
    if (written_ == handed_) return;
    std::vector<uint8_t>& bytes = buffers_[written_ % kBuffers];
    const bool is_sound = !has_failed_;
    lock.unlock();  // this thread alone uses the buffer
    if (is_sound) write(bytes);
    bytes.clear();
    lock.lock();
    ++written_;
    changed_.notify_all();
  }
}

void FileWriter::write(const std::vector<uint8_t>& bytes) {
  int error = 0;
  for (size_t written = 0; written < bytes.size() && error == 0;) {
    const ssize_t n = ::write(descriptor_, bytes.data() + written, bytes.size() - written);
    if (n >= 0)
      written += static_cast<size_t>(n);
    else if (errno != EINTR)
      error = errno;
  }
  // Bytes written to a deleted file are lost without an error.
  struct stat status {};
  if (error == 0 && ::fstat(descriptor_, &status) != 0) error = errno;
  const std::lock_guard lock(mutex_);
  error_ = error;
  is_deleted_ = error == 0 && S_ISREG(status.st_mode) && status.st_nlink == 0;
  has_failed_ = error_ != 0 || is_deleted_;
}

}  // namespace throng
