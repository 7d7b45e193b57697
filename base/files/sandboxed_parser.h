// parse_sandboxed() runs a foreign parser of a binary or mesh file in a child process; only bytes
// come back.
// Invariant: a crash, hang, memory exhaustion or memory corruption in the library ends as bytes or
// an InputError in bounded time. Callers must validate the bytes.
//
// The child is forked and executes no other program: no second program has to be found, installed
// or matched in version. Forking is sound because the child
// - runs the parser, sends the result and ends by _exit: nothing is flushed twice and no destructor
//   of the parent runs, even if the library calls exit();
// - has no descriptor but the file and the pipe; 0, 1 and 2 are /dev/null. It can write no file and
//   leaves no core;
// - needs no lock that another thread of the parent could hold. glibc keeps malloc usable, and the
//   parent never runs the parser. Worker threads do not exist in the child: a parser must not use
//   them;
// - dies with its parent, and leaves signals that stop a program to the parent.
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

/// The parser and its format, for error messages.
struct SandboxedParser {
  std::string library;   ///< "assimp"
  std::string expected;  ///< "a ply mesh"
  std::string remedy;    ///< "export it again, for example as .stl"
};

/// Limits for one file. Each MiB adds half a second of processor time and a second of wall time:
/// a large file of a slow text format is legitimate.
struct SandboxLimits {
  uint64_t max_file_bytes = 512u << 20;
  /// Processor time in whole seconds; valid small files take milliseconds.
  int cpu_s = 5;
  /// Wall time, for a child that waits. Longer: a busy machine must not change a result.
  double wall_s = 9;
  /// Memory on top of the parent's. Under the address and thread sanitizers the parent polls it
  /// every few milliseconds, because shadow memory exceeds any limit of the operating system.
  uint64_t max_memory_bytes = uint64_t{2} << 30;
  /// Memory per byte of the file; 0 if the file is read in pieces.
  uint64_t memory_per_file_byte = 16;
  uint64_t max_result_bytes = uint64_t{1} << 30;
};

/// Thrown by a parser in the child: becomes InputError(file, expected, found) in the parent.
struct ParseFailure : std::runtime_error {
  ParseFailure(std::string what_was_expected, std::string what_was_found)
      : std::runtime_error(what_was_found),
        expected(std::move(what_was_expected)),
        found(std::move(what_was_found)) {}
  std::string expected;
  std::string found;
};

namespace sandbox {

/// Header of a reply; `size` bytes follow, for kRejected `expected` and then `found`. Any number of
/// pieces may precede the last reply.
struct ReplyHeader {
  enum class Kind : uint32_t { kBytes = 1, kRejected, kThrew, kOutOfMemory, kPiece };
  static constexpr uint32_t kMagic = 0x54485241;
  uint32_t magic = kMagic;
  Kind kind = Kind::kBytes;
  uint64_t expected_size = 0;  ///< size of the first text, for kRejected
  uint64_t size = 0;
};

}  // namespace sandbox

/// Opens the file, runs `parse` on it in a child process and returns the bytes it produced. The
/// file may have corrupted the child's memory: validate the bytes like the file.
/// Throws InputError naming the file if it is not regular, too large, `parse` throws, or the child
/// crashes or exceeds a limit; EnvironmentError if no child can be started.
std::vector<uint8_t> parse_sandboxed(
    const std::filesystem::path& file, const SandboxedParser& parser, const SandboxLimits& limits,
    const std::function<std::vector<uint8_t>(const RegularFile&)>& parse);

/// Sends a part of the result from the child, at most kMaxPieceBytes at a time.
using SendPiece = std::function<void(std::span<const uint8_t>)>;
inline constexpr size_t kMaxPieceBytes = 1 << 20;

/// As parse_sandboxed(), for results too large for memory. `take` is called in the parent with each
/// piece that `parse` sends, in order. Exceptions of `take` end the child and are passed on; its
/// time does not count. All pieces together are within limits.max_result_bytes.
void parse_sandboxed_in_pieces(
    const RegularFile& file, const SandboxedParser& parser, const SandboxLimits& limits,
    const std::function<void(const RegularFile&, const SendPiece&)>& parse,
    const std::function<void(std::span<const uint8_t>)>& take);

}  // namespace throng
