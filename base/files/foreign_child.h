// The child's side of base/files/foreign.h: shuts itself in, parses, answers.
// One rule: nothing of the parent is touched; the only way out is _exit.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <functional>
#include <vector>

#include "base/files/foreign.h"

namespace throng::foreign {

/// Under these sanitizers a process maps terabytes of shadow memory: no limit of the operating
/// system can tell them from the parser's own.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kHasShadowMemory = true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
inline constexpr bool kHasShadowMemory = true;
#else
inline constexpr bool kHasShadowMemory = false;
#endif
#else
inline constexpr bool kHasShadowMemory = false;
#endif

/// How an answer begins; `size` bytes follow, for kRefused `expected` and then `found`. Any number
/// of pieces may come before it.
struct Answer {
  enum class Kind : uint32_t { kBytes = 1, kRefused, kThrew, kOutOfMemory, kPiece };
  static constexpr uint32_t kMagic = 0x54485241;
  uint32_t magic = kMagic;
  Kind kind = Kind::kBytes;
  uint64_t expected_size = 0;  ///< of the first text, for kRefused
  uint64_t size = 0;
};
/// Longer texts are cut: an error is a line.
inline constexpr uint64_t kMostTextBytes = 1000;

/// Of what the file at hand may cost.
struct Budget {
  int cpu_s = 0;
  double wall_s = 0;
  uint64_t memory_bytes = 0;
  uint64_t result_bytes = 0;
};

/// What it returns is sent, too.
using Parse = std::function<std::vector<uint8_t>(const RegularFile&, const SendPiece&)>;

/// Runs the parser in the process that was just forked.
[[noreturn]] void answer(const RegularFile& file, int pipe, pid_t parent, const Budget& budget,
                         const Parse& parse);

/// The bytes that a process has mapped, or holds in memory; 0 where /proc does not tell.
enum class Memory { kMapped, kResident };
uint64_t memory_of(pid_t process, Memory kind);

}  // namespace throng::foreign
