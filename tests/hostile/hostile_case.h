// try_case() runs one hostile input in a child process and counts the result.
// Invariant: a crash, an error of another kind, or more than ten seconds is a failure; its input is
// kept.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "base/random.h"

namespace throng::hostile {

/// Random draws of one case.
class Draw {
 public:
  Draw(uint64_t seed, uint64_t index) : seed_(seed), index_(index) {}
  size_t below(size_t end) {
    return static_cast<size_t>(random_bits({seed_, index_, ++used_, Purpose::kStyle}) % end);
  }

 private:
  uint64_t seed_;
  uint64_t index_;
  uint64_t used_ = 0;
};

struct Tally {
  int64_t tried = 0;
  int64_t rejected = 0;
  int64_t ran = 0;
  int64_t crashed = 0;
  int64_t hung = 0;
};

/// A folder of this process, in memory if possible; removed at the end.
class Scratch {
 public:
  Scratch();
  ~Scratch();
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  const std::filesystem::path& folder() const { return folder_; }
  std::filesystem::path write(const std::string& name, const std::string& text) const;

 private:
  std::filesystem::path folder_;
};

/// Runs `use` in a child process for at most ten seconds of processor time. `use` returns for an
/// accepted input and throws InputError for a rejected one. A failing input is written to `kept` in
/// the working folder and reported on stderr.
void try_case(const std::string& input, const std::string& kept, const std::function<void()>& use,
              Tally& tally);

/// Prints the result line, `what` being "scenes", and returns the exit code.
int report(const std::string& what, const Tally& tally);

struct Arguments {
  int64_t count = 0;
  uint64_t seed = 1;
};
Arguments read_arguments(int argc, char** argv, int64_t count);

}  // namespace throng::hostile
