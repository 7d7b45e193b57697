// LogReader reads any LCM log event by event.
// Invariant: it distinguishes the end of the file, a torn tail and damage in the middle, and checks
// each length before using it.
#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lcm_io/codec/log_format.h"

namespace throng {

struct LogEvent {
  int64_t number = 0;
  int64_t stamp_us = 0;
  std::string_view channel;  ///< like `data` valid until the next call
  std::span<const uint8_t> data;
  uint64_t offset = 0;  ///< offset of the event in the file
  uint64_t bytes = 0;   ///< size with header
};

class LogReader {
 public:
  enum class Status {
    kEvent,
    kEnd,  ///< the file ends at the end of an event
    kTorn,
    kDamaged  ///< the bytes here are not an event; resync() finds the next
  };

  /// Throws InputError if the file cannot be read or does not begin like a log.
  explicit LogReader(const std::filesystem::path& file);

  /// Reads the next event. After kTorn or kDamaged, problem() describes the place; further calls
  /// return the same.
  Status next(LogEvent& event);
  const std::string& problem() const { return problem_; }

  /// Skips to the next place that begins like an event with possible lengths. Returns false if
  /// there is none.
  bool resync();

  /// Position of the next read. Offsets of events may be sought.
  uint64_t offset() const { return offset_; }
  void seek(uint64_t offset);
  uint64_t size() const { return size_; }

 private:
  size_t read(uint8_t* out, size_t size);
  Status stop(Status status, std::string problem);

  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::filesystem::path path_;
  std::unique_ptr<std::FILE, Close> file_;
  uint64_t size_ = 0;
  uint64_t offset_ = 0;
  Status status_ = Status::kEvent;
  std::string problem_;
  std::vector<uint8_t> buffer_;
};

}  // namespace throng
