// no_miss_near [PAIRS [SEED]]: no pair of parts within the margin is missed, and every interval
// holds the distance, over at least that many such pairs, a line a family. Exit code 1 if not.
#include <cstdlib>
#include <iterator>

#include "tests/culling/near_rows.h"

int main(int argc, char** argv) {
  using namespace throng;
  const uint64_t pairs = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 10'000'000;
  const uint64_t seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  test::print_near_rows_head("family");
  test::NearRowsTally sum;
  for (const bench::Family family : bench::kFamilies) {
    const test::NearRowsTally found =
        test::check_near_rows(family, pairs / std::size(bench::kFamilies) + 1, seed);
    test::print_near_rows(bench::name_of(family), found);
    sum.add(found);
  }
  test::print_near_rows("all", sum);
  return sum.is_right() ? 0 : 1;
}
