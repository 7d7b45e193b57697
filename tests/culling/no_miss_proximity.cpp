// no_miss_proximity [PAIRS [SEED]] checks at least PAIRS pairs of parts within the margin, one line
// per family. Exit code 1 if one was missed or its bounds do not contain the distance.
#include <cstdlib>
#include <iterator>

#include "tests/culling/proximity_rows.h"

int main(int argc, char** argv) {
  using namespace throng;
  const uint64_t pairs = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 10'000'000;
  const uint64_t seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  test::print_proximity_head("family");
  test::ProximityTally sum;
  for (const bench::Family family : bench::kFamilies) {
    const test::ProximityTally found =
        test::check_proximity_rows(family, pairs / std::size(bench::kFamilies) + 1, seed);
    test::print_proximity_rows(bench::name_of(family), found);
    sum.add(found);
  }
  test::print_proximity_rows("all", sum);
  return sum.is_right() ? 0 : 1;
}
