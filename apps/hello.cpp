// Who touches whom on the plaza within one second.
#include <cstdio>

#include "scenes/scenes.h"

int main() {
  throng::Simulation simulation(throng::load_scene("plaza"), {.threads = 2});
  for (int i = 0; i < 60; ++i) {
    const throng::Frame& frame = simulation.step();
    for (const auto& [pair, kind] : frame.events)
      std::printf("frame %2d: part %2u of %3u %s part %2u of %3u\n", i, pair.part_a(), pair.a(),
                  kind == throng::EventKind::kBegin ? "touches" : "leaves ", pair.part_b(),
                  pair.b());
  }
  std::printf("%llu contacts last\n",
              static_cast<unsigned long long>(simulation.step().pairs.size()));
}
