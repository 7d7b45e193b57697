// Steps after warm-up allocate only for growing contact buffers, which is counted. Counts every
// operator new of the process.
#include <gtest/gtest.h>

#include <cmath>

#include "scenes/file/recorded_scene.h"
#include "scenes/scenes.h"
#include "tests/allocation_counter.h"
#include "tests/recordings/recording_folder.h"

namespace throng::step_allocation_test {
namespace {

void expect_no_uncounted_growth(const Scene& scene, const char* what) {
  for (const int threads : {1, 2}) {
    Simulation simulation(scene, {.threads = threads});
    for (int frame = 0; frame < 240; ++frame) simulation.step();
    size_t uncounted = 0, steps_that_grew = 0;
    for (int frame = 0; frame < 240; ++frame) {
      const size_t before = test::allocations_so_far();
      const Frame& now = simulation.step();
      const bool grew = now.counters->buffers_grown > 0;
      steps_that_grew += grew;
      if (!grew) uncounted += test::allocations_so_far() - before;
    }
    EXPECT_EQ(uncounted, 0u) << what << ", " << threads
                             << " threads: steps that report no growth allocated";
    EXPECT_LT(steps_that_grew, 60u) << what << ", " << threads << " threads";
  }
}

TEST(Simulation, AllocatesOnlyCountedGrowthWhenWarm) {
  expect_no_uncounted_growth(load_scene("corridor"), "corridor");
  // Between opening and closing of its doors.
  expect_no_uncounted_growth(load_scene("metro"), "metro");
  expect_no_uncounted_growth(load_scene("ticket_office"), "ticket_office");
  expect_no_uncounted_growth(load_scene("concert"), "concert");  // stands, then sets out
  Scene together = load_scene("corridor");
  for (Group& group : together.groups) group.social_groups = SocialGroupRule{};
  expect_no_uncounted_growth(together, "social_groups");
}

using RecordingAllocations = RecordingTest;

TEST_F(RecordingAllocations, AreOnlyCountedGrowthWhenWarm) {
  // Forty people on circles, some of them absent for a while, and ten who walk among them.
  std::string text = "# framerate: 25 fps\n# id frame x/m y/m z/m\n";
  for (int person = 0; person < 40; ++person)
    for (int frame = 0; frame < 300; ++frame) {
      if (person % 4 == 0 && frame > 120 && frame < 160) continue;
      const double turned = 0.01 * frame + person, radius_m = 2 + 0.1 * person;
      text += fmt::format("{} {} {:.4f} {:.4f} 1.{}\n", person, frame, radius_m * std::cos(turned),
                          radius_m * std::sin(turned), 60 + person);
    }
  RecordingOptions options;
  options.file = write("circles.txt", text);
  Scene scene = recorded_scene(options);
  expect_no_uncounted_growth(scene, "recorded");
  Group own;
  own.name = "own";
  own.model = adult_urdf();
  own.count = 10;
  own.spawn = {{-6, -6}, {-4, 6}};
  own.goals = {Rectangle{{4, -6}, {6, 6}}};
  scene.groups.insert(scene.groups.begin(), own);
  expect_no_uncounted_growth(scene, "recorded people and a group");
}

}  // namespace
}  // namespace throng::step_allocation_test
