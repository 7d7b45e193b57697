// degenerate_hulls_sweep [CLOUDS [SEED]] checks corners, gaps and depths of hulls of random and
// degenerate clouds of up to 10 000 points. Exit code 1 if a check fails.
#include <cstdlib>

#include "tests/culling/degenerate_hulls.h"

int main(int argc, char** argv) {
  using namespace throng::test;
  const uint64_t clouds = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 100'000;
  const uint64_t seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  const DegenerateHullsTally tally = check_degenerate_hulls(clouds, 10'000, seed);
  print_degenerate_hulls(tally);
  return tally.wrong == 0 ? 0 : 1;
}
