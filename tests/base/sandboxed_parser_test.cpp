// The caller of a sandboxed parser gets its bytes or a one-line error in bounded time, even if the
// parser hangs or crashes. Nothing of the child remains.
#include "base/files/sandboxed_parser.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <thread>

#include "base/errors.h"

namespace throng::sandboxed_parser_test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;
using Bytes = std::vector<uint8_t>;

const SandboxedParser kParser = {
    .library = "libfoo", .expected = "a foo", .remedy = "make another"};

size_t open_descriptors() {
  return static_cast<size_t>(
      std::distance(fs::directory_iterator("/proc/self/fd"), fs::directory_iterator()));
}

class SandboxedParserTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / fmt::format("throng_apart_{}", ::getpid());
    fs::create_directories(folder_);
    write("a.foo", "some bytes");
    descriptors_ = open_descriptors();
  }
  void TearDown() override {
    EXPECT_EQ(open_descriptors(), descriptors_) << "a descriptor leaked";
    EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1) << "a child was not reaped";
    EXPECT_EQ(errno, ECHILD);
    fs::remove_all(folder_);
  }
  fs::path file(const std::string& name = "a.foo") const { return folder_ / name; }
  fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(file(name), std::ios::binary) << text;
    return file(name);
  }
  template <typename Parse>
  std::string complaint(const Parse& parse, const SandboxLimits& limits = {},
                        const std::string& name = "a.foo") const {
    try {
      parse_sandboxed(file(name), kParser, limits, parse);
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), StartsWith(file(name).string() + ": expected "));
      EXPECT_THAT(error.what(), Not(HasSubstr("\n")));
      return error.what();
    }
    return "accepted";
  }

 private:
  fs::path folder_;
  size_t descriptors_ = 0;
};

/// Volatile: the compiler may remove a loop that it knows to be endless.
volatile bool for_ever = true;

Bytes as_it_is(const RegularFile& file) { return file.bytes(); }

TEST_F(SandboxedParserTest, ReturnsTheBytes) {
  EXPECT_EQ(parse_sandboxed(file(), kParser, {}, as_it_is),
            Bytes({'s', 'o', 'm', 'e', ' ', 'b', 'y', 't', 'e', 's'}));
  EXPECT_EQ(parse_sandboxed(file(), kParser, {}, [](const RegularFile&) { return Bytes(); }),
            Bytes());
  Bytes large(20'000'003);
  std::iota(large.begin(), large.end(), uint8_t{0});
  EXPECT_EQ(parse_sandboxed(file(), kParser, {}, [&](const RegularFile&) { return large; }), large);
}

TEST_F(SandboxedParserTest, PassesPiecesInOrder) {
  const RegularFile foo(file(), "a foo", 1 << 20);
  Bytes made(5'000'003);
  std::iota(made.begin(), made.end(), uint8_t{0});
  Bytes taken;
  const auto take = [&](std::span<const uint8_t> piece) {
    EXPECT_LE(piece.size(), kMaxPieceBytes);
    taken.insert(taken.end(), piece.begin(), piece.end());
  };
  parse_sandboxed_in_pieces(
      foo, kParser, {},
      [&](const RegularFile&, const SendPiece& send) {
        const std::span<const uint8_t> all(made);
        for (size_t at = 0, size = 1; at < all.size(); at += size, size = size * 3 + 1)
          send(all.subspan(at, std::min(size, all.size() - at)));
      },
      take);
  EXPECT_EQ(taken, made);
}

TEST_F(SandboxedParserTest, ReportsErrorsAfterSomePieces) {
  const RegularFile foo(file(), "a foo", 1 << 20);
  size_t taken = 0;
  const auto count = [&](std::span<const uint8_t> piece) { taken += piece.size(); };
  const auto complaint_of = [&](const SandboxLimits& limits, const auto& parse, const auto& take) {
    try {
      parse_sandboxed_in_pieces(foo, kParser, limits, parse, take);
      return std::string("accepted");
    } catch (const InputError& error) {
      return std::string(error.what());
    }
  };
  const Bytes piece(100'000);
  EXPECT_THAT(complaint_of(
                  {},
                  [&](const RegularFile&, const SendPiece& send) {
                    send(piece);
                    throw ParseFailure("two feet", "three");
                  },
                  count),
              EndsWith("expected two feet, found three"));
  EXPECT_EQ(taken, piece.size());
  EXPECT_THAT(complaint_of(
                  {},
                  [&](const RegularFile&, const SendPiece& send) {
                    send(piece);
                    std::abort();
                  },
                  count),
              HasSubstr("crashes libfoo (SIGABRT)"));
  const auto without_end = [&](const RegularFile&, const SendPiece& send) {
    while (for_ever) send(piece);
  };
  EXPECT_THAT(complaint_of({.max_result_bytes = 10 << 20}, without_end, count),
              HasSubstr("makes more than 10 MiB"));
  EXPECT_THAT(complaint_of({}, without_end,
                           [](std::span<const uint8_t>) {
                             throw InputError("a.foo:7", "a number", "none");
                           }),
              EndsWith("a.foo:7: expected a number, found none"));
}

TEST_F(SandboxedParserTest, DoesNotCountTheTimeToTakePieces) {
  const RegularFile foo(file(), "a foo", 1 << 20);
  int taken = 0;
  parse_sandboxed_in_pieces(
      foo, kParser, {.wall_s = 0.3},
      [](const RegularFile&, const SendPiece& send) {
        for (int i = 0; i < 8; ++i) send(Bytes(10));
      },
      [&](std::span<const uint8_t>) {
        std::this_thread::sleep_for(std::chrono::milliseconds(60));
        ++taken;
      });
  EXPECT_EQ(taken, 8);
}

TEST_F(SandboxedParserTest, QuotesExceptions) {
  EXPECT_THAT(
      complaint([](const RegularFile&) -> Bytes { throw ParseFailure("two\nfeet", "three"); }),
      EndsWith("a.foo: expected two feet, found three"));
  EXPECT_THAT(
      complaint([](const RegularFile&) -> Bytes { throw std::runtime_error("no\x1b foo"); }),
      EndsWith("a.foo: expected a foo, found one that libfoo rejects: no  foo"));
  EXPECT_THAT(complaint([](const RegularFile&) -> Bytes { throw 7; }),
              HasSubstr("something that is no std::exception"));
  EXPECT_LT(complaint([](const RegularFile&) -> Bytes {
              throw ParseFailure(std::string(1 << 20, 'x'), std::string(1 << 20, 'y'));
            }).size(),
            3000u);
}

TEST_F(SandboxedParserTest, ReportsACrashAsAnErrorOfTheFile) {
  const auto dies_of = [](int number) {
    return [number](const RegularFile&) -> Bytes {
      ::raise(number);
      return {};
    };
  };
  EXPECT_THAT(complaint(dies_of(SIGSEGV)),
              EndsWith("expected a foo, found one that crashes libfoo (SIGSEGV); make another"));
  EXPECT_THAT(complaint(dies_of(SIGFPE)), HasSubstr("(SIGFPE)"));
  EXPECT_THAT(complaint([](const RegularFile&) -> Bytes { std::abort(); }), HasSubstr("(SIGABRT)"));
  EXPECT_THAT(complaint([](const RegularFile&) -> Bytes { std::terminate(); }),
              HasSubstr("(SIGABRT)"));
}

TEST_F(SandboxedParserTest, LeavesStopSignalsToTheParent) {
  EXPECT_EQ(parse_sandboxed(file(), kParser, {},
                            [](const RegularFile& foo) {
                              for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGQUIT})
                                ::raise(number);
                              return foo.bytes();
                            })
                .size(),
            10u);
}

TEST_F(SandboxedParserTest, KeepsWaitingWhenTheParentGetsASignal) {
  struct sigaction quiet = {}, before = {};
  quiet.sa_handler = [](int) {};
  ::sigaction(SIGUSR1, &quiet, &before);
  const pthread_t waiting = ::pthread_self();
  std::jthread caller([waiting] {
    for (int i = 0; i < 20; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      ::pthread_kill(waiting, SIGUSR1);
    }
  });
  EXPECT_EQ(parse_sandboxed(file(), kParser, {},
                            [](const RegularFile& foo) {
                              ::usleep(150'000);
                              return foo.bytes();
                            })
                .size(),
            10u);
  caller.join();
  ::sigaction(SIGUSR1, &before, nullptr);
}

TEST_F(SandboxedParserTest, SurvivesALibraryThatExits) {
  // The parent's buffered output is written once.
  const fs::path output = file("output.txt");
  FILE* out = std::fopen(output.c_str(), "w");
  std::fputs("once", out);
  static bool is_parent = true;
  static fs::path touched = file("touched");
  std::atexit([] {
    if (!is_parent) std::ofstream(touched) << "a handler of the parent ran in the child";
  });
  EXPECT_THAT(complaint([](const RegularFile&) -> Bytes {
                is_parent = false;
                std::exit(0);
              }),
              HasSubstr("one on which libfoo ends the process that reads it"));
  std::fclose(out);
  EXPECT_EQ(fs::file_size(output), 4u);
  EXPECT_FALSE(fs::exists(touched));
}

TEST_F(SandboxedParserTest, StopsAnEndlessParser) {
  const SandboxLimits quick = {.cpu_s = 1, .wall_s = 0.2};
  EXPECT_THAT(complaint(
                  [](const RegularFile&) -> Bytes {
                    while (for_ever) ::pause();
                    return {};
                  },
                  quick),
              EndsWith("one that keeps libfoo busy for more than 0.2 s; make another"));
  const SandboxLimits busy = {.cpu_s = 1, .wall_s = 100};
  EXPECT_THAT(complaint(
                  [](const RegularFile&) -> Bytes {
                    while (for_ever) continue;
                    return {};
                  },
                  busy),
              HasSubstr("one that keeps libfoo busy for more than 1 s of processor time"));
}

TEST_F(SandboxedParserTest, LimitsMemory) {
  const auto hoard = [](const RegularFile&) -> Bytes {
    std::vector<Bytes> all;
    while (for_ever) all.emplace_back(16 << 20, uint8_t{1});
    return {};
  };
  EXPECT_THAT(complaint(hoard, {.max_memory_bytes = 256 << 20}),
              HasSubstr("one for which libfoo needs more than 256 MiB of memory; make another"));
}

TEST_F(SandboxedParserTest, LimitsTheResult) {
  const SandboxLimits small = {.max_result_bytes = 1 << 20};
  const auto makes = [](size_t bytes) {
    return [bytes](const RegularFile&) { return Bytes(bytes); };
  };
  EXPECT_EQ(complaint(makes(1 << 20), small), "accepted");
  EXPECT_THAT(complaint(makes((1 << 20) + 1), small),
              HasSubstr("one from which libfoo makes more than 1 MiB; make another"));
}

/// The only descriptor of the child that is a pipe.
int pipe_of_child() {
  for (int number = 3; number < 1000; ++number) {
    struct stat status = {};
    if (::fstat(number, &status) == 0 && S_ISFIFO(status.st_mode)) return number;
  }
  return -1;
}

TEST_F(SandboxedParserTest, RejectsInvalidReplies) {
  const auto replying = [](const Bytes& what) {
    return [what](const RegularFile&) -> Bytes {
      if (::write(pipe_of_child(), what.data(), what.size()) < 0) ::_exit(3);
      ::_exit(0);
    };
  };
  EXPECT_THAT(complaint(replying({})), HasSubstr("ends the process"));
  EXPECT_THAT(complaint(replying({1, 2, 3})), HasSubstr("ends the process"));
  EXPECT_THAT(complaint(replying(Bytes(1000, 0xff))), HasSubstr("ends the process"));
  const auto head = [](sandbox::ReplyHeader answer) {
    const auto* at = reinterpret_cast<const uint8_t*>(&answer);
    return Bytes(at, at + sizeof answer);
  };
  EXPECT_THAT(complaint(replying(head({.size = 10}))), HasSubstr("ends the process"))
      << "half of it";
  EXPECT_THAT(complaint(replying(head({.size = ~0ull}))), HasSubstr("makes more than"));
  EXPECT_THAT(complaint(replying(head({.kind = sandbox::ReplyHeader::Kind{77}}))),
              HasSubstr("ends the"));
  EXPECT_THAT(complaint(replying(
                  head({.kind = sandbox::ReplyHeader::Kind::kRejected, .expected_size = ~0ull}))),
              HasSubstr("a.foo: expected , found "));
}

TEST_F(SandboxedParserTest, IsolatesTheChildFromTheParent) {
  const int mine = ::open(file().c_str(), O_RDONLY);
  const auto look = [&](const RegularFile& foo) {
    Bytes out;
    for (int number = 0; number < 100; ++number)
      if (::fcntl(number, F_GETFD) >= 0) out.push_back(static_cast<uint8_t>(number));
    out.push_back(::fcntl(foo.descriptor(), F_GETFD) >= 0);
    struct stat status = {}, null = {};
    ::stat("/dev/null", &null);
    for (int number = 0; number < 3; ++number)
      out.push_back(::fstat(number, &status) == 0 && status.st_rdev == null.st_rdev);
    rlimit core = {};
    ::getrlimit(RLIMIT_CORE, &core);
    out.push_back(core.rlim_max == 0);
    FILE* written = std::fopen((foo.path().string() + ".new").c_str(), "w");
    out.push_back(written == nullptr || std::fputs("x", written) < 0 || std::fclose(written) != 0);
    return out;
  };
  const Bytes seen = parse_sandboxed(file(), kParser, {}, look);
  ::close(mine);
  ASSERT_EQ(seen.size(), 11u) << "0, 1, 2, the file and the pipe are open";
  EXPECT_EQ(Bytes(seen.begin(), seen.begin() + 3), Bytes({0, 1, 2}));
  EXPECT_EQ(Bytes(seen.begin() + 5, seen.end()), Bytes(6, 1))
      << "its file | stdin, stdout, stderr are /dev/null | no core | no file can be written";
}

TEST_F(SandboxedParserTest, WorksWithoutStandardStreams) {
  int saved[3];
  for (int i = 0; i < 3; ++i) saved[i] = ::fcntl(i, F_DUPFD_CLOEXEC, 10);
  for (int i = 0; i < 3; ++i) ::close(i);
  const Bytes read = parse_sandboxed(file(), kParser, {}, as_it_is);
  for (int i = 0; i < 3; ++i) {
    ::dup2(saved[i], i);
    ::close(saved[i]);
  }
  EXPECT_EQ(read.size(), 10u);
}

TEST_F(SandboxedParserTest, WorksWithIgnoredChildSignals) {
  const auto before = ::signal(SIGCHLD, SIG_IGN);
  const Bytes read = parse_sandboxed(file(), kParser, {}, as_it_is);
  const std::string crash = complaint([](const RegularFile&) -> Bytes { std::abort(); });
  ::signal(SIGCHLD, before);
  EXPECT_EQ(read.size(), 10u);
  EXPECT_THAT(crash, HasSubstr("ends the process that reads it"));
}

TEST_F(SandboxedParserTest, OpensRegularFilesOnly) {
  EXPECT_THAT(complaint(as_it_is, {}, "none.foo"), HasSubstr("expected a foo, found no such file"));
  EXPECT_THAT(complaint(as_it_is, {}, "."), HasSubstr("found a directory"));
  ASSERT_EQ(::mkfifo(file("pipe.foo").c_str(), 0600), 0);
  EXPECT_THAT(complaint(as_it_is, {}, "pipe.foo"),
              HasSubstr("found a named pipe, not a regular file"));
  fs::create_symlink("/dev/zero", file("device.foo"));
  EXPECT_THAT(complaint(as_it_is, {}, "device.foo"), HasSubstr("found a device"));
  fs::create_symlink("loop.foo", file("loop.foo"));
  EXPECT_THAT(complaint(as_it_is, {}, "loop.foo"), HasSubstr("symbolic links"));
  fs::create_symlink("a.foo", file("link.foo"));
  EXPECT_EQ(complaint(as_it_is, {}, "link.foo"), "accepted");
  EXPECT_THAT(complaint(as_it_is, {.max_file_bytes = 9}),
              HasSubstr("expected a foo of at most 9 bytes, found 10 bytes"));
}

TEST_F(SandboxedParserTest, RunsInSeveralThreads) {
  std::vector<std::jthread> threads;
  std::atomic<int> read = 0;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&] {
      for (int i = 0; i < 25; ++i)
        read += parse_sandboxed(file(), kParser, {}, as_it_is).size() == 10 ? 1 : 0;
    });
  threads.clear();
  EXPECT_EQ(read, 100);
}

TEST_F(SandboxedParserTest, EndsWithItsParent) {
  const pid_t parent = ::fork();
  if (parent == 0) {
    try {
      parse_sandboxed(file(), kParser, {.cpu_s = 60, .wall_s = 60},
                      [](const RegularFile&) -> Bytes {
                        while (for_ever) ::pause();
                        return {};
                      });
    } catch (...) {
    }
    ::_exit(0);
  }
  const auto children = fmt::format("/proc/{0}/task/{0}/children", parent);
  pid_t child = 0;
  for (int i = 0; i < 500 && child == 0; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    std::ifstream(children) >> child;
  }
  ::kill(parent, SIGKILL);
  ::waitpid(parent, nullptr, 0);
  if (child == 0) GTEST_SKIP() << "this kernel does not list the children of a process";
  const auto is_there = [&] {
    std::string line;
    std::getline(std::ifstream(fmt::format("/proc/{}/stat", child)) >> std::ws, line);
    return !line.empty() && line.find(") Z ") == std::string::npos;
  };
  for (int i = 0; i < 500 && is_there(); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_FALSE(is_there());
}

}  // namespace
}  // namespace throng::sandboxed_parser_test
