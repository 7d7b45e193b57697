#include "base/files/sandboxed_parser.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <new>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "base/errors.h"

namespace throng {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || defined(__clang__)
// From <sanitizer/common_interface_defs.h>; null without a sanitizer.
// NOLINTNEXTLINE(bugprone-reserved-identifier,readability-identifier-naming): foreign name
extern "C" __attribute__((weak)) void __sanitizer_set_report_path(const char* path);
// NOLINTNEXTLINE(bugprone-reserved-identifier,readability-identifier-naming): foreign name
extern "C" __attribute__((weak)) void __sanitizer_set_death_callback(void (*callback)());
#endif

namespace {

using sandbox::ReplyHeader;

/// These sanitizers map terabytes of shadow memory, which limits of the operating system cannot
/// distinguish from the parser's own.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kHasShadowMemory = true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
constexpr bool kHasShadowMemory = true;
#else
constexpr bool kHasShadowMemory = false;
#endif
#else
constexpr bool kHasShadowMemory = false;
#endif

/// Longer texts are cut: an error is one line.
constexpr uint64_t kMaxTextBytes = 1000;

struct Budget {
  int cpu_s = 0;
  double wall_s = 0;
  uint64_t memory_bytes = 0;
  uint64_t result_bytes = 0;
};

/// Its return value is sent as the last reply.
using Parse = std::function<std::vector<uint8_t>(const RegularFile&, const SendPiece&)>;

// The child's side: it isolates itself, parses and replies. It touches nothing of the parent and
// leaves only by _exit.

/// Bytes that a process has mapped or resident; 0 without /proc.
enum class Memory { kMapped, kResident };
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

/// The child ignores signals that stop a program, which the parent handles. All others get their
/// default action.
void reset_signals() {
  for (int number = 1; number < NSIG; ++number) {
    const bool is_for_parent =
        number == SIGINT || number == SIGQUIT || number == SIGHUP || number == SIGTERM;
    // With SIGXFSZ ignored, writing to a file is an error instead of a crash.
    ::signal(number, is_for_parent || number == SIGXFSZ ? SIG_IGN : SIG_DFL);
  }
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
}

void close_between(int first, int last) {
  if (first <= last) ::close_range(static_cast<unsigned>(first), static_cast<unsigned>(last), 0);
}

/// Closes all descriptors but two: the parser must not write to the parent's files or sockets.
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

void enter_sandbox(const Budget& budget) {
  lower(RLIMIT_CORE, 0, 0);
  lower(RLIMIT_FSIZE, 0, 0);
  const auto cpu_s = static_cast<rlim_t>(budget.cpu_s);
  lower(RLIMIT_CPU, cpu_s, cpu_s + 1);
  if constexpr (kHasShadowMemory) return;
  const uint64_t mapped = memory_of(::getpid(), Memory::kMapped);
  if (mapped > 0) lower(RLIMIT_AS, mapped + budget.memory_bytes, mapped + budget.memory_bytes);
}

/// Sanitizers print no report and fuzzers save no input in the child: the parent reports the crash.
void silence_sanitizers() {
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

void send(int pipe, ReplyHeader::Kind kind, std::string_view expected, std::string_view found) {
  expected = expected.substr(0, kMaxTextBytes);
  found = found.substr(0, kMaxTextBytes);
  const ReplyHeader head{
      .kind = kind, .expected_size = expected.size(), .size = expected.size() + found.size()};
  send(pipe, std::as_bytes(std::span(&head, 1)));
  send(pipe, std::as_bytes(std::span(expected)));
  send(pipe, std::as_bytes(std::span(found)));
}

void send(int pipe, ReplyHeader::Kind kind, std::span<const uint8_t> bytes) {
  const ReplyHeader head{.kind = kind, .size = bytes.size()};
  send(pipe, std::as_bytes(std::span(&head, 1)));
  send(pipe, std::as_bytes(bytes));
}

[[noreturn]] void send_reply(const RegularFile& file, int pipe, pid_t parent, const Budget& budget,
                             const Parse& parse) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(1);  // the parent died before PDEATHSIG was set
  reset_signals();
  keep_only(file.descriptor(), pipe);
  silence_sanitizers();
  enter_sandbox(budget);
  // Registered last, so called first: handlers of the parent must not run, even if the library
  // exits.
  std::atexit([] { ::_exit(1); });
  try {
    const SendPiece send_piece = [&](std::span<const uint8_t> piece) {
      while (!piece.empty()) {
        const size_t size = std::min(piece.size(), kMaxPieceBytes);
        send(pipe, ReplyHeader::Kind::kPiece, piece.first(size));
        piece = piece.subspan(size);
      }
    };
    send(pipe, ReplyHeader::Kind::kBytes, parse(file, send_piece));
  } catch (const ParseFailure& rejection) {
    send(pipe, ReplyHeader::Kind::kRejected, rejection.expected, rejection.found);
  } catch (const std::bad_alloc&) {
    send(pipe, ReplyHeader::Kind::kOutOfMemory, {}, {});
  } catch (const std::exception& error) {
    send(pipe, ReplyHeader::Kind::kThrew, {}, error.what());
  } catch (...) {
    send(pipe, ReplyHeader::Kind::kThrew, {}, "something that is no std::exception");
  }
  ::_exit(0);
}

// The parent's side: it waits and validates.

using Clock = std::chrono::steady_clock;

constexpr double kCpuSecondsPerMiB = 0.5;
constexpr double kWallSecondsPerMiB = 1;

Budget budget_for(uint64_t file_bytes, const SandboxLimits& limits) {
  const double mib = static_cast<double>(file_bytes >> 20);
  return {.cpu_s = limits.cpu_s + static_cast<int>(kCpuSecondsPerMiB * mib),
          .wall_s = limits.wall_s + kWallSecondsPerMiB * mib,
          .memory_bytes = limits.max_memory_bytes + limits.memory_per_file_byte * file_bytes,
          .result_bytes = limits.max_result_bytes};
}

[[noreturn]] void fail(const std::filesystem::path& file, const char* what) {
  throw EnvironmentError(fmt::format("{}: cannot start the process that reads it: {}: {}",
                                     file.string(), what, std::strerror(errno)));
}

/// Reserves at most this much for an announced size; beyond, memory grows with received data.
constexpr uint64_t kMaxReserved = 64 << 20;

/// A pipe whose ends are above 2, because the child opens 0 to 2 on /dev/null.
class Pipe {
 public:
  explicit Pipe(const std::filesystem::path& file) {
    int low[2];
    if (::pipe2(low, O_CLOEXEC) != 0) fail(file, "pipe");
    for (int i = 0; i < 2; ++i) ends_[i] = ::fcntl(low[i], F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    const int error = errno;
    for (const int end : low) ::close(end);
    errno = error;
    if (ends_[0] < 0 || ends_[1] < 0) {
      close();
      fail(file, "pipe");
    }
    // Fewer turns for large meshes; failing is harmless.
    ::fcntl(ends_[1], F_SETPIPE_SZ, 1 << 20);
  }
  ~Pipe() { close(); }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  int read_end() const { return ends_[0]; }
  int write_end() const { return ends_[1]; }
  void close_write_end() { close(ends_[1]); }

 private:
  static void close(int& end) {
    if (end >= 0) ::close(std::exchange(end, -1));
  }
  void close() {
    for (int& end : ends_) close(end);
  }

  int ends_[2] = {-1, -1};
};

/// Kills and reaps the child at the latest when destroyed.
class Child {
 public:
  explicit Child(pid_t id) : id_(id), ended_(static_cast<int>(::syscall(SYS_pidfd_open, id, 0))) {}
  ~Child() {
    end();
    if (ended_ >= 0) ::close(ended_);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  pid_t id() const { return id_; }
  /// Descriptor that is readable once the child has ended; negative on kernels before 5.3.
  int ended() const { return ended_; }
  /// Ends the child and returns its wait status; 0 if the process reaps all children (SIGCHLD
  /// ignored).
  int end() {
    if (id_ < 0) return status_;
    ::kill(id_, SIGKILL);  // no effect on an ended child
    while (::waitpid(id_, &status_, 0) < 0 && errno == EINTR) continue;
    id_ = -1;
    return status_;
  }

 private:
  pid_t id_;
  int ended_;
  int status_ = 0;
};

enum class Outcome { kReplied, kEnded, kTooSlow, kTooMuchMemory, kTooMuchResult };

/// Receives the child's reply until it is complete, the child has ended or exceeds a limit.
class Listener {
 public:
  using Take = std::function<void(std::span<const uint8_t>)>;

  /// `take` receives pieces; null if pieces are not allowed.
  Listener(const Pipe& pipe, const Child& child, const Budget& budget, const Take* take)
      : pipe_(pipe),
        child_(child),
        budget_(budget),
        take_(take),
        resident_(resident_of(::getpid())) {
    ::fcntl(pipe.read_end(), F_SETFL, O_NONBLOCK);
  }

  Outcome listen() {
    deadline_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                   std::chrono::duration<double>(budget_.wall_s));
    while (true) {
      const auto left =
          std::chrono::ceil<std::chrono::milliseconds>(deadline_ - Clock::now()).count();
      if (left <= 0) return Outcome::kTooSlow;
      pollfd watched[2] = {{pipe_.read_end(), POLLIN, 0}, {child_.ended(), POLLIN, 0}};
      // At most a minute: keeps the milliseconds within int.
      const auto wait_ms = std::min<int64_t>(left, kHasShadowMemory ? 10 : 60'000);
      if (::poll(watched, 2, static_cast<int>(wait_ms)) < 0 && errno != EINTR)
        return Outcome::kEnded;
      if (is_too_large()) return Outcome::kTooMuchMemory;
      // An ended child sends nothing more: read the pipe once more, then stop.
      const bool has_ended = (watched[1].revents & POLLIN) != 0;
      if (const std::optional<Outcome> outcome = receive()) return *outcome;
      if (has_ended) return Outcome::kEnded;
    }
  }

  /// Header of a complete reply.
  ReplyHeader head() const {
    ReplyHeader out;
    std::memcpy(&out, received_.data(), sizeof out);
    return out;
  }
  std::span<const uint8_t> body() const {
    return std::span(received_).subspan(sizeof(ReplyHeader));
  }
  std::vector<uint8_t> take_body() {
    received_.erase(received_.begin(), received_.begin() + sizeof(ReplyHeader));
    return std::move(received_);
  }

 private:
  static uint64_t resident_of(pid_t process) {
    return kHasShadowMemory ? memory_of(process, Memory::kResident) : 0;
  }
  bool is_too_large() const {
    return kHasShadowMemory && resident_of(child_.id()) > resident_ + budget_.memory_bytes;
  }

  std::optional<Outcome> receive() {
    while (true) {
      const size_t before = received_.size();
      // Grows with received data, not with the announced size.
      received_.resize(before + std::clamp<size_t>(before, 4096, 1 << 20));
      const ssize_t count =
          ::read(pipe_.read_end(), received_.data() + before, received_.size() - before);
      const int error = errno;
      received_.resize(before + static_cast<size_t>(std::max<ssize_t>(count, 0)));
      if (count < 0 && error == EINTR) continue;
      if (count < 0 && error == EAGAIN) return std::nullopt;
      if (count <= 0) return Outcome::kEnded;
      if (const std::optional<Outcome> outcome = take_pieces()) return outcome;
      if (received_.size() < sizeof(ReplyHeader)) continue;
      const ReplyHeader head = this->head();
      if (head.kind == ReplyHeader::Kind::kPiece) continue;  // incomplete
      const uint64_t max_size = head.kind == ReplyHeader::Kind::kBytes
                                    ? budget_.result_bytes - taken_bytes_
                                    : 2 * kMaxTextBytes;
      if (head.size > max_size) return Outcome::kTooMuchResult;
      received_.reserve(sizeof(ReplyHeader) +
                        static_cast<size_t>(std::min(head.size, kMaxReserved)));
      if (received_.size() - sizeof(ReplyHeader) >= head.size) {
        received_.resize(sizeof(ReplyHeader) + static_cast<size_t>(head.size));
        return Outcome::kReplied;
      }
    }
  }

  /// Passes on complete pieces. Afterwards received_ begins with the header of another reply, or
  /// part of one.
  std::optional<Outcome> take_pieces() {
    size_t at = 0;
    while (received_.size() - at >= sizeof(ReplyHeader)) {
      ReplyHeader head;
      std::memcpy(&head, received_.data() + at, sizeof head);
      if (head.magic != ReplyHeader::kMagic) return Outcome::kEnded;
      if (head.kind != ReplyHeader::Kind::kPiece) break;
      if (take_ == nullptr || head.size > kMaxPieceBytes) return Outcome::kEnded;
      if (head.size > budget_.result_bytes - taken_bytes_) return Outcome::kTooMuchResult;
      if (received_.size() - at - sizeof head < head.size) break;
      const Clock::time_point before = Clock::now();
      (*take_)(std::span(received_).subspan(at + sizeof head, static_cast<size_t>(head.size)));
      deadline_ += Clock::now() - before;
      taken_bytes_ += head.size;
      at += sizeof head + static_cast<size_t>(head.size);
    }
    received_.erase(received_.begin(), received_.begin() + static_cast<ptrdiff_t>(at));
    return std::nullopt;
  }

  const Pipe& pipe_;
  const Child& child_;
  const Budget budget_;
  const Take* take_;
  const uint64_t resident_;
  Clock::time_point deadline_;
  uint64_t taken_bytes_ = 0;
  std::vector<uint8_t> received_;
};

std::string signal_name(int number) {
  const char* name = ::sigabbrev_np(number);
  return name != nullptr ? fmt::format("SIG{}", name) : fmt::format("signal {}", number);
}

/// "one that crashes assimp (SIGSEGV)".
std::string describe_failure(Outcome outcome, int status, const std::string& library,
                             const Budget& budget) {
  // SIGKILL came from Child::end(), for a child that closed its pipe without ending.
  const bool was_killed =
      outcome == Outcome::kEnded && WIFSIGNALED(status) && WTERMSIG(status) != SIGKILL;
  if (outcome == Outcome::kTooSlow)
    return fmt::format("one that keeps {} busy for more than {:g} s", library, budget.wall_s);
  if (was_killed && WTERMSIG(status) == SIGXCPU)
    return fmt::format("one that keeps {} busy for more than {} s of processor time", library,
                       budget.cpu_s);
  if (outcome == Outcome::kTooMuchMemory)
    return fmt::format("one for which {} needs more than {} MiB of memory", library,
                       budget.memory_bytes >> 20);
  if (outcome == Outcome::kTooMuchResult)
    return fmt::format("one from which {} makes more than {} MiB", library,
                       budget.result_bytes >> 20);
  if (was_killed)
    return fmt::format("one that crashes {} ({})", library, signal_name(WTERMSIG(status)));
  return fmt::format("one on which {} ends the process that reads it", library);
}

std::vector<uint8_t> run_sandboxed(const RegularFile& file, const SandboxedParser& parser,
                                   const SandboxLimits& limits, const Parse& parse,
                                   const Listener::Take* take) {
  const std::filesystem::path& path = file.path();
  const Budget budget = budget_for(file.size(), limits);
  Pipe pipe(path);
  const pid_t parent = ::getpid();
  const pid_t id = ::fork();
  if (id < 0) fail(path, "fork");
  if (id == 0) send_reply(file, pipe.write_end(), parent, budget, parse);
  Child child(id);
  pipe.close_write_end();
  Listener listener(pipe, child, budget, take);
  const Outcome outcome = listener.listen();
  const int status = child.end();
  const auto rejection = [&](const std::string& found) {
    return InputError(path.string(), parser.expected, found);
  };
  if (outcome == Outcome::kReplied) {
    const ReplyHeader head = listener.head();
    if (head.kind == ReplyHeader::Kind::kBytes) return listener.take_body();
    const std::string text(listener.body().begin(), listener.body().end());
    const auto cut = static_cast<size_t>(std::min<uint64_t>(head.expected_size, text.size()));
    if (head.kind == ReplyHeader::Kind::kRejected)
      throw InputError(path.string(), text.substr(0, cut), text.substr(cut));
    if (head.kind == ReplyHeader::Kind::kThrew)
      throw rejection(fmt::format("one that {} rejects: {}", parser.library, text));
  }
  const bool is_too_large =
      outcome == Outcome::kReplied && listener.head().kind == ReplyHeader::Kind::kOutOfMemory;
  throw rejection(fmt::format("{}; {}",
                              describe_failure(is_too_large ? Outcome::kTooMuchMemory : outcome,
                                               status, parser.library, budget),
                              parser.remedy));
}

}  // namespace

std::vector<uint8_t> parse_sandboxed(
    const std::filesystem::path& path, const SandboxedParser& parser, const SandboxLimits& limits,
    const std::function<std::vector<uint8_t>(const RegularFile&)>& parse) {
  const RegularFile file(path, parser.expected, limits.max_file_bytes);
  return run_sandboxed(
      file, parser, limits,
      [&](const RegularFile& opened, const SendPiece&) { return parse(opened); }, nullptr);
}

void parse_sandboxed_in_pieces(
    const RegularFile& file, const SandboxedParser& parser, const SandboxLimits& limits,
    const std::function<void(const RegularFile&, const SendPiece&)>& parse,
    const std::function<void(std::span<const uint8_t>)>& take) {
  if (file.size() > limits.max_file_bytes)
    throw InputError(
        file.path().string(),
        fmt::format("{} of at most {} MiB", parser.expected, limits.max_file_bytes >> 20),
        fmt::format("{} MiB", file.size() >> 20));
  run_sandboxed(
      file, parser, limits,
      [&](const RegularFile& opened, const SendPiece& send) {
        parse(opened, send);
        return std::vector<uint8_t>();
      },
      &take);
}

}  // namespace throng
