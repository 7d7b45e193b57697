// Tests that a box of parts runs like any other scene, with equal events for any thread count.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <set>

#include "avatars/avatars.h"
#include "avatars/gait/gait_file.h"
#include "base/errors.h"
#include "bench/paper/parts.h"
#include "culling/triangles/triangle_bvh.h"
#include "scenes/file/scene.h"
#include "scenes/motion/box_motion.h"
#include "scenes/run/runner.h"

namespace throng::box_scene_test {
namespace {

RunSummary run_scene(const std::string& name, const SimulationOptions& options, double seconds,
                     bool exact = false) {
  Scene scene = load_scene(name);
  scene.duration_s = seconds;
  scene.exact = exact;
  Simulation simulation(std::move(scene), options);
  return run(simulation, {});
}

TEST(BoxScene, HasTheObjectCountsOfThePaper) {
  for (const int count : {15, 50, 350, 500}) {
    const RunSummary summary = run_scene("paper_" + std::to_string(count), {}, 0.05);
    EXPECT_EQ(summary.avatars, count);
    EXPECT_EQ(summary.parts, count);
    EXPECT_EQ(summary.unplaced, 0);
  }
}

TEST(BoxScene, GivesEqualEventsForAnyThreadsAndSimd) {
  SimulationOptions options;
  const RunSummary expected = run_scene("paper_350", options, 1);
  EXPECT_GT(expected.begins, 0u);
  EXPECT_EQ(expected.begins, expected.ends);
  options.threads = 2;
  EXPECT_EQ(run_scene("paper_350", options, 1).hash, expected.hash) << "2 threads";
  options.threads = 1;
  for (const SimdTarget target : simd_targets_of_this_machine()) {
    options.culler.simd = target;
    EXPECT_EQ(run_scene("paper_350", options, 1).hash, expected.hash) << name_of(target);
  }
}

/// Oracle: the triangles of all pairs of parts in every frame.
TEST(BoxScene, ReportsExactlyTheTouchingPairs) {
  Scene scene = load_scene("paper_50");
  scene.exact = true;
  Simulation simulation(scene, {});
  std::vector<TriangleBvh> surfaces;
  size_t found = 0;
  for (int number = 0; number < 40; ++number) {
    const Frame& frame = simulation.step();
    const RunInfo& info = simulation.info();
    if (surfaces.empty())
      for (const auto& model : info.models)
        surfaces.emplace_back(model->parts[0].mesh.vertices, model->parts[0].mesh.triangles);
    std::vector<PartPose> poses;
    for (const RootPose& root : frame.roots) {
      Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
      pose.linear() = root.world_from_root.cast<double>().toRotationMatrix();
      poses.push_back(to_part_pose(pose));
    }
    std::vector<PairKey> expected;
    TriangleCounters counters;
    for (uint32_t a = 0; a < frame.roots.size(); ++a)
      for (uint32_t b = a + 1; b < frame.roots.size(); ++b)
        if (solids_touch(surfaces[info.model_of_avatar[a]], poses[a], 1,
                         surfaces[info.model_of_avatar[b]], poses[b], 1,
                         (frame.roots[b].position_m - frame.roots[a].position_m).cast<float>(),
                         counters))
          expected.emplace_back(a, b, 0, 0);
    found += expected.size();
    const std::vector<PairKey> reported(frame.pairs.begin(), frame.pairs.end());
    ASSERT_TRUE(reported == expected) << "frame " << number << ": " << reported.size()
                                      << " pairs reported, " << expected.size() << " touch";
  }
  EXPECT_GT(found, 0u);
}

/// Gaits and tables are looked up by content: those of another part or the whole body must differ.
TEST(BoxScene, GivesPartsDistinctHashes) {
  const std::shared_ptr<const Model> body = load_model(adult_urdf());
  std::set<uint64_t> hashes = {body->content_hash};
  for (const std::shared_ptr<const Model>& part : loose_parts(*body)) {
    EXPECT_TRUE(hashes.insert(part->content_hash).second) << part->name;
    EXPECT_FALSE(gait_of(*part, GaitStyle::kPlain).has_legs()) << part->name;
  }
}

TEST(BoxScene, KeepsDensityWhenScaled) {
  Scene scene = load_scene("paper_15");
  const double edge_m = scene.box->edge_m;
  std::vector<std::string> notes;
  scale_to(scene, 120, notes);
  EXPECT_EQ(scene.box->count, 120);
  EXPECT_NEAR(scene.box->edge_m, 2 * edge_m, 1e-9);
  EXPECT_EQ(notes.size(), 1u);
}

/// Returns the error of loading a scene of this text; empty: none.
std::string load_error(const std::string& text) {
  const auto file =
      std::filesystem::temp_directory_path() / ("throng_box_" + std::to_string(getpid()) + ".yaml");
  std::ofstream(file) << text;
  std::string complaint;
  try {
    Simulation simulation(load_scene(file.string()), {});
  } catch (const InputError& error) {
    complaint = error.what();
  }
  std::filesystem::remove(file);
  return complaint;
}

TEST(BoxScene, RejectsInvalidBoxes) {
  EXPECT_EQ(load_error("kind: box\nbox: {count: 3, edge_m: 3}\n"), "");
  EXPECT_NE(load_error("kind: bix\nbox: {count: 3, edge_m: 3}\n").find("did you mean 'box'"),
            std::string::npos);
  EXPECT_NE(load_error("kind: box\nbox: {count: 3, edge_m: 0.3}\n").find("can move"),
            std::string::npos);
  EXPECT_NE(load_error("kind: box\nbox: {count: 3, edge_m: 3, max_speed_mps: 0.1}\n")
                .find("min_speed_mps"),
            std::string::npos);
  EXPECT_NE(load_error("kind: box\nbox: {count: 3, edge_m: 3}\ngroups: []\n").find("groups"),
            std::string::npos);
}

}  // namespace
}  // namespace throng::box_scene_test
