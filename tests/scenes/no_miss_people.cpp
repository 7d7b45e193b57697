// no_miss_people [PAIRS [SEED [touching]]] checks the no-miss guarantee for at least PAIRS near
// pairs of parts of walking, standing and adapting people, per scene.
// Unless `touching` is given it also checks proximity rows, for as many pairs within a margin;
// distances take most of the time. Exit code 1: a contact was missed, or bounds do not contain the
// distance.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "base/simd.h"
#include "scenes/run/body_tables.h"
#include "scenes/run/postures.h"
#include "tests/scenes/person_pairs.h"

namespace {

using namespace throng;

struct Tally {
  uint64_t tested = 0, touching = 0, missed = 0, avoiding = 0;
  std::string first_miss;
  test::ProximityTally rows;

  void add(const Tally& other) {
    tested += other.tested;
    touching += other.touching;
    missed += other.missed;
    avoiding += other.avoiding;
    rows.add(other.rows);
  }
};

/// Bundled scene with people closer together than usual.
Scene pressed(std::string_view name, uint64_t seed) {
  Scene scene = load_scene(std::string(name));
  for (Group& group : scene.groups)
    if (group.control_channel.empty()) group.radius_m = 0.1;
  scene.seed = seed;
  return scene;
}

/// Runs some seconds of a scene; settings differ between rounds.
void run(std::string_view name, uint64_t seed, size_t round, bool has_margin, Tally& tally) {
  constexpr std::array<PairSearch, 3> kSearches = {PairSearch::kGrid, PairSearch::kSweep,
                                                   PairSearch::kBrute};
  constexpr std::array<float, 2> kMargins_m = {0.05f, 0.2f};
  const std::vector<SimdTarget> targets = simd_targets_of_this_machine();
  Scene scene = pressed(name, seed + round);
  const float proximity_m = has_margin ? kMargins_m[round / 2 % kMargins_m.size()] : 0;
  scene.proximity_m = static_cast<double>(proximity_m);
  scene.part_volume = kAllVolumes[round % std::size(kAllVolumes)];
  static const auto tables = std::make_shared<BodyTables>();
  SimulationOptions options;
  options.tables = tables;
  options.threads = 2;
  options.culler.simd = targets[round % targets.size()];
  options.culler.pair_search = kSearches[round % kSearches.size()];
  options.culler.exact = round % 2 == 1;
  Simulation simulation(scene, options);
  test::PersonPairs people(simulation, proximity_m);
  const int steps = static_cast<int>(8 / scene.step_s);
  for (int step = 0; step < steps; ++step) {
    const Frame& frame = simulation.step();
    if (step % 6 != 5) continue;
    people.check(frame);
    for (const AvoidancePosture& posture : simulation.bodies().avoidance)
      tally.avoiding += !posture.is_none();
  }
  if (people.missed > 0 && tally.missed == 0)
    tally.first_miss =
        fmt::format("{}, seed {}, {}, {}: {}", name, scene.seed, to_text(scene.part_volume),
                    name_of(options.culler.simd), people.first_miss);
  if (tally.rows.first_wrong.empty() && !people.rows.is_right())
    people.rows.first_wrong = fmt::format("{}, seed {}, {}: {}", name, scene.seed,
                                          name_of(options.culler.simd), people.rows.first_wrong);
  tally.add({people.tested, people.touching, people.missed, 0, "", people.rows});
}

}  // namespace

int main(int argc, char** argv) {
  constexpr std::array<std::string_view, 6> kScenes = {
      "plaza", "corridor", "crossing", "bottleneck", "evacuation", "robot_in_crowd"};
  const uint64_t pairs = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 10'000'000;
  const uint64_t seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  const bool has_margin = argc <= 3 || std::string_view(argv[3]) != "touching";
  Tally sum;
  std::vector<Tally> of_scenes;
  fmt::print("{:<16}{:>12}{:>12}{:>20}{:>8}\n", "scene", "near pairs", "touching",
             "adapted postures", "missed");
  const auto line = [](std::string_view name, const Tally& tally) {
    fmt::print("{:<16}{:>12}{:>12}{:>20}{:>8}\n", name, tally.tested, tally.touching,
               tally.avoiding, tally.missed);
    if (!tally.first_miss.empty()) fmt::print("  first miss: {}\n", tally.first_miss);
    std::fflush(stdout);
  };
  const uint64_t of_each = pairs / kScenes.size() + 1;
  for (const std::string_view name : kScenes) {
    Tally& tally = of_scenes.emplace_back();
    const uint64_t& min_tested = has_margin ? tally.rows.tested : tally.tested;
    for (size_t round = 0; std::min(tally.tested, min_tested) < of_each; ++round)
      run(name, seed, round, has_margin, tally);
    line(name, tally);
    sum.add(tally);
  }
  line("all", sum);
  if (!has_margin) return sum.missed == 0 ? 0 : 1;
  test::print_proximity_head("within a margin");
  for (size_t i = 0; i < kScenes.size(); ++i)
    test::print_proximity_rows(kScenes[i], of_scenes[i].rows);
  test::print_proximity_rows("all", sum.rows);
  return sum.missed == 0 && sum.rows.is_right() ? 0 : 1;
}
