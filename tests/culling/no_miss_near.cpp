// no_miss_near [PAIRS [SEED]]: no pair of parts within the margin is missed, and every interval
// holds the distance, over at least that many such pairs, a line a family. Exit code 1 if not.
#include <fmt/format.h>

#include <cstdlib>

#include "tests/culling/near_rows.h"

int main(int argc, char** argv) {
  using namespace throng;
  const uint64_t pairs = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 10'000'000;
  const uint64_t seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  fmt::print("{:<10}{:>12}{:>12}{:>12}{:>8}{:>9}{:>6}{:>10}{:>11}\n", "family", "near", "touching",
             "listed", "missed", "outside", "wide", "by all", "differing");
  const auto line = [](std::string_view name, const test::NearRowsTally& t) {
    fmt::print("{:<10}{:>12}{:>12}{:>12}{:>8}{:>9}{:>6}{:>10}{:>11}\n", name, t.near, t.touching,
               t.listed, t.missed, t.outside, t.wide, t.by_all, t.differing);
    std::fflush(stdout);
  };
  test::NearRowsTally sum;
  for (const bench::Family family : bench::kFamilies) {
    const test::NearRowsTally found =
        test::check_near_rows(family, pairs / std::size(bench::kFamilies) + 1, seed);
    line(bench::name_of(family), found);
    if (!found.is_right()) fmt::print("  first: {}\n", found.first_wrong);
    sum.add(found);
  }
  line("all", sum);
  return sum.is_right() ? 0 : 1;
}
