// RecordingSource opens a recording and gives its first bytes and its lines.
#include <fmt/format.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <string_view>
#include <vector>

#include "base/errors.h"
#include "base/files/regular_file.h"
#include "base/files/sandboxed_parser.h"
#include "recordings/readers/recording_reader.h"

namespace throng {

// Decompression of gzip files. Invariant: zlib runs in a child process, see
// base/files/sandboxed_parser.h. Files with an implausible compression ratio are rejected.

bool is_gzip(std::string_view head);

/// Decompresses piece by piece, at most `max` bytes. Throws InputError for a damaged, incomplete
/// or implausible file; discard the pieces then.
void unpack(const RegularFile& file, const std::function<void(std::string_view)>& take,
            uint64_t max = std::numeric_limits<uint64_t>::max());

namespace {

constexpr size_t kPieceBytes = 1 << 20;

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

void RecordingSource::lines(LineHandler& handler) const {
  LineSplitter cutter(file_.path(), handler);
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

namespace {

constexpr std::string_view kMagic = "\x1f\x8b";
constexpr const char* kExpectedGzip = "a gzip file";
/// Tables of numbers shrink to a third or a tenth; the format's maximum ratio is 1032.
constexpr uint64_t kMaxRatio = 300;
constexpr uint64_t kAnyRatioBytes = 16 << 20;
constexpr size_t kUnpackedBytes = 256 << 10;

/// Inflater releases the state of zlib; runs in the child.
struct Inflater {
  z_stream stream{};
  Inflater() {
    if (inflateInit2(&stream, MAX_WBITS + 16) != Z_OK) throw std::bad_alloc();
  }
  ~Inflater() { inflateEnd(&stream); }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;
};

void inflate_all(const RegularFile& file, uint64_t max, const SendPiece& send) {
  Inflater inflater;
  z_stream& stream = inflater.stream;
  std::vector<uint8_t> in(kUnpackedBytes), out(kUnpackedBytes);
  uint64_t read = 0, made = 0;
  int result = Z_STREAM_END;
  while (made < max) {
    if (stream.avail_in == 0) {
      const ssize_t count =
          ::pread(file.descriptor(), in.data(), in.size(), static_cast<off_t>(read));
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) break;
      read += static_cast<uint64_t>(count);
      stream.next_in = in.data();
      stream.avail_in = static_cast<uInt>(count);
      if (result == Z_STREAM_END && inflateReset(&stream) != Z_OK) throw std::bad_alloc();
    } else if (result == Z_STREAM_END && inflateReset(&stream) != Z_OK) {
      throw std::bad_alloc();
    }
    stream.next_out = out.data();
    stream.avail_out = static_cast<uInt>(out.size());
    result = inflate(&stream, Z_NO_FLUSH);
    if (result != Z_OK && result != Z_STREAM_END && result != Z_BUF_ERROR)
      throw ParseFailure(kExpectedGzip,
                         fmt::format("one that is damaged after {} decompressed bytes: {}", made,
                                     stream.msg != nullptr ? stream.msg : "bad data"));
    const size_t count = out.size() - stream.avail_out;
    made += count;
    if (made > kAnyRatioBytes && made > kMaxRatio * file.size())
      throw ParseFailure(
          fmt::format("{} that holds at most {} times its size", kExpectedGzip, kMaxRatio), "more");
    send(std::span(out).first(count));
  }
  if (made < max && result != Z_STREAM_END)
    throw ParseFailure(fmt::format("{} to its end", kExpectedGzip),
                       fmt::format("one that is cut short after {} decompressed bytes", made));
}

}  // namespace

bool is_gzip(std::string_view head) { return head.starts_with(kMagic); }

void unpack(const RegularFile& file, const std::function<void(std::string_view)>& take,
            uint64_t max) {
  const SandboxedParser zlib{
      .library = "zlib", .expected = kExpectedGzip, .remedy = "decompress it first"};
  const SandboxLimits limits{.max_file_bytes = uint64_t{64} << 30,
                             .max_memory_bytes = 64 << 20,
                             .memory_per_file_byte = 0,
                             .max_result_bytes = uint64_t{1} << 40};
  parse_sandboxed_in_pieces(
      file, zlib, limits,
      [&](const RegularFile& opened, const SendPiece& send) { inflate_all(opened, max, send); },
      [&](std::span<const uint8_t> piece) {
        take({reinterpret_cast<const char*>(piece.data()), piece.size()});
      });
}

}  // namespace throng
