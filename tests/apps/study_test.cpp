// `throng study`: the same table for any number of processes and interruptions.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "tests/apps/cli.h"

namespace throng::study_test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr const char* kStudy = R"(scenes: [corridor, bottleneck]
seeds: [1, 2]
seconds: 0.3
parameters:
  avatars: [20, 30, 40]
)";

bool has(const char* program) {
  return std::system((std::string("command -v ") + program + " >/dev/null 2>&1").c_str()) == 0;
}

class Study : public testing::Test {
 protected:
  Study() { write_file(folder_ / "study.yaml", kStudy); }

  Outcome run(const std::string& line) const { return shell(line, folder_); }
  /// The table of one worker without interruption.
  std::string whole(const std::string& ending) const {
    const Outcome outcome = run("throng study study.yaml --threads 1 --out whole" + ending);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return read_file(folder_ / ("whole" + ending));
  }

  ScratchFolder folder_;
};

TEST_F(Study, KnowsEveryRunOptionThatIsNoSceneKey) {
  const std::string help = run("throng run --help").out;
  const std::regex option("\n +(?:-\\w,)?--([a-z-]+)");
  std::vector<std::string> unknown;
  for (std::sregex_iterator at(help.begin(), help.end(), option), end; at != end; ++at) {
    std::string name = (*at)[1];
    std::replace(name.begin(), name.end(), '-', '_');
    write_file(folder_ / "study.yaml", "scenes: [corridor]\n" + name + ": '?'\n");
    const Outcome outcome = run("throng study study.yaml --out table.csv");
    EXPECT_EQ(outcome.exit_code, 2) << name;
    if (outcome.err.find("expected a key of a study") != std::string::npos) unknown.push_back(name);
  }
  EXPECT_THAT(unknown, testing::ElementsAre("help", "proximity", "closest_parts", "contact_points",
                                            "filter_groups", "filter_parts", "fps", "unit",
                                            "heading_unit", "columns", "separator", "tracked_point",
                                            "strict", "sampling", "separation"));
}

TEST_F(Study, WritesARowPerRunWithoutTimes) {
  const std::string table = whole(".csv");
  EXPECT_EQ(line_count(table), 1 + 2 * 2 * 3);
  EXPECT_THAT(table, StartsWith("run,runs,study,scene,seed,seconds,avatars,simulated_s,people,"));
  EXPECT_THAT(table, HasSubstr("\n12,12,"));
  EXPECT_THAT(table, HasSubstr(",bottleneck,2,0.3,40,0.3,40,"));
  EXPECT_THAT(read_file(folder_ / "whole.csv.times.csv"),
              StartsWith("run,runs,study,setup_s,wall_s"));
  EXPECT_EQ(table.find("wall_s"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "whole.csv.journal"));
}

TEST_F(Study, PrintsTheColumnsOfItsTables) {
  const auto first_words = [](const std::string& lines) {
    std::string words;
    std::istringstream in(lines);
    for (std::string line; std::getline(in, line);)
      words += (words.empty() ? "" : ",") + line.substr(0, line.find(' '));
    return words;
  };
  const Outcome columns = run("throng study --columns");
  EXPECT_EQ(columns.exit_code, 0) << columns.err;
  const size_t gap = columns.out.find("\n\n");
  ASSERT_NE(gap, std::string::npos);
  std::string table = first_words(columns.out.substr(0, gap));
  const std::string names = ",OPTION,PARAMETER,";
  ASSERT_NE(table.find(names), std::string::npos);
  table.replace(table.find(names), names.size(), ",seconds,avatars,");
  EXPECT_THAT(whole(".csv"), StartsWith(table + "\n"));
  EXPECT_THAT(read_file(folder_ / "whole.csv.times.csv"),
              StartsWith("run,runs,study," + first_words(columns.out.substr(gap + 2)) + "\n"));
}

TEST_F(Study, RunsWithTheGivenOptions) {
  const std::string table = whole(".csv");
  const Outcome alone =
      run("throng run bottleneck --seed 2 --seconds 0.3 --avatars 40 --log off --lcm off");
  const size_t at = alone.out.find("\nhash");
  ASSERT_NE(at, std::string::npos) << alone.err;
  const std::string hash = alone.out.substr(alone.out.find_first_not_of(' ', at + 5), 16);
  EXPECT_THAT(table, HasSubstr("," + hash + "\n"));
}

TEST_F(Study, WritesTheSameBytesWithTwoWorkersAndSevenShards) {
  for (const std::string ending : {".csv", ".sqlite"}) {
    const std::string expected = whole(ending);
    EXPECT_EQ(run("throng study study.yaml --threads 2 --out two" + ending).exit_code, 0);
    EXPECT_EQ(read_file(folder_ / ("two" + ending)), expected) << ending;
    const Outcome parts = run(fmt::format(
        "for i in 5 3 1 7 2 4 6; do throng study study.yaml --shard $i/7 --out part$i{0}"
        " || exit 9; done; throng study --merge part?{0} --out joined{0}",
        ending));
    EXPECT_EQ(parts.exit_code, 0) << parts.err;
    EXPECT_EQ(read_file(folder_ / ("joined" + ending)), expected) << ending;
  }
}

/// Starts the study until it is done; `signal` ends it after each finished run. Prints the number
/// of interruptions.
std::string ended_after_each_run(const std::string& signal, const std::string& max_count) {
  return "set +e; lines() { wc -l < t.csv.journal 2>/dev/null || echo 0; }; n=0; "
         "while [ $n -lt " +
         max_count +
         " ]; do "
         "  before=$(lines); [ $before -gt 1 ] || before=1; "
         "  throng study study.yaml --threads 2 --out t.csv & p=$!; "
         "  while kill -0 $p 2>/dev/null && [ $(lines) -le $before ]; do sleep 0.01; done; "
         "  kill -" +
         signal +
         " $p 2>/dev/null; wait $p; code=$?; "
         "  [ $code = 0 ] && break; n=$((n+1)); done 2>>err; echo $n $code";
}

TEST_F(Study, ResumesAfterRepeatedKills) {
  // A run takes ten times as long as the shell needs to see that another one is done.
  run("sed -i 's/seconds: 0.3/seconds: 4/' study.yaml");
  const std::string expected = whole(".csv");
  const Outcome outcome = run(ended_after_each_run("KILL", "30"));
  EXPECT_THAT(outcome.out, testing::EndsWith(" 0\n")) << read_file(folder_ / "err");
  EXPECT_GT(std::atoi(outcome.out.c_str()), 2) << "too few kills";
  EXPECT_EQ(read_file(folder_ / "t.csv"), expected);
}

TEST_F(Study, PrintsHowToResumeWhenStopped) {
  run("sed -i 's/seconds: 0.3/seconds: 120/' study.yaml");
  const Outcome stopped = run(ended_after_each_run("INT", "1"));
  EXPECT_EQ(stopped.out, "1 130\n");
  EXPECT_THAT(read_file(folder_ / "err"), HasSubstr("stopped by SIGINT: "));
  EXPECT_THAT(read_file(folder_ / "err"),
              HasSubstr(" of 12 runs are done; repeat the command to resume"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "t.csv.journal"));
  const Outcome other =
      run("sed -i 's/seconds: 120/seconds: 1/' study.yaml; throng study study.yaml --out t.csv");
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.err, HasSubstr("t.csv.journal: expected a journal of this study"));
  EXPECT_THAT(other.err, HasSubstr("remove it to start again"));
}

TEST_F(Study, RejectsBadInputBeforeWriting) {
  const std::pair<const char*, const char*> cases[] = {
      {"throng study none.yaml --out t.csv", "none.yaml: expected a file, found nothing there"},
      {"throng study study.yaml --out t.txt",
       "--out: expected a table that ends in .csv or .sqlite"},
      {"throng study study.yaml --out t.csv --shard 8/7",
       "--shard: expected I/N with I from 1 to N"},
      {"throng study study.yaml --out t.csv --shard x", "--shard: expected I/N"},
      {"throng study --out t.csv", "expected a study file, or --merge"},
      {"throng study --merge study.yaml --out t.csv", "study.yaml"},
      {"throng study study.yaml --out study.yaml", "--out: expected a table"},
      {"echo 'second: 1' >> study.yaml; throng study study.yaml --out t.csv",
       "study.yaml:6: expected"},
  };
  for (const auto& [line, expected] : cases) {
    const Outcome outcome = run(line);
    EXPECT_EQ(outcome.exit_code, 2) << line;
    EXPECT_THAT(outcome.err, HasSubstr(expected)) << line;
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "t.csv"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "t.csv.journal"));
}

TEST_F(Study, PlotsEachMeasureAgainstEachParameter) {
  if (!has("gnuplot")) GTEST_SKIP() << "no gnuplot";
  const Outcome outcome = run("throng study study.yaml --out t.csv --plot");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(read_file(folder_ / "t.csv.plots/mean_speed_mps_by_avatars.svg"),
              HasSubstr("</svg>"));
}

/// Suppresses leak reports for memory that MPI does not free.
const std::string kMpi =
    "export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 "
    "ASAN_OPTIONS=\"${ASAN_OPTIONS-}:detect_leaks=0\"; ";

TEST_F(Study, WritesTheSameBytesWithMpi) {
  if (!has("mpirun")) GTEST_SKIP() << "no mpirun";
  const Outcome outcome =
      run(kMpi + "mpirun --oversubscribe -n 3 throng study study.yaml --out ranks.csv");
  if (outcome.err.find("built without MPI") != std::string::npos)
    GTEST_SKIP() << "this throng was built without MPI";
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(read_file(folder_ / "ranks.csv"), whole(".csv"));
}

TEST_F(Study, ReportsAnErrorOnceWithMpi) {
  if (!has("mpirun")) GTEST_SKIP() << "no mpirun";
  const Outcome outcome =
      run(kMpi +
          "echo 'second: 1' >> study.yaml; "
          "mpirun --oversubscribe -n 3 throng study study.yaml --out ranks.csv");
  if (outcome.err.find("built without MPI") != std::string::npos)
    GTEST_SKIP() << "this throng was built without MPI";
  EXPECT_NE(outcome.exit_code, 0);
  const size_t first = outcome.err.find("study.yaml:6: expected");
  ASSERT_NE(first, std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.err.find("study.yaml:6: expected", first + 1), std::string::npos);
}

TEST_F(Study, RunsInShardsOfGnuParallel) {
  if (!has("parallel")) GTEST_SKIP() << "no GNU parallel";
  const Outcome outcome =
      run("parallel -j 2 throng study study.yaml --threads 1 --shard {}/3 --out part{}.csv ::: 1 2 "
          "3 && "
          "throng study --merge part?.csv --out joined.csv");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(read_file(folder_ / "joined.csv"), whole(".csv"));
}

TEST_F(Study, RunsInASlurmArray) {
  // Runs the script as Slurm does; sbatch itself needs a cluster.
  const Outcome outcome =
      run("for i in 1 2 3; do STUDY=study.yaml SLURM_ARRAY_TASK_ID=$i SLURM_ARRAY_TASK_COUNT=3 "
          "SLURM_CPUS_PER_TASK=1 sh " +
          repository("examples/studies/slurm.sh") +
          " || exit 9; done; "
          "throng study --merge part_*.csv --out joined.csv");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(read_file(folder_ / "joined.csv"), whole(".csv"));
}

TEST_F(Study, ReadsTheExamples) {
  for (const std::string name : {"speeds", "doors"}) {
    const Outcome outcome = run("throng study " + repository("examples/studies/" + name + ".yaml") +
                                " --shard 1000/1000 --out t.csv");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    std::filesystem::remove(folder_ / "t.csv");
  }
}

}  // namespace
}  // namespace throng::study_test
