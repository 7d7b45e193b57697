// no_miss [PAIRS [SEED]] checks the no-miss guarantee with at least PAIRS near pairs of parts, one
// line per family. Exit code 1 if a pair was missed or if pairs differ from the scalar reference.
#include <fmt/format.h>

#include <cstdlib>

#include "tests/culling/no_miss_pairs.h"

int main(int argc, char** argv) {
  using namespace throng::test;
  const uint64_t pairs = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 10'000'000;
  const uint64_t seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  NoMissCounts sum;
  fmt::print("{:<10}{:>12}{:>12}{:>12}{:>8}\n", "family", "near pairs", "touching", "reported",
             "missed");
  const auto line = [](std::string_view name, const NoMissCounts& found) {
    fmt::print("{:<10}{:>12}{:>12}{:>12}{:>8}\n", name, found.tested, found.touching,
               found.reported, found.missed);
    std::fflush(stdout);
  };
  for (const Family family : kFamilies) {
    const NoMissCounts found = check_no_misses(family, pairs / std::size(kFamilies) + 1, seed);
    line(name_of(family), found);
    if (found.missed > 0) fmt::print("  first miss: {}\n", found.first_miss);
    if (found.differing > 0) fmt::print("  first difference: {}\n", found.first_difference);
    sum.tested += found.tested;
    sum.touching += found.touching;
    sum.reported += found.reported;
    sum.missed += found.missed;
    sum.differing += found.differing;
  }
  line("all", sum);
  fmt::print("frames whose pairs differ from the scalar reference's: {}\n", sum.differing);
  return sum.missed == 0 && sum.differing == 0 ? 0 : 1;
}
