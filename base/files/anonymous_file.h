// AnonymousFile is a temporary file without a name, for data too large for memory; ExternalSorter
// sorts values through one.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <queue>
#include <span>
#include <type_traits>
#include <vector>

namespace throng {

/// Ends with the process, however that ends. Cached pages belong to the system.
class AnonymousFile {
 public:
  /// Creates the file in $TMPDIR, or /tmp. All members throw EnvironmentError, naming the folder
  /// and the remedy.
  AnonymousFile();
  ~AnonymousFile();
  AnonymousFile(const AnonymousFile&) = delete;
  AnonymousFile& operator=(const AnonymousFile&) = delete;

  /// Safe from several threads if their ranges do not overlap.
  void write(int64_t offset, std::span<const std::byte> bytes);
  /// As write(). The range must have been written.
  void read(int64_t offset, std::span<std::byte> bytes) const;

  /// For another process that fills the file.
  int descriptor() const { return descriptor_; }

 private:
  int descriptor_ = -1;
};

/// Sorts values that are too many for memory. Memory holds one run; the other runs lie sorted in
/// the file and are merged when visited.
template <typename T, typename Less>
class ExternalSorter {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  /// Number of values in memory before they are written (a run).
  static constexpr size_t kRun = 1 << 15;

  /// Throws EnvironmentError.
  void add(const T& value) {
    tail_.push_back(value);
    if (tail_.size() < kRun) return;
    std::sort(tail_.begin(), tail_.end(), Less{});
    if (file_ == nullptr) file_ = std::make_unique<AnonymousFile>();
    file_->write(static_cast<int64_t>(runs_ * kRun * sizeof(T)), std::as_bytes(std::span(tail_)));
    ++runs_;
    tail_.clear();
  }

  size_t size() const { return runs_ * kRun + tail_.size(); }

  /// Calls visit(value) for all values in ascending order. Throws EnvironmentError.
  template <typename Visit>
  void for_each(const Visit& visit) const {
    std::vector<T> tail = tail_;
    std::sort(tail.begin(), tail.end(), Less{});
    std::vector<Reader> readers(runs_);
    const auto later = [](const Reader* a, const Reader* b) {
      return Less{}(b->value(), a->value());
    };
    std::priority_queue<Reader*, std::vector<Reader*>, decltype(later)> next(later);
    for (size_t run = 0; run < runs_; ++run) {
      readers[run].left_from = run * kRun;
      readers[run].left_to = (run + 1) * kRun;
      if (refill(readers[run])) next.push(&readers[run]);
    }
    Reader last;  // the values that are still in memory
    last.buffer = std::move(tail);
    if (!last.buffer.empty()) next.push(&last);
    while (!next.empty()) {
      Reader* const reader = next.top();
      next.pop();
      visit(reader->value());
      ++reader->at;
      if (reader->at < reader->buffer.size() || refill(*reader)) next.push(reader);
    }
  }

 private:
  /// Reads a run in pieces.
  struct Reader {
    std::vector<T> buffer;
    size_t at = 0;
    size_t left_from = 0, left_to = 0;  ///< range of the file that is not read yet
    const T& value() const { return buffer[at]; }
  };

  bool refill(Reader& reader) const {
    // All readers together buffer two runs.
    const size_t room = std::max<size_t>(16, 2 * kRun / std::max<size_t>(1, runs_));
    const size_t count = std::min(room, reader.left_to - reader.left_from);
    if (count == 0) return false;
    reader.buffer.resize(count);
    file_->read(static_cast<int64_t>(reader.left_from * sizeof(T)),
                std::as_writable_bytes(std::span(reader.buffer)));
    reader.left_from += count;
    reader.at = 0;
    return true;
  }

  std::vector<T> tail_;
  size_t runs_ = 0;
  std::unique_ptr<AnonymousFile> file_;
};

}  // namespace throng
