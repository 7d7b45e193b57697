// Tests encounters: valid paths, equal results alone and among others, and contacts.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "bench/realism/encounters.h"
#include "scenes/run/posing.h"
#include "scenes/run/simulation.h"

namespace throng::realism::encounter_test {
namespace {

TEST(Encounter, KeepsDiscsApartAtModestAccelerations) {
  constexpr uint64_t kSeed = 7;
  constexpr double kStep_s = 0.01;
  for (uint64_t number = 0; number < 300; ++number) {
    const Encounter encounter(kSeed, number);
    double nearest_m = 100, fastest_mps2 = 0;
    for (int i = 0; i * kStep_s <= Encounter::kDuration_s; ++i) {
      const double time_s = i * kStep_s;
      nearest_m =
          std::min(nearest_m, (encounter.place_m(0, time_s) - encounter.place_m(1, time_s)).norm());
      for (const size_t person : {0, 1})
        fastest_mps2 = std::max(fastest_mps2, (encounter.place_m(person, time_s + kStep_s) -
                                               2 * encounter.place_m(person, time_s) +
                                               encounter.place_m(person, time_s - kStep_s))
                                                      .norm() /
                                                  (kStep_s * kStep_s));
    }
    const std::string what = fmt::format("seed {}, {}: {}", kSeed, number, encounter.description());
    EXPECT_GE(nearest_m, Encounter::kDisc_m) << what;
    EXPECT_LE(nearest_m, 0.6 + 1e-9) << what;
    EXPECT_LE(fastest_mps2, Encounter::kMaxAcceleration_mps2) << what;
    for (const EncounterPerson& person : encounter.people()) {
      EXPECT_GE(person.speed_mps, 0.6) << what;
      EXPECT_LE(person.speed_mps, 1.8) << what;
    }
  }
}

TEST(Encounter, CoversAllKindsAndAngles) {
  std::map<EncounterKind, int> kinds;
  std::array<int, 6> sectors{};
  for (uint64_t number = 0; number < 600; ++number) {
    const Encounter encounter(1, number);
    ++kinds[encounter.kind()];
    const double apart_rad = std::abs(
        std::remainder(encounter.people()[1].heading_rad - encounter.people()[0].heading_rad,
                       2 * std::numbers::pi));
    ++sectors[std::min<size_t>(5, static_cast<size_t>(apart_rad / std::numbers::pi * 6))];
  }
  for (size_t kind = 0; kind < kEncounterKinds; ++kind)
    EXPECT_GT(kinds[static_cast<EncounterKind>(kind)], 150) << kind;
  for (size_t sector = 0; sector < 6; ++sector) EXPECT_GT(sectors[sector], 20) << sector;
}

TEST(EncounterRuns, GiveEqualResultsAloneAndAmongOthers) {
  constexpr uint64_t kSeed = 3;
  const EncounterRuns all = run_encounters({.seed = kSeed, .count = 24, .threads = 2});
  ASSERT_EQ(all.results.size() + all.rejected.size(), 24u);
  EXPECT_EQ(all.foreign_contacts, 0u);
  int touching = 0;
  for (const EncounterResult& among : all.results) {
    const EncounterRuns alone = run_encounters({.seed = kSeed, .first = among.number, .count = 1});
    ASSERT_EQ(alone.results.size(), 1u);
    const EncounterResult& by_itself = alone.results.front();
    const std::string what = fmt::format("seed {}, {}", kSeed, among.number);
    EXPECT_EQ(by_itself.touching_frames, among.touching_frames) << what;
    EXPECT_EQ(by_itself.max_depth_m, among.max_depth_m) << what;
    EXPECT_EQ(by_itself.min_root_distance_m, among.min_root_distance_m) << what;
    EXPECT_EQ(by_itself.groups, among.groups) << what;
    touching += among.touches();
  }
  fmt::print("seed {}: {} of 24 touch\n", kSeed, touching);
}

TEST(EncounterRuns, KeepRootsOnTheirPaths) {
  std::vector<Encounter> encounters;
  for (uint64_t number = 40; number < 46; ++number) encounters.emplace_back(5, number);
  const Scene scene = encounter_scene(encounters);
  Simulation simulation(scene, {.motion = encounter_motion(encounters)});
  const auto frames = static_cast<int>(Encounter::kDuration_s / scene.step_s);
  double farthest_m = 0;
  for (int number = 0; number < frames; ++number) {
    const Frame& frame = simulation.step();
    for (size_t id = 0; id < 2 * encounters.size(); ++id) {
      const Encounter& encounter = encounters[id / 2];
      farthest_m =
          std::max(farthest_m, (frame.roots[id].position_m.head<2>() - middle_of(encounter) -
                                encounter.place_m(id % 2, number * scene.step_s))
                                   .norm());
    }
  }
  EXPECT_LT(farthest_m, 1e-6);
  for (size_t id = 0; id < 2 * encounters.size(); ++id)
    EXPECT_EQ(simulation.bodies().styles[id], encounters[id / 2].people()[id % 2].style);
}

}  // namespace
}  // namespace throng::realism::encounter_test
