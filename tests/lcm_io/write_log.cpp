// Writes the log of a synthetic run for the replay test; prints "begins N ends N". With a URL, also
// publishes the run.
#include <cstdio>

#include "lcm_io/wire/lcm_sink.h"
#include "synthetic_run.h"

int main(int argc, char** argv) {
  if (argc != 2 && argc != 3) return std::fprintf(stderr, "usage: lcm_write_log FILE [URL]\n"), 2;
  throng::SyntheticRun run({.avatars = 200, .seed = 12, .pairs = 400});
  throng::LogSink sink(argv[1]);
  run.play(sink, 90);
  if (argc == 3) {
    throng::LcmSink lcm({.url = argv[2]});
    throng::SyntheticRun again({});
    again.play(lcm, 10);
  }
  std::printf("begins %ld ends %ld\n", static_cast<long>(run.begins()),
              static_cast<long>(run.ends()));
}
