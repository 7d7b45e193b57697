// Damaged mesh files, read as the product reads them: mutated_meshes [COUNT [SEED]], by default 200
// and 1. None may crash the reader or take more than 10 s; failures of assimp in its own process
// are counted. Exit code 1 if one does; its file is kept.
#include <fmt/format.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <string_view>
#include <thread>

#include "avatars/mesh/mesh_file.h"
#include "base/errors.h"
#include "base/random.h"
#include "tests/avatars/mesh_seeds.h"

namespace {

namespace fs = std::filesystem;
using namespace throng;
using Bytes = std::vector<uint8_t>;
using Clock = std::chrono::steady_clock;

constexpr double kMaxSeconds = 10;

/// Random draws of one case, independent of other cases.
class Dice {
 public:
  Dice(uint64_t seed, uint64_t number) : key_{seed, number, 0, Purpose::kStyle} {}
  size_t below(size_t limit) { return random_bits(key_, draw_++) % std::max<size_t>(limit, 1); }
  template <typename Range>
  const auto& one_of(const Range& range) {
    return range[below(std::size(range))];
  }

 private:
  RandomKey key_;
  uint32_t draw_ = 0;
};

using Range = std::pair<size_t, size_t>;

Range chunk(const Bytes& bytes, Dice& dice) {
  const size_t at = dice.below(bytes.size());
  return {at, at + dice.below(std::min<size_t>(bytes.size() - at, 200))};
}

Range line(const Bytes& bytes, Dice& dice) {
  const auto begin = bytes.begin() + static_cast<ptrdiff_t>(dice.below(bytes.size()));
  const auto from = std::find(begin, bytes.end(), uint8_t{'\n'});
  const auto to = from == bytes.end() ? from : std::find(from + 1, bytes.end(), uint8_t{'\n'});
  return {static_cast<size_t>(from - bytes.begin()), static_cast<size_t>(to - bytes.begin())};
}

/// A number with sign, point and exponent.
Range number(const Bytes& bytes, Dice& dice) {
  const auto is_digit = [](uint8_t c) { return c >= '0' && c <= '9'; };
  const auto is_of_number = [&](uint8_t c) {
    return is_digit(c) || c == '.' || c == '-' || c == '+' || c == 'e';
  };
  const auto begin = bytes.begin() + static_cast<ptrdiff_t>(dice.below(bytes.size()));
  const auto from = std::find_if(begin, bytes.end(), is_digit);
  const auto to = std::find_if_not(from, bytes.end(), is_of_number);
  return {static_cast<size_t>(from - bytes.begin()), static_cast<size_t>(to - bytes.begin())};
}

void replace(Bytes& bytes, Range range, std::string_view by) {
  const auto at = bytes.begin() + static_cast<ptrdiff_t>(range.first);
  bytes.insert(bytes.erase(at, bytes.begin() + static_cast<ptrdiff_t>(range.second)), by.begin(),
               by.end());
}

void duplicate(Bytes& bytes, Range range, Dice& dice) {
  const Bytes piece(bytes.begin() + static_cast<ptrdiff_t>(range.first),
                    bytes.begin() + static_cast<ptrdiff_t>(range.second));
  const auto to = bytes.begin() + static_cast<ptrdiff_t>(dice.below(bytes.size()));
  bytes.insert(to, piece.begin(), piece.end());
}

constexpr std::array<std::string_view, 14> kExtremeWords = {"0",
                                                            "-1",
                                                            "1e39",
                                                            "-1e308",
                                                            "nan",
                                                            "inf",
                                                            "2147483647",
                                                            "2147483648",
                                                            "4294967295",
                                                            "4294967296",
                                                            "99999999999999999999",
                                                            "1e-320",
                                                            "65536",
                                                            ""};
constexpr std::array<uint32_t, 8> kExtremeBits = {0,          1,          0x7fffffff, 0x80000000,
                                                  0xffffffff, 0x7f800000, 0x7fc00000, 0x00010000};

void damage_once(Bytes& bytes, Dice& dice) {
  switch (dice.below(9)) {
    case 0:
      bytes.resize(dice.below(bytes.size()));
      break;
    case 1:
      bytes[dice.below(bytes.size())] ^= static_cast<uint8_t>(1u << dice.below(8));
      break;
    case 2:
      bytes[dice.below(bytes.size())] = static_cast<uint8_t>(dice.below(256));
      break;
    case 3:
      replace(bytes, number(bytes, dice), dice.one_of(kExtremeWords));
      break;
    case 4: {
      const uint32_t word = dice.one_of(kExtremeBits);
      const size_t at = dice.below(bytes.size());
      for (size_t k = 0; k < 4 && at + k < bytes.size(); ++k)
        bytes[at + k] = static_cast<uint8_t>(word >> (8 * k));
      break;
    }
    case 5:
      replace(bytes, chunk(bytes, dice), "");
      break;
    case 6:
      duplicate(bytes, chunk(bytes, dice), dice);
      break;
    case 7:
      replace(bytes, line(bytes, dice), "");
      break;
    default:
      duplicate(bytes, line(bytes, dice), dice);
  }
}

Bytes damaged(Bytes bytes, Dice& dice) {
  for (size_t times = 1 + dice.below(3); times > 0 && !bytes.empty(); --times)
    damage_once(bytes, dice);
  return bytes;
}

/// State shared by the reader and the process that watches it.
struct Progress {
  std::atomic<int> next = 0;  ///< the current case, or the first one
  std::atomic<int64_t> began_ms = 0;
  int rejected = 0, read = 0, hung = 0;
  int assimp_crashed = 0, assimp_stalled = 0, assimp_hoarded = 0;
};

int64_t now_ms() {
  return std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now().time_since_epoch())
      .count();
}

class Cases {
 public:
  Cases(int count, uint64_t seed)
      : count_(count),
        seed_(seed),
        seeds_(mesh_seeds()),
        folder_(fs::temp_directory_path() / fmt::format("throng_meshes_{}", ::getpid())) {
    fs::create_directories(folder_);
    std::set<std::string> formats;
    for (const MeshSeed& each : seeds_) formats.insert(each.extension);
    std::printf("mutated meshes: %d of %zu formats, seed %llu\n", count, formats.size(),
                static_cast<unsigned long long>(seed));
    std::fflush(stdout);
  }

  int count() const { return count_; }
  const fs::path& folder() const { return folder_; }

  /// Reads all cases from `progress.next` on.
  void read_all(Progress& progress) const {
    for (; progress.next < count_; ++progress.next) {
      const fs::path file = written(progress.next);
      progress.began_ms = now_ms();
      try {
        read_mesh(file);
        ++progress.read;
      } catch (const InputError& error) {
        ++progress.rejected;
        const std::string_view message = error.what();
        progress.assimp_crashed += message.find("crashes assimp") != message.npos ? 1 : 0;
        progress.assimp_stalled += message.find("keeps assimp busy") != message.npos ? 1 : 0;
        progress.assimp_hoarded += message.find("of memory") != message.npos ? 1 : 0;
      }
      const double seconds = static_cast<double>(now_ms() - progress.began_ms) / 1000;
      if (seconds > kMaxSeconds) {
        ++progress.hung;
        keep(file, progress.next, fmt::format("took {:.1f} s", seconds));
      }
      fs::remove(file);
    }
  }

  void keep(const fs::path& file, int number, const std::string& what) const {
    const fs::path kept =
        fs::temp_directory_path() /
        fmt::format("throng_mesh_{}_{}{}", seed_, number, file.extension().string());
    std::error_code ignored;
    fs::copy_file(file, kept, fs::copy_options::overwrite_existing, ignored);
    std::printf("case %d %s: %s\n", number, what.c_str(), kept.c_str());
    std::fflush(stdout);
  }

  fs::path path(int number) const {
    return folder_ / fmt::format("{}{}", number, seed_of(number).extension);
  }

 private:
  const MeshSeed& seed_of(int number) const {
    return seeds_[static_cast<size_t>(number) % seeds_.size()];
  }

  fs::path written(int number) const {
    Dice dice(seed_, static_cast<uint64_t>(number));
    const Bytes bytes = damaged(seed_of(number).bytes, dice);
    std::ofstream out(path(number), std::ios::binary);
    out.write(reinterpret_cast<const char*>(bytes.data()),
              static_cast<std::streamsize>(bytes.size()));
    return path(number);
  }

  int count_;
  uint64_t seed_;
  std::vector<MeshSeed> seeds_;
  fs::path folder_;
};

/// Ends a reader that hangs; returns its wait status.
int watched(pid_t reader, const Progress& progress) {
  int status = 0;
  while (::waitpid(reader, &status, WNOHANG) == 0) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    const int64_t began_ms = progress.began_ms;
    if (began_ms > 0 && now_ms() - began_ms > int64_t{6000} * static_cast<int64_t>(kMaxSeconds))
      ::kill(reader, SIGKILL);
  }
  return status;
}

}  // namespace

int main(int argc, char** argv) {
  const int count = argc > 1 ? std::atoi(argv[1]) : 200;
  const uint64_t seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  if (count <= 0) return std::fprintf(stderr, "usage: mutated_meshes [COUNT [SEED]]\n"), 2;
  const Cases cases(count, seed);
  void* shared =
      ::mmap(nullptr, sizeof(Progress), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (shared == MAP_FAILED) return std::perror("mmap"), 3;
  Progress& progress = *new (shared) Progress;
  int crashed = 0;
  while (progress.next < count) {
    const pid_t reader = ::fork();
    if (reader < 0) return std::perror("fork"), 3;
    if (reader == 0) {
      cases.read_all(progress);
      std::fflush(stdout);
      ::_exit(0);
    }
    const int status = watched(reader, progress);
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) break;
    const int number = progress.next++;
    const bool is_hung = WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL;
    ++(is_hung ? progress.hung : crashed);
    cases.keep(cases.path(number), number, is_hung ? "never ended" : "crashed the reader");
  }
  fs::remove_all(cases.folder());
  std::printf(
      "in the sandbox: assimp crashed %d times, was stopped %d times for its time and %d "
      "times for its memory\n",
      progress.assimp_crashed, progress.assimp_stalled, progress.assimp_hoarded);
  std::printf("[ inputs ] meshes: %d tried, %d rejected, %d read, %d crashed, %d hung\n", count,
              progress.rejected, progress.read, crashed, progress.hung);
  // A reader that rejects or accepts everything was not tested.
  const bool is_tried = progress.read > 0 && progress.rejected > 0;
  return crashed + progress.hung == 0 && is_tried ? 0 : 1;
}
