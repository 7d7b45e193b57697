// no_miss_people [PAIRS [SEED]]: the law of no misses over at least that many near pairs of parts
// of people who walk, stand and give way, a line a scene. Exit code 1 if one was missed.
#include <fmt/format.h>

#include <array>
#include <cstdlib>
#include <span>
#include <string_view>

#include "base/simd.h"
#include "scenes/run/postures.h"
#include "tests/scenes/near_people.h"

namespace {

using namespace throng;

struct Tally {
  uint64_t near = 0, touching = 0, missed = 0, given_way = 0;
  std::string first_miss;
};

/// A bundled scene whose people stand and walk closer to each other than they would.
Scene pressed(std::string_view name, uint64_t seed) {
  Scene scene = load_scene(std::string(name));
  for (Group& group : scene.groups)
    if (group.driven.empty()) group.radius_m = 0.1;
  scene.seed = seed;
  return scene;
}

/// Some seconds of a scene; what is checked differs from round to round.
void run(std::string_view name, uint64_t seed, size_t round, Tally& tally) {
  constexpr std::array<PairSearch, 3> kSearches = {PairSearch::kGrid, PairSearch::kSweep,
                                                   PairSearch::kBrute};
  const std::vector<SimdTarget> targets = simd_targets_of_this_machine();
  Scene scene = pressed(name, seed + round);
  scene.part_volume = kAllVolumes[round % std::size(kAllVolumes)];
  SimulationOptions options;
  options.threads = 2;
  options.culler.simd = targets[round % targets.size()];
  options.culler.pair_search = kSearches[round % kSearches.size()];
  Simulation simulation(scene, options);
  test::NearPeople people(simulation);
  const int steps = static_cast<int>(8 / scene.step_s);
  for (int step = 0; step < steps; ++step) {
    const Frame& frame = simulation.step();
    if (step % 12 != 11) continue;
    people.check(frame);
    for (const Yield& yield : simulation.bodies().yields) tally.given_way += !yield.is_none();
  }
  if (people.missed > 0 && tally.missed == 0)
    tally.first_miss =
        fmt::format("{}, seed {}, {}, {}: {}", name, scene.seed, to_text(scene.part_volume),
                    name_of(options.culler.simd), people.first_miss);
  tally.near += people.near;
  tally.touching += people.touching;
  tally.missed += people.missed;
}

}  // namespace

int main(int argc, char** argv) {
  constexpr std::array<std::string_view, 6> kScenes = {
      "plaza", "corridor", "crossing", "bottleneck", "evacuation", "robot_in_crowd"};
  const uint64_t pairs = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 10'000'000;
  const uint64_t seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  Tally sum;
  fmt::print("{:<16}{:>12}{:>12}{:>18}{:>8}\n", "scene", "near pairs", "touching",
             "postures given way", "missed");
  const auto line = [](std::string_view name, const Tally& tally) {
    fmt::print("{:<16}{:>12}{:>12}{:>18}{:>8}\n", name, tally.near, tally.touching, tally.given_way,
               tally.missed);
    std::fflush(stdout);
  };
  for (const std::string_view name : kScenes) {
    Tally tally;
    for (size_t round = 0; tally.near < pairs / kScenes.size() + 1; ++round)
      run(name, seed, round, tally);
    line(name, tally);
    if (tally.missed > 0) fmt::print("  first miss: {}\n", tally.first_miss);
    sum.near += tally.near;
    sum.touching += tally.touching;
    sum.missed += tally.missed;
    sum.given_way += tally.given_way;
  }
  line("all", sum);
  return sum.missed == 0 ? 0 : 1;
}
