#include "base/files/foreign_child.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <span>
#include <string_view>

namespace throng::foreign {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || defined(__clang__)
// From <sanitizer/common_interface_defs.h>; there without a sanitizer, it is null.
// NOLINTNEXTLINE(bugprone-reserved-identifier,readability-identifier-naming): the name is theirs
extern "C" __attribute__((weak)) void __sanitizer_set_report_path(const char* path);
// NOLINTNEXTLINE(bugprone-reserved-identifier,readability-identifier-naming): the name is theirs
extern "C" __attribute__((weak)) void __sanitizer_set_death_callback(void (*callback)());
#endif

namespace {

/// What stops a program is for the parent to hear, and ends the child with it; everything else does
/// what it does in a program that does not handle it.
void reset_signals() {
  for (int number = 1; number < NSIG; ++number) {
    const bool is_for_parent =
        number == SIGINT || number == SIGQUIT || number == SIGHUP || number == SIGTERM;
    // SIGXFSZ: a file of no bytes is an error to whoever writes it, not a death.
    ::signal(number, is_for_parent || number == SIGXFSZ ? SIG_IGN : SIG_DFL);
  }
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
}

void close_between(int first, int last) {
  if (first <= last) ::close_range(static_cast<unsigned>(first), static_cast<unsigned>(last), 0);
}

/// Everything but the two: files, sockets and pipes of the parent are not the parser's to write to.
void keep_only(int one, int other) {
  const int null = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  for (int number = STDIN_FILENO; number <= STDERR_FILENO; ++number)
    null >= 0 ? ::dup2(null, number) : ::close(number);
  const auto [low, high] = std::minmax(one, other);
  close_between(STDERR_FILENO + 1, low - 1);
  close_between(low + 1, high - 1);
  ::close_range(static_cast<unsigned>(high) + 1, ~0u, 0);
}

void lower(__rlimit_resource resource, rlim_t soft, rlim_t hard) {
  rlimit limit = {};
  if (::getrlimit(resource, &limit) != 0) return;
  limit.rlim_max = std::min(limit.rlim_max, hard);
  limit.rlim_cur = std::min(limit.rlim_max, soft);
  ::setrlimit(resource, &limit);
}

void shut_in(const Budget& budget) {
  lower(RLIMIT_CORE, 0, 0);
  lower(RLIMIT_FSIZE, 0, 0);
  const auto cpu_s = static_cast<rlim_t>(budget.cpu_s);
  lower(RLIMIT_CPU, cpu_s, cpu_s + 1);
  if constexpr (kHasShadowMemory) return;
  const uint64_t mapped = memory_of(::getpid(), Memory::kMapped);
  if (mapped > 0) lower(RLIMIT_AS, mapped + budget.memory_bytes, mapped + budget.memory_bytes);
}

/// A sanitizer that finds fault with the library says so to nobody, a fuzzer keeps no input for it:
/// the parent hears of a crash.
void hush_sanitizers() {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || defined(__clang__)
  if (__sanitizer_set_report_path) __sanitizer_set_report_path("stderr");
  if (__sanitizer_set_death_callback) __sanitizer_set_death_callback(nullptr);
#endif
}

void send(int pipe, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(pipe, bytes.data(), bytes.size());
    if (count < 0 && errno != EINTR) ::_exit(1);
    if (count > 0) bytes = bytes.subspan(static_cast<size_t>(count));
  }
}

void send(int pipe, Answer::Kind kind, std::string_view expected, std::string_view found) {
  expected = expected.substr(0, kMostTextBytes);
  found = found.substr(0, kMostTextBytes);
  const Answer head{
      .kind = kind, .expected_size = expected.size(), .size = expected.size() + found.size()};
  send(pipe, std::as_bytes(std::span(&head, 1)));
  send(pipe, std::as_bytes(std::span(expected)));
  send(pipe, std::as_bytes(std::span(found)));
}

void send(int pipe, Answer::Kind kind, std::span<const uint8_t> bytes) {
  const Answer head{.kind = kind, .size = bytes.size()};
  send(pipe, std::as_bytes(std::span(&head, 1)));
  send(pipe, std::as_bytes(bytes));
}

}  // namespace

uint64_t memory_of(pid_t process, Memory kind) {
  char path[32];
  std::snprintf(path, sizeof path, "/proc/%d/statm", static_cast<int>(process));
  const int file = ::open(path, O_RDONLY | O_CLOEXEC);
  if (file < 0) return 0;
  char text[128] = {};
  const ssize_t length = ::read(file, text, sizeof text - 1);
  ::close(file);
  unsigned long long mapped = 0;
  unsigned long long resident = 0;
  if (length <= 0 || std::sscanf(text, "%llu %llu", &mapped, &resident) != 2) return 0;
  const auto page_bytes = static_cast<uint64_t>(::sysconf(_SC_PAGESIZE));
  return (kind == Memory::kMapped ? mapped : resident) * page_bytes;
}

void answer(const RegularFile& file, int pipe, pid_t parent, const Budget& budget,
            const Parse& parse) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(1);  // it died before it could take us along
  reset_signals();
  keep_only(file.descriptor(), pipe);
  hush_sanitizers();
  shut_in(budget);
  // Registered last and so called first: what the parent left to be done at its end is not ours,
  // not even if the library ends the process.
  std::atexit([] { ::_exit(1); });
  try {
    const SendPiece send_piece = [&](std::span<const uint8_t> piece) {
      while (!piece.empty()) {
        const size_t size = std::min(piece.size(), kMostPieceBytes);
        send(pipe, Answer::Kind::kPiece, piece.first(size));
        piece = piece.subspan(size);
      }
    };
    send(pipe, Answer::Kind::kBytes, parse(file, send_piece));
  } catch (const Refusal& refusal) {
    send(pipe, Answer::Kind::kRefused, refusal.expected, refusal.found);
  } catch (const std::bad_alloc&) {
    send(pipe, Answer::Kind::kOutOfMemory, {}, {});
  } catch (const std::exception& error) {
    send(pipe, Answer::Kind::kThrew, {}, error.what());
  } catch (...) {
    send(pipe, Answer::Kind::kThrew, {}, "something that is no std::exception");
  }
  ::_exit(0);
}

}  // namespace throng::foreign
