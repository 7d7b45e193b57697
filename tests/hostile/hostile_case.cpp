#include "tests/hostile/hostile_case.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string_view>

#include "base/errors.h"

namespace throng::hostile {
namespace {

constexpr time_t kSeconds = time_t{10} * THRONG_SLOWNESS;
constexpr unsigned kWallSeconds = 100 * THRONG_SLOWNESS;
constexpr int kUsed = 0;
constexpr int kRejected = 2;
constexpr int kOtherError = 9;
/// Three times the need of the largest scene of a few people.
constexpr rlim_t kMemory = rlim_t{4} << 30;

/// Runs in the child and ends it.
[[noreturn]] void use_and_exit(const std::function<void()>& use) {
  // Processor time limits work, since wall time depends on the load; wall time limits waits.
  const itimerval own{{0, 0}, {kSeconds, 0}};
  ::setitimer(ITIMER_PROF, &own, nullptr);
  ::alarm(kWallSeconds);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  const rlimit memory{kMemory, kMemory};
  ::setrlimit(RLIMIT_AS, &memory);
#endif
  const rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
  int code = kUsed;
  try {
    use();
  } catch (const InputError& error) {
    const std::string_view words = error.what();
    const bool is_a_line = words.find("expected") != words.npos && words.find('\n') == words.npos;
    if (!is_a_line) std::fprintf(stderr, "expected one line with 'expected': %s\n", error.what());
    code = is_a_line ? kRejected : kOtherError;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "another kind of error: %s\n", error.what());
    code = kOtherError;
  }
  ::_exit(code);
}

}  // namespace

Scratch::Scratch() {
  const std::filesystem::path shared = "/dev/shm";
  const std::filesystem::path above =
      std::filesystem::is_directory(shared) ? shared : std::filesystem::temp_directory_path();
  folder_ = above / ("throng_hostile_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder_);
}

Scratch::~Scratch() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

std::filesystem::path Scratch::write(const std::string& name, const std::string& text) const {
  std::filesystem::path file = folder_ / name;
  std::ofstream(file, std::ios::binary) << text;
  return file;
}

void try_case(const std::string& input, const std::string& kept, const std::function<void()>& use,
              Tally& tally) {
  ++tally.tried;
  std::fflush(nullptr);
  const pid_t child = ::fork();
  if (child < 0) {
    std::perror("fork");
    std::exit(3);
  }
  if (child == 0) use_and_exit(use);
  int status = 0;
  ::waitpid(child, &status, 0);
  if (WIFEXITED(status) && WEXITSTATUS(status) == kUsed) {
    ++tally.ran;
    return;
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == kRejected) {
    ++tally.rejected;
    return;
  }
  const bool hung =
      WIFSIGNALED(status) && (WTERMSIG(status) == SIGALRM || WTERMSIG(status) == SIGPROF);
  ++(hung ? tally.hung : tally.crashed);
  std::ofstream(kept, std::ios::binary) << input;
  std::fprintf(stderr, "%s: %s (status %d)\n", kept.c_str(), hung ? "hung" : "crashed", status);
}

int report(const std::string& what, const Tally& tally) {
  std::printf("[ inputs ] %s: %lld tried, %lld rejected, %lld ran, %lld crashed, %lld hung\n",
              what.c_str(), static_cast<long long>(tally.tried),
              static_cast<long long>(tally.rejected), static_cast<long long>(tally.ran),
              static_cast<long long>(tally.crashed), static_cast<long long>(tally.hung));
  return tally.crashed + tally.hung == 0 && tally.ran > 0 && tally.rejected > 0 ? 0 : 1;
}

Arguments read_arguments(int argc, char** argv, int64_t count) {
  Arguments out{count, 1};
  if (argc > 1) out.count = std::strtoll(argv[1], nullptr, 10);
  if (argc > 2) out.seed = std::strtoull(argv[2], nullptr, 10);
  if (argc > 3 || out.count < 1) {
    std::fprintf(stderr, "usage: %s [COUNT [SEED]]\n", argv[0]);
    std::exit(2);
  }
  std::printf("seed %llu\n", static_cast<unsigned long long>(out.seed));
  return out;
}

}  // namespace throng::hostile
