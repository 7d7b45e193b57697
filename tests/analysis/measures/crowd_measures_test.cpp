// All measures of whole runs: positions of heads, independence of threads, agreement with the
// validation, and comparisons of two runs.
#include "analysis/measures/crowd_measures.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "analysis/measures/comparison.h"
#include "analysis/measures/recent_crowd.h"
#include "analysis/measures/speed_and_spacing.h"
#include "analysis/validation/trial.h"
#include "scenes/run/runner.h"
#include "tests/crowd/crowd_world.h"

namespace throng::crowd_measures_test {
namespace {

MeasuredRun measured(Scene scene, int threads, bool culling = true) {
  Simulation simulation(std::move(scene), {.threads = threads, .culling = culling});
  CrowdMeasures measures;
  Sink* const sink = &measures;
  run(simulation, {&sink, 1});
  return {simulation.scene().name, measures.facts(), measures.tables()};
}

Scene short_scene(const std::string& name, double seconds) {
  Scene scene = load_scene(name);
  scene.exact = true;
  scene.duration_s = seconds;
  return scene;
}

TEST(Heads, AreTheCentresOfPosedHeadParts) {
  Simulation simulation(short_scene("plaza", 1), {.threads = 1, .culling = false});
  Heads heads(simulation.info());
  const RunInfo& info = simulation.info();
  std::vector<Eigen::Vector2d> found(info.model_of_avatar.size());
  for (int step = 0; step < 20; ++step) simulation.step();
  const Frame& frame = simulation.step();
  heads.find(info, frame, found);
  double farthest_off_m = 0;
  for (size_t id = 0; id < found.size(); ++id) {
    const Model& model = *info.models[info.model_of_avatar[id]];
    const RootFrame root{frame.roots[id].world_from_root, info.scale_of_avatar[id]};
    std::vector<PartPose> poses(model.parts.size());
    forward_kinematics(model.kinematics,
                       frame.postures.subspan(frame.posture_offsets[id],
                                              static_cast<size_t>(model.kinematics.column_count())),
                       {&root, 1}, poses);
    for (size_t part = 0; part < model.parts.size(); ++part) {
      if (model.parts[part].name != "head") continue;
      Eigen::AlignedBox3d box;
      for (const Eigen::Vector3f& vertex : model.parts[part].mesh.vertices)
        box.extend((info.scale_of_avatar[id] * vertex).cast<double>());
      const Eigen::Vector3d expected =
          frame.roots[id].position_m + to_isometry(poses[part]) * box.center();
      EXPECT_LT((found[id] - expected.head<2>()).norm(), 1e-6) << "person " << id;
    }
    farthest_off_m =
        std::max(farthest_off_m, (found[id] - frame.roots[id].position_m.head<2>()).norm());
  }
  EXPECT_GT(farthest_off_m, 0.02);
  EXPECT_LT(farthest_off_m, 0.4);
}

TEST(CrowdMeasures, AreEqualForAnyNumberOfThreads) {
  const MeasuredRun one = measured(short_scene("corridor", 6), 1);
  const MeasuredRun two = measured(short_scene("corridor", 6), 2);
  ASSERT_EQ(one.tables.size(), two.tables.size());
  for (size_t i = 0; i < one.tables.size(); ++i) {
    ASSERT_EQ(one.tables[i].rows.size(), two.tables[i].rows.size()) << one.tables[i].id;
    EXPECT_FALSE(one.tables[i].rows.empty()) << one.tables[i].id;
    for (size_t k = 0; k < one.tables[i].rows.size(); ++k)
      EXPECT_EQ(one.tables[i].rows[k].value, two.tables[i].rows[k].value) << one.tables[i].id;
  }
  EXPECT_EQ(one.facts.people, 120u);
  EXPECT_NEAR(one.facts.seconds, 6, 0.02);
  EXPECT_NEAR(one.facts.sample_s, 0.1, 1e-9);
}

// People in rows in a corridor, as in the fundamental diagram of the validation. The validation
// averages density and speed over an area, the measure assigns a cell to each person.
TEST(CrowdMeasures, AgreeWithTheValidationOnSpeedAtADensity) {
  for (const auto& [rows, columns] : {std::pair(2, 35), {3, 45}, {4, 55}}) {
    validation::Plan plan("corridor", {{0, 0}, {60, 2}}, {SteeringKind::kOrca, true}, 1);
    plan.people_in_rows(rows, columns, {{0, 0}, {40, 2}}, {{{55, 0}, {60, 2}}});
    constexpr double kFirst_m = 18, kLast_m = 26, kEnd_s = 10;
    validation::Trial trial(plan);
    double samples_of_people = 0, speeds = 0;
    int samples = 0;
    while (trial.step(kEnd_s)) {
      ++samples;
      for (size_t id = 0; id < trial.size(); ++id) {
        const double x = trial.position_m(id).x();
        if (!trial.is_present(id) || x < kFirst_m || x >= kLast_m) continue;
        samples_of_people += 1;
        speeds += trial.velocity_mps(id).norm();
      }
    }
    const double density = samples_of_people / samples / (2 * (kLast_m - kFirst_m));
    const double speed = speeds / samples_of_people;

    Scene scene = plan.scene;
    scene.duration_s = kEnd_s;
    const MeasuredRun found = measured(std::move(scene), 1, false);
    const double bin = SpeedAndSpacing::kDensityBin_per_m2 *
                       std::floor(density / SpeedAndSpacing::kDensityBin_per_m2);
    const double simulated = found.tables[0].value(
        range_text(bin, bin + SpeedAndSpacing::kDensityBin_per_m2), "", "mean");
    EXPECT_NEAR(simulated, speed, 0.1 * speed + 0.02) << density << " per m2";
  }
}

TEST(Comparison, ShowsAllRowsOfBothRunsInOrder) {
  MeasureTable a{"speed_density", "Speed", "density", "people per m2", "", {}, {}};
  MeasureTable b = a;
  a.rows = {ranged_row(0, 1, "", "mean", "m/s", 1.5),
            ranged_row(2, 3, "", "mean", "m/s", 0.5),
            {"all", {}, {}, "", "mean", "m/s", 1.0}};
  b.rows = {ranged_row(1, 2, "", "mean", "m/s", 0.75),
            ranged_row(2, 3, "", "mean", "m/s", 0.25),
            ranged_row(3, {}, "", "mean", "m/s", 0.125),
            {"none", {}, {}, "", "mean", "m/s", 2.0}};
  a.rows.insert(a.rows.begin() + 2, ranged_row(7, {}, "", "mean", "m/s", 0.1));
  const std::vector<ComparedRow> rows = compared_rows(a, b);
  std::vector<std::string> places;
  for (const ComparedRow& row : rows) places.push_back(row.row.at);
  EXPECT_EQ(places, (std::vector<std::string>{"0 to 1", "1 to 2", "2 to 3", "above 3", "above 7",
                                              "none", "all"}));
  EXPECT_TRUE(std::isnan(rows[0].b));
  EXPECT_TRUE(std::isnan(rows[1].a));
  EXPECT_EQ(rows[2].a, 0.5);
  EXPECT_EQ(rows[2].b, 0.25);
  const std::string text = comparison_text({"one", {}, {a}}, {"other", {}, {b}});
  EXPECT_NE(text.find("-0.25"), std::string::npos) << text;
}

TEST(Comparison, ShowsNoDifferenceOfARunFromItself) {
  const MeasuredRun run = measured(short_scene("corridor", 6), 2);
  for (const MeasureTable& table : run.tables)
    for (const ComparedRow& row : compared_rows(table, table))
      EXPECT_TRUE(row.a == row.b || (std::isnan(row.a) && std::isnan(row.b))) << table.id;
  std::set<std::string> ids;
  for (const Figure& figure : comparison_figures(run, run)) {
    EXPECT_TRUE(ids.insert(figure.id).second) << figure.id;
    EXPECT_NE(figure.caption.find("A: corridor"), std::string::npos) << figure.id;
  }
  for (const char* id : {"speed_density", "spacing", "flow", "width_use", "sway_amplitude",
                         "accelerations", "contacts", "contacts_parts", "depth", "depth_parts"})
    EXPECT_TRUE(ids.contains(id)) << id;
}

TEST(Comparison, DrawsARunWithoutPeople) {
  if (!has_gnuplot()) GTEST_SKIP() << "no gnuplot";
  const MeasuredRun run = measured(short_scene("corridor", 6), 2);
  MeasuredRun cleared = run;
  cleared.name = "none";
  for (MeasureTable& table : cleared.tables) {
    table.rows.clear();
    for (MeasureCurve& curve : table.curves) curve.points.clear();
  }
  const MeasuredRun& nothing = cleared;
  const std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) / fmt::format("figures_{}", getpid());
  std::filesystem::create_directories(folder);
  for (const auto& [a, b] : {std::pair(&run, &nothing), std::pair(&nothing, &run)})
    for (const Figure& figure : comparison_figures(*a, *b))
      EXPECT_NO_THROW(draw(figure, folder)) << figure.id;
  std::filesystem::remove_all(folder);
  EXPECT_TRUE(comparison_figures(nothing, nothing).empty());
}

}  // namespace
}  // namespace throng::crowd_measures_test
