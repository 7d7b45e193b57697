// A temporary file without a name, for what is larger than memory should be, and values that it
// holds while they are put in order.
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

/// It goes with the process, however that ends; pages that the system caches are its own.
class AnonymousFile {
 public:
  /// In $TMPDIR, or /tmp. Throws EnvironmentError, as the others, naming the folder and the way
  /// out.
  AnonymousFile();
  ~AnonymousFile();
  AnonymousFile(const AnonymousFile&) = delete;
  AnonymousFile& operator=(const AnonymousFile&) = delete;

  /// From several threads at once, for parts that do not overlap.
  void write(int64_t offset, std::span<const std::byte> bytes);
  /// The same; all of it has been written.
  void read(int64_t offset, std::span<std::byte> bytes) const;

 private:
  int descriptor_ = -1;
};

/// Values that are put in order although they are too many for memory, which holds one run of them,
/// however many there are; the others lie sorted in the file and are merged as they are visited.
template <typename T, typename Less>
class ExternalSorter {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  /// Values in memory until they are written: a run.
  static constexpr size_t kRun = 1 << 15;

  /// Throws EnvironmentError, as for_each().
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

  /// Calls visit(value) for all, in ascending order.
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
    Reader last;  // what was never written
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
  /// Goes through a run, a piece at a time.
  struct Reader {
    std::vector<T> buffer;
    size_t at = 0;
    size_t left_from = 0, left_to = 0;  ///< in the file, not read yet
    const T& value() const { return buffer[at]; }
  };

  bool refill(Reader& reader) const {
    // All readers together have room for two runs.
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
