// Writes a file from a thread of its own, so that a run goes on while the kernel copies.
// One rule: what the file holds is always the beginning of what was put. After an error nothing
// more is written, and the next check() tells; flush() returns only when everything is written, and
// a file that is too slow slows the run down.
#pragma once

#include <array>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <vector>

namespace throng {

class FileWriter {
 public:
  /// Opens or creates the file; the first put(), or close(), empties it. Throws EnvironmentError
  /// naming it.
  explicit FileWriter(const std::filesystem::path& file);
  ~FileWriter();  ///< writes what is left, as far as it can
  FileWriter(const FileWriter&) = delete;
  FileWriter& operator=(const FileWriter&) = delete;

  /// Throws EnvironmentError, once, when something could not be written, also where the file was
  /// deleted. Every call below does so, too.
  void check();
  void put(const void* data, size_t size);
  /// What was put so far goes to the file from now on.
  void start_writing();
  void flush();
  void close();
  size_t buffered() const { return filled().size(); }

 private:
  /// Two frames of a hundred thousand people.
  static constexpr size_t kBuffers = 16;

  std::vector<uint8_t>& filled() { return buffers_[handed_ % kBuffers]; }
  const std::vector<uint8_t>& filled() const { return buffers_[handed_ % kBuffers]; }
  void empty();
  void wait_until_pending(size_t max_buffers);
  void throw_if_failed();
  void write(const std::vector<uint8_t>& bytes);
  void work();
  [[noreturn]] void fail(const char* what, int error) const;

  std::filesystem::path file_;
  int descriptor_ = -1;
  bool is_empty_ = false;  ///< of what stood there before

  /// A ring: those from written_ on are the thread's, the one of handed_ is being filled.
  std::array<std::vector<uint8_t>, kBuffers> buffers_;
  std::mutex mutex_;
  std::condition_variable changed_;
  uint64_t handed_ = 0;  ///< buffers; changed by the caller only
  uint64_t written_ = 0;
  bool is_over_ = false;
  bool has_failed_ = false;  ///< for good: a hole in the file would be worse than its end
  bool is_deleted_ = false;
  int error_ = 0;  ///< not reported yet, like is_deleted_
  std::thread thread_;
};

}  // namespace throng
