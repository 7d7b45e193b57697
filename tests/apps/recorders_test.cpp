// `throng run --trajectory`, `--contacts` and `--separation`: files for other programs, and full
// disks.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/apps/cli.h"

namespace throng::recorders_test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

TEST(TrajectoryFiles, AreWrittenInBothFormats) {
  const ScratchFolder folder;
  const Outcome outcome = shell(
      "throng run corridor --avatars 20 --seconds 1 --lcm off --log off --trajectory t.csv "
      "--trajectory t.sqlite --trajectory-fps 20",
      folder);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  // One header; 60 steps at 60 Hz are 20 recorded frames of 20 people.
  EXPECT_EQ(line_count(read_file(folder / "t.csv")), 1 + 20 * 20);
  EXPECT_THAT(read_file(folder / "t.sqlite"), StartsWith("SQLite format 3"));
}

TEST(TrajectoryFiles, DoNotChangeEvents) {
  const ScratchFolder folder;
  const std::string run = "throng run corridor --seconds 1 --lcm off --log off";
  const auto hash = [&](const std::string& options) {
    const Outcome outcome = shell(run + options + " | grep hash", folder);
    EXPECT_THAT(outcome.out, StartsWith("hash"));
    return outcome.out;
  };
  EXPECT_EQ(hash(""), hash(" --trajectory t.sqlite"));
}

TEST(TrajectoryFiles, RejectOtherEndings) {
  const ScratchFolder folder;
  const Outcome outcome = shell("throng run corridor --trajectory t.txt", folder);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr(".sqlite or .csv, found 't.txt'"));
}

TEST(TrajectoryFiles, RequireAChoiceForADividedArea) {
  const ScratchFolder folder;
  const std::string run = "throng run ring --seconds 0.1 --lcm off --log off --trajectory ";
  const Outcome outcome = shell(run + "t.sqlite", folder);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(line_count(outcome.err), 1) << outcome.err;
  EXPECT_THAT(outcome.err, StartsWith("--trajectory-area: expected "));
  EXPECT_FALSE(std::filesystem::exists(folder / "t.sqlite"));
  EXPECT_EQ(shell(run + "t.csv", folder).exit_code, 0) << "holds no area";
  for (const char* piece : {"largest", "1", "2"})
    EXPECT_EQ(shell(run + "t.sqlite --trajectory-area " + piece, folder).exit_code, 0) << piece;
  for (const char* piece : {"0", "3", "all", "-1"}) {
    const Outcome rejected = shell(run + "t.sqlite --trajectory-area=" + piece, folder);
    EXPECT_EQ(rejected.exit_code, 2) << piece;
    EXPECT_EQ(line_count(rejected.err), 1) << rejected.err;
  }
}

TEST(ContactFiles, AgreeWithTheRun) {
  const ScratchFolder folder;
  const Outcome outcome = shell(
      "throng run corridor --seconds 10 --lcm off --log off --contacts c --json r.json", folder);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto contacts = nlohmann::json::parse(read_file(folder / "r.json"))["contacts"];
  EXPECT_GT(contacts["people"], 0);
  EXPECT_EQ(line_count(read_file(folder / "c/contacts.csv")), 1 + contacts["people"].get<int>());
  EXPECT_EQ(line_count(read_file(folder / "c/people.csv")), 1 + 120);
  EXPECT_EQ(line_count(read_file(folder / "c/parts.csv")), 1 + 15);
  EXPECT_EQ(line_count(read_file(folder / "c/density.csv")), 1 + 6);
  // Every pair of parts that began to touch has a row.
  const Outcome parts = shell("awk -F, 'NR>1 {n+=$10} END {print n}' c/contacts.csv", folder);
  EXPECT_EQ(line_count(read_file(folder / "c/part_contacts.csv")), 1 + std::stoi(parts.out));
  EXPECT_EQ(
      shell("tail -n +2 c/part_contacts.csv | LC_ALL=C sort -s -c -t, -k1,1n -k3,3n -k5,5n", folder)
          .exit_code,
      0);
  for (const char* figure :
       {"contact_rates", "contact_durations", "contact_parts", "contact_density"})
    EXPECT_THAT(read_file(folder / ("c/" + std::string(figure) + ".svg")), HasSubstr("</svg>"));
}

/// Read by networkx if it is installed, otherwise by an XML parser.
TEST(ContactFiles, AreReadableGraphs) {
  const ScratchFolder folder;
  const Outcome run = shell(
      "throng run corridor --seconds 4 --closest-parts 1 --lcm off --log off --contacts c", folder);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("no seconds below 2 m because closest_parts_m is 1 m\n"));
  write_file(folder / "read.py", R"(
import sys
def edges(file):
    try:
        import networkx
        graph = networkx.read_graphml(file)
        assert all(graph.nodes[n]["group"] for n in graph)
        return graph.number_of_nodes(), [(a, b, d) for a, b, d in graph.edges(data=True)]
    except ImportError:
        import xml.etree.ElementTree as tree
        ns = "{http://graphml.graphdrawing.org/xmlns}"
        root = tree.parse(file).getroot()
        names = {k.get("id"): (k.get("attr.name"), k.get("attr.type")) for k in root.iter(ns + "key")}
        types = {"int": int, "double": float, "string": str}
        graph = [(e.get("source"), e.get("target"),
                  {names[d.get("key")][0]: types[names[d.get("key")][1]](d.text) for d in e})
                 for e in root.iter(ns + "edge")]
        return len(list(root.iter(ns + "node"))), graph
nodes, graph = edges("c/touching.graphml")
assert nodes == 120, nodes
contacts = sum(1 for line in open("c/contacts.csv")) - 1
assert sum(d["contacts"] for a, b, d in graph) == contacts > 0
for a, b, d in graph:
    spells = [tuple(map(float, s.split())) for s in d["spells"].split("; ")]
    assert len(spells) == d["contacts"] and abs(sum(e - f for f, e in spells) - d["seconds"]) < 1e-3
tij = {tuple(map(int, line.split())) for line in open("c/touching.tij")}
assert {(i, j) for t, i, j in tij} == {tuple(sorted((int(a), int(b)))) for a, b, d in graph}
nodes, close = edges("c/proximity.graphml")
assert len(close) == sum(1 for line in open("c/exposure.csv")) - 1 > 0
assert {"below_0.5_m_s", "below_1_m_s"} == set(close[0][2])
)");
  const Outcome read = shell("python3 read.py", folder);
  EXPECT_EQ(read.exit_code, 0) << read.err;
}

TEST(ContactFiles, HaveNoRowsForAnEmptyScene) {
  const ScratchFolder folder;
  write_file(folder / "later.yaml", R"(
name: later
duration_s: 1
ground: {min_m: [-10, -10], max_m: [10, 10]}
groups:
  - name: them
    count: 0
    sources: [{area: {min_m: [-5, -5], max_m: [-2, -2]}, count: 5, rate_per_s: 1, start_s: 50}]
    goals: [{min_m: [2, 2], max_m: [5, 5]}]
)");
  const Outcome outcome = shell("throng run later.yaml --lcm off --log off --contacts c", folder);
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(line_count(outcome.err), 1) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("note: no "));
  EXPECT_THAT(outcome.err, testing::Not(HasSubstr("gnuplot>")));
  EXPECT_EQ(line_count(read_file(folder / "c/part_contacts.csv")), 1);
  EXPECT_EQ(line_count(read_file(folder / "c/contacts.csv")), 1);
  EXPECT_EQ(line_count(read_file(folder / "c/people.csv")), 1 + 5);
}

TEST(ContactFiles, ReportAFolderThatCannotBeCreated) {
  const ScratchFolder folder;
  const Outcome outcome =
      shell("echo >f; throng run corridor --lcm off --log off --contacts f/c", folder);
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.err, HasSubstr("f/c"));
}

constexpr const char* kCell = R"(
name: cell
step_s: 1/20
duration_s: 3
proximity_m: 0.8
culling: {exact: true}
ground: {min_m: [-4, -3], max_m: [4, 3]}
groups:
  - {name: cart, model: ROBOT, count: 1, height_m: 1.3, spawn: {min_m: [-3, -2], max_m: [3, 2]}, goals: [{min_m: [1, -2], max_m: [3, 2]}, {min_m: [-3, -2], max_m: [-1, 2]}]}
  - {name: people, count: 12, spawn: {min_m: [-3, -2], max_m: [3, 2]}, goals: [{min_m: [1, -2], max_m: [3, 2]}, {min_m: [-3, -2], max_m: [-1, 2]}]}
separation: {human_speed_mps: 1.2, reaction_s: 0.1, stopping_s: 0.2, intrusion_m: 0.1}
)";

TEST(SeparationFiles, AgreeWithTheRun) {
  const ScratchFolder folder;
  std::string scene = kCell;
  scene.replace(scene.find("ROBOT"), 5,
                std::string(THRONG_SOURCE_DIR) + "/scenes/bundled/robot/robot.urdf");
  write_file(folder / "cell.yaml", scene);
  const std::string run = "throng run cell.yaml --lcm off --log off --json r.json";
  const Outcome outcome = shell(run + " --separation s", folder);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.err,
              HasSubstr("note: separation: distances are known up to proximity_m = 0.8 m"));
  EXPECT_THAT(outcome.out, HasSubstr("\nseparated "));
  const auto with = nlohmann::json::parse(read_file(folder / "r.json"));
  const auto& separation = with["separation"];
  EXPECT_EQ(separation["folder"], "s");
  EXPECT_EQ(separation["robots"], 1);
  EXPECT_GT(separation["shortfalls"], 0);
  EXPECT_EQ(separation["regions"].size(), 7u);
  EXPECT_EQ(line_count(read_file(folder / "s/separation.csv")), 1 + 60 * 7);
  EXPECT_EQ(line_count(read_file(folder / "s/shortfalls.csv")),
            1 + separation["shortfalls"].get<int>());
  EXPECT_THAT(read_file(folder / "s/separation.svg"), HasSubstr("</svg>"));
  ASSERT_EQ(shell(run, folder).exit_code, 0);
  const auto without = nlohmann::json::parse(read_file(folder / "r.json"));
  EXPECT_EQ(without["separation"]["regions"], separation["regions"]);
  EXPECT_EQ(without["hash"], with["hash"]);
}

TEST(SeparationFiles, RequireASceneWithSeparation) {
  const ScratchFolder folder;
  const Outcome outcome = shell("throng run corridor --lcm off --separation s", folder);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("--separation: expected a scene with a 'separation'"));
  EXPECT_FALSE(std::filesystem::exists(folder / "s"));
}

/// A limit on file sizes simulates a full disk.
class FullDisk : public testing::TestWithParam<const char*> {};

TEST_P(FullDisk, EndsTheRunAndKeepsWrittenData) {
  const ScratchFolder folder;
  const std::string file = GetParam();
  const Outcome outcome = shell(
      "trap '' XFSZ; ulimit -f 6000; throng run corridor --seconds 60 "
      "--lcm off --log off --trajectory-fps 60 --trajectory " +
          file,
      folder);
  EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr(file + ": cannot write the trajectory"));
  EXPECT_THAT(outcome.out, HasSubstr("ordop26")) << "the table of the results is lost";
  EXPECT_GT(std::filesystem::file_size(folder / file), 1'000'000u);
}

INSTANTIATE_TEST_SUITE_P(Trajectory, FullDisk, testing::Values("t.sqlite", "t.csv"),
                         [](const auto& each) { return std::string(each.param).substr(2); });

TEST(TrajectoryFiles, EndWithACompleteFrameOnAFullDisk) {
  const ScratchFolder folder;
  shell(
      "trap '' XFSZ; ulimit -f 200; throng run corridor --seconds 60 --lcm off --log off "
      "--trajectory-fps 60 --trajectory t.csv",
      folder);
  const std::string text = read_file(folder / "t.csv");
  ASSERT_FALSE(text.empty());
  EXPECT_EQ(text.back(), '\n');
  EXPECT_EQ((line_count(text) - 1) % 120, 0) << "corridor has 120 people";
}

}  // namespace
}  // namespace throng::recorders_test
