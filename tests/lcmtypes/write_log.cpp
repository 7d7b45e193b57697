// Writes the log of a made-up run for the replay test; prints "begins N ends N".
#include <cstdio>

#include "synthetic_run.h"

int main(int argc, char** argv) {
  if (argc != 2) return std::fprintf(stderr, "usage: lcm_write_log FILE\n"), 2;
  throng::SyntheticRun run({.avatars = 200, .seed = 12, .pairs = 400});
  throng::LogSink sink(argv[1]);
  run.play(sink, 90);
  std::printf("begins %ld ends %ld\n", static_cast<long>(run.begins()),
              static_cast<long>(run.ends()));
}
