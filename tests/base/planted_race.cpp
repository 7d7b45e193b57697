// A deliberate race: the thread sanitizer must see it although it skips workers.cpp.
#include "base/workers.h"

int main() {
  throng::Workers workers(4);
  int sum = 0;
  for (int round = 0; round < 100; ++round)
    workers.for_blocks(100, [&](int block, int) { sum += block; });
  return sum == 0;
}
