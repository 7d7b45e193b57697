// A race on purpose: what the workers call is watched by the thread sanitizer, although the file
// that calls it is not.
#include "base/workers.h"

int main() {
  throng::Workers workers(4);
  int sum = 0;
  for (int round = 0; round < 100; ++round)
    workers.for_blocks(100, [&](int block, int) { sum += block; });
  return sum == 0;
}
