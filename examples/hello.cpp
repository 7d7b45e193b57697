// The pairs of body parts that touch on the plaza within one second.
#include <cstdio>

#include "scenes/scenes.h"

int main() {
  throng::Simulation crowd(throng::load_scene("plaza"), {.threads = 2});
  for (int i = 0; i < 60; ++i)
    for (const auto& [pair, kind, level] : crowd.step().events)
      std::printf("frame %2d: part %2u of %3u %s part %2u of %3u\n", i, pair.part_a(), pair.a(),
                  kind == throng::EventKind::kBegin ? "touches" : "leaves ", pair.part_b(),
                  pair.b());
  std::printf("%zu contacts last\n", crowd.step().pairs.size());
}
