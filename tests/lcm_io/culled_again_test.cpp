// Culling the logged poses again gives the contacts of the run, up to the quantisation of states.
#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "nearly_touching.h"

namespace throng::culled_again_test {
namespace {

struct Case {
  const char* scene;
  uint64_t seed;
  int avatars = 80;
};
// NOLINTNEXTLINE(readability-identifier-naming): GoogleTest's name
void PrintTo(const Case& c, std::ostream* out) {
  *out << c.avatars << " in " << c.scene << ", seed " << c.seed;
}

/// Moves the robots of all externally controlled groups in wild motions, which gaits never reach.
void drive_wildly(Simulation& simulation, uint64_t seed) {
  const RunInfo& info = simulation.info();
  for (uint32_t id = 0; id < info.model_of_avatar.size(); ++id) {
    if (info.control_channels[info.group_of_avatar[id]].empty()) continue;
    const auto frame = static_cast<uint64_t>(simulation.next_frame());
    const double t = 0.05 * static_cast<double>(frame);
    const auto& columns = info.models[info.model_of_avatar[id]]->kinematics.columns();
    std::vector<double> joints;
    for (size_t c = 0; c < columns.size(); ++c)
      joints.push_back(
          random_uniform({seed, id, 0, Purpose::kStyle}, static_cast<double>(columns[c].lower),
                         static_cast<double>(columns[c].upper), static_cast<uint32_t>(c)) *
          std::sin(t));
    ExternalPose pose;
    pose.root.position_m = {3 * std::sin(t), 2 * std::cos(0.7 * t), 0.3};
    pose.root.world_from_root =
        Eigen::AngleAxisf(static_cast<float>(t), Eigen::Vector3f(0.3f, 0.5f, 1).normalized());
    pose.joints = joints;
    simulation.set_pose(id, pose);
  }
}

class CulledLog : public testing::TestWithParam<Case> {};

TEST_P(CulledLog, HasThePairsOfItsRunExceptNearContacts) {
  constexpr int kFrames = 180;
  const ScratchFile log;
  Scene scene = small_scene(GetParam().scene, GetParam().seed, GetParam().avatars);
  // Small crowds that avoid each other hardly touch.
  scene.body_avoidance = GetParam().avatars > 100;
  if (!scene.body_avoidance) scene.steering.model = SteeringKind::kOrca;
  const std::vector<CulledFrame> run = logged(
      scene, kFrames, log.path(), {}, [](Simulation& s) { drive_wildly(s, GetParam().seed); });
  const std::vector<CulledFrame> again = culled_again(log.path(), 2);
  ASSERT_EQ(again.size(), run.size());
  const Simulation shape(scene, {});
  const Placed placed(shape);
  size_t pairs = 0;
  int only = 0;
  for (size_t i = 0; i < run.size(); ++i) {
    SCOPED_TRACE(testing::Message() << "frame " << i);
    EXPECT_EQ(absent(again[i]), absent(run[i]));
    only += expect_near(placed, run[i], again[i]);
    pairs += run[i].pairs.size();
  }
  EXPECT_GT(pairs, scene.body_avoidance ? 10u : 100u) << "too few for a conclusion";
  EXPECT_LT(only, 20 + static_cast<int>(pairs / 100));
  std::cout << pairs << " pairs, " << only << " in one run only\n";
}

INSTANTIATE_TEST_SUITE_P(Scenes, CulledLog,
                         testing::Values(Case{"plaza", 1}, Case{"plaza", 2}, Case{"plaza", 3},
                                         Case{"corridor", 1}, Case{"station_platform", 1},
                                         Case{"bottleneck", 2, 200}, Case{"bottleneck", 3, 200},
                                         Case{"robot_in_crowd", 1}, Case{"robot_in_crowd", 2},
                                         Case{"paper_350", 1}));

TEST(CulledLogBound, IsBelowHalfAMillimetreForTwoPeople) {
  const ScratchFile log;
  const Scene scene = small_scene("plaza", 1);
  const std::vector<CulledFrame> run = logged(scene, 100, log.path());
  const Simulation shape(scene, {});
  const Placed placed(shape);
  double tallest_m = 0, max_m = 0;
  for (size_t frame = 0; frame < run.size(); frame += 9)
    for (uint32_t id = 0; id < run[frame].roots.size(); ++id) {
      tallest_m =
          std::max(tallest_m, placed.scale(id) * static_cast<double>(placed.model(id).height_m));
      max_m = std::max(max_m, placed.error_m(run[frame], id));
    }
  std::cout << "people of up to " << tallest_m << " m: " << max_m * 1e3 << " mm\n";
  EXPECT_LT(2 * max_m, 5e-4);
}

}  // namespace
}  // namespace throng::culled_again_test
