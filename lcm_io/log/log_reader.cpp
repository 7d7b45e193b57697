#include "lcm_io/log/log_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>

#include "base/errors.h"

namespace throng {
namespace {

bool has_possible_lengths(const LogHead& head) {
  return head.channel_bytes > 0 && head.channel_bytes <= kMaxChannelBytes && head.data_bytes >= 0 &&
         head.data_bytes <= kMaxDataBytes;
}

}  // namespace

LogReader::LogReader(const std::filesystem::path& file) : path_(file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))
    throw InputError(file.string(), "an LCM log",
                     std::filesystem::is_directory(file, error) ? "a directory"
                     : std::filesystem::exists(file, error)     ? "a special file"
                                                                : "no such file");
  size_ = std::filesystem::file_size(file, error);
  file_.reset(std::fopen(file.c_str(), "rb"));
  if (error || !file_) throw InputError(file.string(), "an LCM log", "a file that cannot be read");
  uint8_t magic[4];
  const size_t got = std::fread(magic, 1, sizeof magic, file_.get());
  if (got == 0) throw InputError(file.string(), "an LCM log", "an empty file");
  if (got < sizeof magic)
    throw InputError(file.string(), "an LCM log", fmt::format("{} bytes", got));
  if (get_big_endian<uint32_t>(magic) != kLogMagic)
    throw InputError(file.string(), "an LCM log, which begins with eda1da01",
                     fmt::format("{:08x}", get_big_endian<uint32_t>(magic)));
  seek(0);
}

void LogReader::seek(uint64_t offset) {
  offset_ = std::min(offset, size_);
  status_ = Status::kEvent;
  problem_.clear();
  if (::fseeko(file_.get(), static_cast<off_t>(offset_), SEEK_SET) != 0)
    throw EnvironmentError(path_.string() + ": cannot seek");
}

size_t LogReader::read(uint8_t* out, size_t size) { return std::fread(out, 1, size, file_.get()); }

LogReader::Status LogReader::stop(Status status, std::string problem) {
  status_ = status;
  problem_ = std::move(problem);
  return status;
}

LogReader::Status LogReader::next(LogEvent& event) {
  if (status_ != Status::kEvent) return status_;
  uint8_t bytes[kLogHeadBytes];
  const size_t got = read(bytes, sizeof bytes);
  if (got == 0) return stop(Status::kEnd, "");
  if (got < sizeof bytes)
    return stop(
        Status::kTorn,
        fmt::format("byte {}: the file ends {} bytes into the head of an event", offset_, got));
  LogHead head;
  if (!get_log_head(bytes, head))
    return stop(Status::kDamaged, fmt::format("byte {}: expected eda1da01, found {:08x}", offset_,
                                              get_big_endian<uint32_t>(bytes)));
  if (!has_possible_lengths(head))
    return stop(Status::kDamaged, fmt::format("byte {}: impossible lengths (channel {}, data {})",
                                              offset_, head.channel_bytes, head.data_bytes));
  const auto channel_bytes = static_cast<size_t>(head.channel_bytes);
  const size_t body = channel_bytes + static_cast<size_t>(head.data_bytes);
  if (buffer_.size() < body) buffer_.resize(body);
  const size_t found = read(buffer_.data(), body);
  if (found < body)
    return stop(Status::kTorn, fmt::format("byte {}: the file ends {} bytes before the event does",
                                           offset_, body - found));
  event.number = head.number;
  event.stamp_us = head.stamp_us;
  event.channel = {reinterpret_cast<const char*>(buffer_.data()), channel_bytes};
  event.data = {buffer_.data() + channel_bytes, static_cast<size_t>(head.data_bytes)};
  event.offset = offset_;
  event.bytes = kLogHeadBytes + body;
  offset_ += event.bytes;
  return Status::kEvent;
}

bool LogReader::resync() {
  // Windows overlap by one header, so that each header lies completely in one of them.
  constexpr size_t kWindow = 1 << 16;
  std::vector<uint8_t> window(kWindow);
  for (uint64_t from = offset_ + 1; from + kLogHeadBytes <= size_;
       from += kWindow - kLogHeadBytes + 1) {
    seek(from);
    const size_t got = read(window.data(), kWindow);
    for (size_t i = 0; i + kLogHeadBytes <= got; ++i) {
      LogHead head;
      if (window[i] != 0xED || !get_log_head(window.data() + i, head) ||
          !has_possible_lengths(head))
        continue;
      seek(from + i);
      return true;
    }
  }
  seek(size_);
  return false;
}

}  // namespace throng
