// Study files: the runs that they describe, and the lines that errors name.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>

#include "analysis/studies/study_plan.h"
#include "analysis/studies/study_run.h"
#include "base/errors.h"

namespace throng::study_file_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kScene = R"(name: square
ground: {min_m: [-10, -10], max_m: [10, 10]}
groups:
  - name: walkers
    count: 5
    spawn: {min_m: [-8, -8], max_m: [0, 0]}
    goals: [{min_m: [2, 2], max_m: [5, 5]}]
  - name: others
    count: 2
    spawn: {min_m: [-8, 2], max_m: [0, 8]}
    goals: [{min_m: [2, -5], max_m: [5, -2]}]
)";

class StudyFile : public testing::Test {
 protected:
  StudyFile() {
    std::string pattern = (std::filesystem::temp_directory_path() / "studyXXXXXX").string();
    folder_ = ::mkdtemp(pattern.data());
    write("square.yaml", kScene);
  }
  ~StudyFile() override { std::filesystem::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }
  StudyPlan plan(const std::string& text) const {
    write("study.yaml", text);
    return StudyPlan(read_study(folder_ / "study.yaml"));
  }
  std::string error(const std::string& text) const {
    try {
      plan(text);
    } catch (const InputError& rejected) {
      const std::string message = rejected.what();
      const std::string folder = folder_.string() + "/";
      return message.starts_with(folder) ? message.substr(folder.size()) : message;
    }
    return "none";
  }

  std::filesystem::path folder_;
};

TEST_F(StudyFile, ListsEveryCombination) {
  const StudyPlan plan = this->plan(R"(scenes: [square.yaml]
seeds: [7, 9]
seconds: 2
parameters:
  groups.walkers.count: [3, 4]
  avatars: {from: 10, to: 20, step: 5}
)");
  EXPECT_THAT(plan.columns(), ElementsAre("run", "runs", "study", "scene", "seed", "seconds",
                                          "groups.walkers.count", "avatars"));
  ASSERT_EQ(plan.runs(), 2u * 3 * 2);
  std::set<std::vector<std::string>> cells;
  for (size_t run = 0; run < plan.runs(); ++run) {
    const std::vector<std::string> row = plan.cells(run);
    cells.insert({row[4], row[6], row[7]});
    const PlannedRun planned = plan.planned(run);
    EXPECT_EQ(std::to_string(planned.scene.seed), row[4]);
    EXPECT_EQ(planned.scene.duration_s, 2);
    EXPECT_EQ(std::to_string(planned.scene.groups[0].count + planned.scene.groups[1].count),
              row[7]);
  }
  EXPECT_EQ(cells.size(), plan.runs()) << "every run is unique";
}

TEST_F(StudyFile, NotesEnlargedPlansOnce) {
  const StudyPlan plan = this->plan(R"(scenes: [square.yaml]
seeds: [1, 2]
parameters:
  avatars: [7, 400]
)");
  EXPECT_THAT(plan.notes(),
              ElementsAre(HasSubstr("400 people need more space: the plan of 'square' grew")));
  EXPECT_EQ(plan.planned(0).plan_growth, 1);
  EXPECT_GT(plan.planned(2).plan_growth, 1.2);
}

TEST_F(StudyFile, SelectsItemsByNumberNameOrStar) {
  const StudyPlan plan = this->plan(R"(scenes: [square.yaml]
parameters:
  groups.2.count: [6]
  groups.walkers.desired_speed_mps.mean: [1.1]
  groups.*.premovement_s: [3]
  culling.exact: [true]
)");
  const Scene scene = plan.planned(0).scene;
  EXPECT_EQ(scene.groups[1].count, 6);
  EXPECT_EQ(scene.groups[0].speed_mps->mean, 1.1);
  EXPECT_FALSE(scene.groups[1].speed_mps.has_value());
  EXPECT_EQ(scene.groups[0].premovement_s.mean, 3);
  EXPECT_EQ(scene.groups[1].premovement_s.mean, 3);
  EXPECT_TRUE(scene.exact);
  EXPECT_EQ(plan.cells(0)[4], "1") << "the seed of the scene";
}

TEST_F(StudyFile, DrawsOneValuePerStratumOfAHypercube) {
  const StudyPlan plan = this->plan(R"(scenes: [square.yaml]
parameters:
  latin_hypercube:
    samples: 8
    parameters:
      groups.1.desired_speed_mps.mean: {from: 1.0, to: 1.8}
      groups.1.count: {from: 1, to: 8, integer: true}
      steering: [heuristic, orca]
)");
  ASSERT_EQ(plan.runs(), 8u);
  std::set<int> strata, counts;
  int orca = 0;
  for (size_t run = 0; run < 8; ++run) {
    const Scene scene = plan.planned(run).scene;
    const double speed_mps = scene.groups[0].speed_mps->mean;
    EXPECT_TRUE(speed_mps >= 1 && speed_mps < 1.8) << speed_mps;
    strata.insert(static_cast<int>((speed_mps - 1) / 0.1));
    counts.insert(scene.groups[0].count);
    orca += scene.steering.model == SteeringKind::kOrca;
  }
  EXPECT_EQ(strata.size(), 8u);
  EXPECT_EQ(counts.size(), 8u);
  EXPECT_EQ(orca, 4);
}

TEST_F(StudyFile, ReportsTheLineOfAnError) {
  const std::string scene = "scenes: [square.yaml]\n";
  const std::pair<std::string, std::string> cases[] = {
      {"seeds: [1]\n", "study.yaml:1: expected the key 'scenes' in a study, found none"},
      {scene + "second: 2\n", "study.yaml:2: expected"},
      {"scenes: [sqare]\n", "study.yaml:1: expected a scene, found 'sqare'"},
      {scene + "log: a.lcmlog\n", "study.yaml:2: expected an option that shapes a result"},
      {scene + "budget_ms: 5\n", "study.yaml:2: expected a repeatable budget"},
      {scene + "seconds: -1\n", "study.yaml:2: expected a number of seconds above 0, found '-1'"},
      {scene + "seconds: '2'\n", "study.yaml:2: expected a number of seconds above 0, found"},
      {scene + "exact: yes\n", "study.yaml:2: expected true or false, found 'yes'"},
      {scene + "budget_tests: 5\nstrategy: two-pass\n",
       "study.yaml:3: expected 'pipeline' with a budget, found 'two-pass'"},
      {scene + "threads: 4\n", "study.yaml:2: expected threads on the command line"},
      {scene + "states_hz: 4\n", "study.yaml:2: expected an option that shapes a result"},
      {scene + "trace_hash: a\n", "study.yaml:2: expected an option that shapes a result"},
      {scene + "pair_search: gird\n",
       "study.yaml:2: expected one of grid, sweep, brute, found 'gird' (did you mean 'grid'?)"},
      {scene + "seeds: 5\n", "study.yaml:2: expected a list of values of 'seeds'"},
      {scene + "seeds: [-5]\n", "study.yaml:2: expected a whole number from 0"},
      {scene + "parameters:\n  avatars: [5, many]\n",
       "study.yaml:3: expected a whole number from 1"},
      {scene + "parameters:\n  seed: [5]\n", "study.yaml:3: expected 'seeds: [1, 2, 3]'"},
      {scene + "seconds: 1\nparameters:\n  seconds: [2]\n",
       "study.yaml:4: expected every parameter once, found 'seconds' again"},
      {scene + "parameters:\n  avatars: [5, 5]\n", "study.yaml:3: expected each value"},
      {scene + "parameters:\n  avatars: {from: 9, to: 5, step: 1}\n",
       "study.yaml:3: expected a range"},
      {scene + "parameters:\n  groups.9.count: [5]\n",
       "study.yaml:3: expected in 'groups.9.count' the number of an item, 1 to 2, '*' for all, or "
       "one of walkers, others, found '9'"},
      {scene + "parameters:\n  step_s: [0.01]\n  groups.walkers.cuont: [5]\n",
       "study.yaml:4: expected a value of 'groups.walkers.cuont' that square.yaml takes, found "
       "'5'"},
      {scene + "parameters:\n  groups.walkers.count: [5, -3]\n",
       "study.yaml:3: expected a value of 'groups.walkers.count' that square.yaml takes, found "
       "'-3'"},
      {scene + "parameters:\n  name.first: [a]\n", "study.yaml:3: expected a map or a list"},
      {scene + "parameters:\n  latin_hypercube: {samples: 3, parameters: {}}\n",
       "study.yaml:3: expected at least one parameter, found none"},
      {scene + "parameters:\n  latin_hypercube: {parameters: {avatars: {from: 1, to: 9}}}\n",
       "study.yaml:3: expected the key 'samples'"},
      {scene + "parameters:\n  avatars: {from: 0, to: 1000000000, step: 0.001}\n",
       "study.yaml:3: expected at most 100000 values"},
  };
  for (const auto& [text, expected] : cases) EXPECT_THAT(error(text), HasSubstr(expected)) << text;
}

TEST_F(StudyFile, ReadsPartVolumesAsTheCommandLine) {
  const std::string volumes = "hands: sphere, default: obb";
  const StudyPlan planned =
      plan("scenes: [square.yaml]\npart_volume: '" + volumes + "'\nseconds: 1/2\n");
  EXPECT_EQ(to_text(planned.planned(0).scene.part_volume), volumes);
  EXPECT_EQ(planned.planned(0).scene.duration_s, 0.5);
}

TEST_F(StudyFile, HasAnIdentityIndependentOfItsWording) {
  const std::string text = "scenes: [square.yaml]\nseconds: 1\nparameters:\n  avatars: [5, 6]\n";
  const uint64_t identity = plan(text).identity();
  EXPECT_EQ(plan("# the same\n" + text).identity(), identity);
  EXPECT_NE(plan("seeds: [1]\n" + text).identity(), identity);
  EXPECT_NE(plan(text + "  planted_feet: [true]\n").identity(), identity);
  write("square.yaml", std::string(kScene) + "step_s: 0.05\n");
  EXPECT_NE(plan(text).identity(), identity) << "a different scene of the same name";
}

TEST(StudyMeasures, AreDocumented) {
  std::ifstream in(std::filesystem::path(THRONG_SOURCE_DIR) / "docs/reference/study-columns.md");
  const std::string text(std::istreambuf_iterator<char>(in), {});
  for (const auto& columns : {study_measures(), study_times()})
    for (const StudyMeasure& column : columns) {
      EXPECT_FALSE(column.meaning.empty()) << column.name;
      EXPECT_THAT(text, HasSubstr("| `" + column.name + "` | "));
      EXPECT_THAT(text, HasSubstr(" | " + column.meaning + " |\n"));
    }
  for (const std::string& option : study_option_names())
    EXPECT_THAT(text, HasSubstr("`" + option + "`"));
}

TEST(StudyMeasures, HaveUniqueNames) {
  std::set<std::string> names = {"run", "runs", "study", "scene", "seed"};
  for (const std::string& option : study_option_names()) names.insert(option);
  for (const StudyMeasure& measure : study_measures())
    EXPECT_TRUE(names.insert(measure.name).second) << measure.name;
}

}  // namespace
}  // namespace throng::study_file_test
