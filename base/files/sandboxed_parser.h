// The one door for every binary or mesh file that a foreign library parses for us: the parser runs
// in a child process and only bytes come back.
// One rule: whatever the library does with the file (crash, hang, eat memory, scribble over its
// own), the caller gets bytes or an InputError in bounded time, and trusts neither.
//
// The child is forked and never executes another program: there is none to be found, installed or
// matched in version, for a user of the library or from within an interpreter as little as for the
// command. That is sound because the child
// - runs the parser, sends what it made and ends by _exit: nothing is flushed twice, no destructor
//   of the parent runs, also not where the library calls exit();
// - has no descriptor but the file and the pipe; 0, 1 and 2 are /dev/null, so that a library's
//   chatter does not leak; it can write no file and leaves no core;
// - needs no lock that another thread of the parent could have held: glibc keeps malloc usable in
//   the child, and as the parent never runs the parser, nobody holds a lock of it. Worker threads
//   do not exist in the child: a parser must not use them;
// - dies with its parent. Signals that stop a program are the parent's business.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/files/regular_file.h"

namespace throng {

/// The parser and what it parses, for the words of an error.
struct SandboxedParser {
  std::string library;   ///< "assimp"
  std::string expected;  ///< "a ply mesh"
  std::string remedy;    ///< "export it again, for example as .stl"
};

/// What a file may cost. A MiB of it adds half a second of processor time and a second by the
/// clock: a large file of a slow text format is no attack.
struct SandboxLimits {
  uint64_t max_file_bytes = 512u << 20;
  /// Processor time, in whole seconds; what is sound and small takes milliseconds.
  int cpu_s = 5;
  /// By the clock, for a child that waits. Longer, since a busy machine must not change a result.
  double wall_s = 9;
  /// On top of what the parent has. Not kept under the address and thread sanitizers by the
  /// operating system, because their shadow memory is larger than any limit: there the parent
  /// looks at it every few milliseconds.
  uint64_t max_memory_bytes = uint64_t{2} << 30;
  /// What a byte of the file adds; none where it is read and forgotten piece by piece.
  uint64_t memory_per_file_byte = 16;
  uint64_t max_result_bytes = uint64_t{1} << 30;
};

/// Thrown by a parser within the child: becomes InputError(file, expected, found) in the parent.
struct ParseFailure : std::runtime_error {
  ParseFailure(std::string what_was_expected, std::string what_was_found)
      : std::runtime_error(what_was_found),
        expected(std::move(what_was_expected)),
        found(std::move(what_was_found)) {}
  std::string expected;
  std::string found;
};

namespace sandbox {

/// How an answer begins; `size` bytes follow, for kRefused `expected` and then `found`. Any number
/// of pieces may come before it.
struct ReplyHeader {
  enum class Kind : uint32_t { kBytes = 1, kRefused, kThrew, kOutOfMemory, kPiece };
  static constexpr uint32_t kMagic = 0x54485241;
  uint32_t magic = kMagic;
  Kind kind = Kind::kBytes;
  uint64_t expected_size = 0;  ///< of the first text, for kRefused
  uint64_t size = 0;
};

}  // namespace sandbox

/// Opens the file, runs `parse` over it in a child process and returns the bytes it produced. They
/// come from a process whose memory the file may have scribbled over: check them like the file.
/// Throws InputError naming the file if that is no regular file or too large, if `parse` throws, or
/// if the child crashes or goes beyond a limit; EnvironmentError if there can be no child.
std::vector<uint8_t> parse_sandboxed(
    const std::filesystem::path& file, const SandboxedParser& parser, const SandboxLimits& limits,
    const std::function<std::vector<uint8_t>(const RegularFile&)>& parse);

/// In the child: sends on a part of what it makes. At most kMaxPieceBytes at a time.
using SendPiece = std::function<void(std::span<const uint8_t>)>;
inline constexpr size_t kMaxPieceBytes = 1 << 20;

/// The same for what is too large for memory: `take` is called in the parent with each piece that
/// `parse` sends, in their order. What it throws ends the child and is passed on; the time that it
/// takes is not the child's. All pieces together are within limits.max_result_bytes.
void parse_sandboxed_in_pieces(
    const RegularFile& file, const SandboxedParser& parser, const SandboxLimits& limits,
    const std::function<void(const RegularFile&, const SendPiece&)>& parse,
    const std::function<void(std::span<const uint8_t>)>& take);

}  // namespace throng
