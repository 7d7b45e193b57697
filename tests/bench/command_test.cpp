// Tests `throng bench` as a user runs it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "bench/engines/engine.h"
#include "tests/apps/cli.h"

namespace throng::command_test {
namespace {

using testing::HasSubstr;

/// Output and JSON of `throng bench`; a failed command fails the test.
struct BenchOutput {
  std::string out;
  nlohmann::json json;
};
BenchOutput run_bench(const std::string& options, const ScratchFolder& folder) {
  const Outcome run = shell("throng bench " + options + " --json bench.json", folder);
  EXPECT_EQ(run.exit_code, 0) << options << ": " << run.out << run.err;
  if (run.exit_code != 0) return {};
  return {run.out, nlohmann::json::parse(read_file(folder / "bench.json"))};
}

TEST(BenchCommand, MeasuresThrongWithoutEngines) {
  const ScratchFolder folder;
  auto [out, json] = run_bench("--avatars 100 --density 4 --frames 2 --engines none", folder);
  EXPECT_THAT(out, HasSubstr("throng ordop26"));
  EXPECT_GT(json["throng"]["ms"].get<double>(), 0);
  EXPECT_GT(json["throng"]["pairs"].get<int>(), 0);
  EXPECT_TRUE(json["throng"]["simd"].is_string());
  EXPECT_TRUE(json["engines"].empty());
  EXPECT_EQ(json["skipped"].size(), bench::engine_kinds().size());
  EXPECT_TRUE(json["ratio_fastest"].is_null());
  EXPECT_TRUE(json["ratio_fcl"].is_null());
  EXPECT_GT(json["peak_rss_bytes"].get<uint64_t>(), 1'000'000u);
}

TEST(BenchCommand, ReportsTheLoadByQuarters) {
  const ScratchFolder folder;
  auto [out, json] = run_bench("--avatars 400 --density 4 --frames 10 --engines none", folder);
  EXPECT_THAT(out, HasSubstr("frames 1 to 2 "));
  EXPECT_THAT(out, HasSubstr("frames 8 to 10 "));
  ASSERT_EQ(json["quarters"].size(), 4u);
  EXPECT_EQ(json["quarters"][3]["last_frame"], 10);
  EXPECT_EQ(json["quarters"][3]["pairs"], json["throng"]["pairs"]);
  EXPECT_LT(json["quarters"][0]["pairs"], json["quarters"][3]["pairs"]);
}

TEST(BenchCommand, RunsThePlazaAtItsOwnDensity) {
  const ScratchFolder folder;
  auto [out, json] = run_bench("--crowd plaza --avatars 200 --frames 3 --engines none", folder);
  EXPECT_THAT(out, HasSubstr("plaza: 200 avatars"));
  EXPECT_EQ(json["crowd"], "plaza");
  EXPECT_GT(json["density_per_m2"].get<double>(), 0.05);
  EXPECT_LT(json["density_per_m2"].get<double>(), 2);
  EXPECT_EQ(shell("throng bench --crowd plaza --density 2 --engines none", folder).exit_code, 2);
}

TEST(BenchCommand, ComparesOrSkipsEveryEngine) {
  const ScratchFolder folder;
  auto [out, json] = run_bench("--avatars 60 --density 4 --frames 2", folder);
  for (const bench::EngineKind& kind : bench::engine_kinds()) {
    const auto& rows = kind.make != nullptr ? json["engines"] : json["skipped"];
    bool is_listed = false;
    for (const auto& row : rows) {
      if (row["name"] != std::string(kind.name)) continue;
      is_listed = true;
      if (kind.make != nullptr) {
        EXPECT_TRUE(row["agrees"].get<bool>()) << kind.name;
        EXPECT_GT(row["ms"].get<double>(), 0) << kind.name;
        EXPECT_GT(row["pairs"].get<int>(), 0) << kind.name;
        EXPECT_FALSE(row["version"].get<std::string>().empty()) << kind.name;
        EXPECT_THAT(row["what"].get<std::string>(), HasSubstr("boxes only"));
      } else {
        EXPECT_EQ(row["reason"].get<std::string>(), std::string(kind.missing));
      }
    }
    EXPECT_TRUE(is_listed) << kind.name << " is neither compared nor listed as skipped";
  }
}

TEST(BenchCommand, AppendsRowsToCsv) {
  const ScratchFolder folder;
  const std::string line = "throng bench --avatars 50 --frames 1 --engines none --csv b.csv";
  ASSERT_EQ(shell(line + "\n" + line, folder).exit_code, 0);
  const std::string csv = read_file(folder / "b.csv");
  EXPECT_EQ(line_count(csv), 1 + 2 * 2) << csv;
  EXPECT_TRUE(csv.starts_with("avatars,per_m2,threads,")) << csv;
}

TEST(BenchCommand, CountsEqualWorkForAgedAndFresh) {
  const ScratchFolder folder;
  auto [out, json] = run_bench("--avatars 100 --frames 2 --engines none --age 30", folder);
  EXPECT_EQ(json["walked_frames"], 30);
  EXPECT_GT(json["throng"]["aged_work"].get<uint64_t>(), 0u);
  EXPECT_EQ(json["throng"]["aged_work"], json["throng"]["fresh_work"]);
}

TEST(BenchCommand, PrintsTheFalsePositiveMatrix) {
  const ScratchFolder folder;
  auto [out, json] = run_bench("--avatars 40 --density 4 --frames 1 --false-positives obb", folder);
  EXPECT_THAT(out, HasSubstr("obb, part by part"));
  EXPECT_EQ(json["matrix"].size(), 15u * 16 / 2);
  EXPECT_EQ(json["volumes"]["ordop26"]["missed"], 0);
}

TEST(BenchCommand, TimesSteeringModelsNextToRvo2) {
  const ScratchFolder folder;
  auto [out, json] = run_bench("--steering --avatars 1000 --frames 2", folder);
  EXPECT_THAT(out, HasSubstr("RVO2 did not run here"));
  ASSERT_EQ(json["steering"].size(), 3u);
  EXPECT_EQ(json["steering"][0]["model"], "orca");
  EXPECT_EQ(json["steering"][1]["model"], "collision_free_speed");
  EXPECT_EQ(json["steering"][2]["model"], "heuristic");
  for (const auto& row : json["steering"]) {
    EXPECT_EQ(row["people"], 1000);
    EXPECT_GT(row["ms"].get<double>(), 0);
    EXPECT_GE(row["sweeps"].get<double>(), 1);
    EXPECT_GT(row["frame_ms"].get<double>(), 0);
    EXPECT_EQ(row["rvo2_ms"], 1.08);
  }
  // The reference time is known for one core and certain numbers of people only.
  for (const char* others : {"--avatars 50", "--avatars 1000 --threads 2"}) {
    const Outcome other =
        shell(std::string("throng bench --steering --frames 1 --json s.json ") + others, folder);
    ASSERT_EQ(other.exit_code, 0) << other.err;
    EXPECT_TRUE(
        nlohmann::json::parse(read_file(folder / "s.json"))["steering"][0]["rvo2_ms"].is_null());
  }
}

TEST(BenchCommand, AcceptsACustomModel) {
  const ScratchFolder folder;
  const std::string robot =
      repository("tests/kinematics/fixtures/humanoid_description/urdf/humanoid.urdf");
  auto [out, json] =
      run_bench("--avatars 60 --density 4 --frames 2 --engines none --model " + robot, folder);
  EXPECT_THAT(out, HasSubstr("humanoid.urdf: 60 avatars"));
  EXPECT_GT(json["throng"]["pairs"].get<int>(), 0);
  auto [parts, matrix] = run_bench(
      "--avatars 30 --density 4 --frames 1 --false-positives ordop26 --model " + robot, folder);
  EXPECT_EQ(matrix["matrix"].size(), 19u * 20 / 2);
  for (const auto& volume : matrix["volumes"]) EXPECT_EQ(volume["missed"], 0);
  const std::string one = repository("tests/kinematics/fixtures/single.urdf");
  EXPECT_GT(run_bench("--avatars 60 --density 4 --frames 2 --engines none --model " + one, folder)
                .json["throng"]["pairs"]
                .get<int>(),
            0);
  const Outcome missing = shell("throng bench --model none.urdf --engines none", folder);
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_EQ(line_count(missing.err), 1);
  EXPECT_EQ(shell("throng bench --crowd plaza --model " + one, folder).exit_code, 2);
}

/// Runs the example's engine on exported frames and then falsifies its result in several ways.
TEST(BenchCommand, ChecksPairsOfAnotherProgram) {
  const ScratchFolder folder;
  const Outcome exported =
      shell("throng bench --export f --avatars 80 --density 4 --frames 2", folder);
  ASSERT_EQ(exported.exit_code, 0) << exported.err;
  EXPECT_THAT(exported.out, HasSubstr("f: 2 frames of 80 people with 15 parts"));
  const std::string pairs = read_file(folder / "f/pairs.csv");
  const std::string touching = read_file(folder / "f/touching.csv");
  EXPECT_EQ(line_count(read_file(folder / "f/boxes.csv")), 1 + 2 * 80 * 15);
  EXPECT_EQ(line_count(read_file(folder / "f/poses.csv")), 1 + 2 * 80 * 15);
  EXPECT_EQ(line_count(read_file(folder / "f/parts.csv")), 1 + 15);
  EXPECT_GT(line_count(touching), 10);
  EXPECT_GT(line_count(pairs), line_count(touching));
  EXPECT_EQ(read_file(folder / "f/README.txt").substr(0, 33), "Frames of 80 people with 15 parts");

  ASSERT_EQ(shell("custom_engine f", folder).exit_code, 0);
  const Outcome agreed = shell("throng bench --check f/found.csv", folder);
  EXPECT_EQ(agreed.exit_code, 0) << agreed.out;
  EXPECT_THAT(agreed.out, HasSubstr("0 missing, 0 unexpected\nthey agree"));

  const auto checked = [&](const std::string& text) {
    std::ofstream(folder / "f/altered.csv") << text;
    return shell("throng bench --check f/altered.csv", folder);
  };
  const size_t second = pairs.find('\n', pairs.find('\n') + 1) + 1;
  const std::string header = "frame,a,b\n",
                    first = pairs.substr(header.size(), second - header.size());
  const Outcome incomplete = checked(header + pairs.substr(second));
  EXPECT_EQ(incomplete.exit_code, 1);
  EXPECT_THAT(incomplete.out, HasSubstr("1 missing, 0 unexpected\nfirst missing: frame 0, "));
  const Outcome twice = checked(pairs + first);
  EXPECT_EQ(twice.exit_code, 1);
  EXPECT_THAT(twice.out, HasSubstr("0 missing, 0 unexpected, 1 twice\nfirst twice: frame 0, "));
  const Outcome beyond = checked(pairs + "1,0,1\n");
  EXPECT_EQ(beyond.exit_code, 1);
  EXPECT_THAT(beyond.out, HasSubstr("first unexpected: frame 1, 0 (pelvis of 0) and 1 ("));

  // Boxes of parts may overlap without contact; a touching pair must not be missing.
  std::string parts = pairs;
  parts.replace(0, header.size(), "frame,part_a,part_b\n");
  EXPECT_EQ(checked(parts).exit_code, 0);
  const size_t last = touching.rfind('\n', touching.size() - 2) + 1;
  const Outcome missed = checked(touching.substr(0, last));
  EXPECT_EQ(missed.exit_code, 1);
  EXPECT_THAT(missed.out, HasSubstr("1 of these missing"));

  for (const auto& [text, expected] : std::map<std::string, std::string>{
           {"a,b\n", "f/altered.csv:1: expected frame,a,b or frame,part_a,part_b, found 'a,b'"},
           {header + "0,1\n", "f/altered.csv:2: expected three whole numbers, FRAME,A,B"},
           {header + "0,1,-2\n", "f/altered.csv:2: expected three whole numbers"},
           {header + "0,1,2,3\n", "f/altered.csv:2: expected three whole numbers"}}) {
    const Outcome rejected = checked(text);
    EXPECT_EQ(rejected.exit_code, 2) << text;
    EXPECT_THAT(rejected.err, HasSubstr(expected));
    EXPECT_EQ(line_count(rejected.err), 1);
  }
  std::ofstream(folder / "alone.csv") << header;
  EXPECT_EQ(shell("throng bench --check alone.csv", folder).exit_code, 2);
  EXPECT_EQ(shell("throng bench --check none.csv", folder).exit_code, 2);
}

TEST(BenchCommand, RejectsInvalidOptions) {
  const ScratchFolder folder;
  for (const char* options :
       {"--engines fcll", "--simd mmx", "--false-positives cube", "--avatars 1", "--density 0",
        "--age 0", "--engines fcl,", "--steering --age 3", "--steering --crowd plaza",
        "--steering --csv a.csv", "--steering --engines fcl", "--steering --pair-search grid"}) {
    const Outcome run = shell(std::string("throng bench ") + options, folder);
    EXPECT_EQ(run.exit_code, 2) << options << ": " << run.err;
    EXPECT_EQ(line_count(run.err), 1) << options << ": " << run.err;
  }
  EXPECT_THAT(shell("throng bench --engines fcll", folder).err, HasSubstr("did you mean 'fcl'"));
}

}  // namespace
}  // namespace throng::command_test
