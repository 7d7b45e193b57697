// FileWriter writes a file in its own thread, so that a run continues while the kernel copies.
// Invariant: the file always holds a prefix of the bytes put. After an error nothing more is
// written, and the next check() throws. flush() returns after everything is written; a slow file
// slows the run down.
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
  /// naming the file.
  explicit FileWriter(const std::filesystem::path& file);
  ~FileWriter();  ///< writes the remaining bytes if possible
  FileWriter(const FileWriter&) = delete;
  FileWriter& operator=(const FileWriter&) = delete;

  /// Throws EnvironmentError once after a failed write or a deleted file. All functions below do so
  /// as well.
  void check();
  void put(const void* data, size_t size);
  /// Starts writing the bytes put so far, without waiting.
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
  bool is_empty_ = false;  ///< existing content was removed

  /// A ring: buffers from written_ on belong to the thread, that of handed_ is being filled.
  std::array<std::vector<uint8_t>, kBuffers> buffers_;
  std::mutex mutex_;
  std::condition_variable changed_;
  uint64_t handed_ = 0;  ///< number of buffers; changed by the caller only
  uint64_t written_ = 0;
  bool is_over_ = false;
  bool has_failed_ = false;  ///< permanent, because a shorter file is better than one with a gap
  bool is_deleted_ = false;
  int error_ = 0;  ///< not reported yet, like is_deleted_
  std::thread thread_;
};

}  // namespace throng
