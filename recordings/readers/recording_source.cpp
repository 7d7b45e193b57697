// A recording's file: its first bytes, and all of its lines.
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>
#include <vector>

#include "base/errors.h"
#include "recordings/readers/gzip.h"
#include "recordings/readers/recording_reader.h"

namespace throng {
namespace {

constexpr size_t kPieceBytes = 1 << 20;

/// The next bytes, fewer at the end.
size_t read_piece(const RegularFile& file, uint64_t at, std::span<char> out) {
  while (true) {
    const ssize_t count =
        ::pread(file.descriptor(), out.data(), out.size(), static_cast<off_t>(at));
    if (count >= 0) return static_cast<size_t>(count);
    if (errno != EINTR) throw InputError(file.path().string(), "a recording", std::strerror(errno));
  }
}

}  // namespace

RecordingSource::RecordingSource(const std::filesystem::path& path)
    : file_(path, "a recording", std::numeric_limits<int64_t>::max()) {
  head_.resize(std::min<uint64_t>(file_.size(), kHeadBytes));
  head_.resize(read_piece(file_, 0, head_));
  is_packed_ = is_gzip(head_);
  if (!is_packed_) return;
  head_.clear();
  unpack(
      file_, [&](std::string_view piece) { head_ += piece.substr(0, kHeadBytes - head_.size()); },
      kHeadBytes);
}

void RecordingSource::lines(LineTaker& taker) const {
  LineCutter cutter(file_.path(), taker);
  if (is_packed_) {
    unpack(file_, [&](std::string_view piece) { cutter.push(piece); });
    cutter.end();
    return;
  }
  std::vector<char> piece(kPieceBytes);
  uint64_t at = 0;
  while (const size_t count = read_piece(file_, at, piece)) {
    cutter.push({piece.data(), count});
    at += count;
  }
  cutter.end();
}

}  // namespace throng
