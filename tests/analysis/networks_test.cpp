// Contact networks and proximity tables match sets that an oracle collects frame by frame.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "analysis/contacts/contact_sink.h"
#include "scenes/run/runner.h"
#include "scenes/run/simulation.h"
#include "tests/scenes/scene_file.h"

namespace throng::networks_test {
namespace {

using testing::HasSubstr;
using Pair = std::pair<uint32_t, uint32_t>;

struct Oracle final : public Sink {
  void begin(const RunInfo& run) override { avatars = static_cast<uint32_t>(run.avatar_count()); }
  void frame(const RunInfo& run, const Frame& frame) override {
    const auto second =
        1 + static_cast<int64_t>(std::floor(static_cast<double>(frame.number) * run.step_s + 1e-9));
    for (const PairKey& pair : frame.pairs)
      if (pair.b() < avatars) {
        touching.insert({second, {pair.a(), pair.b()}});
        touching_frames[{pair.a(), pair.b()}].insert(frame.number);
      }
    rows += frame.proximity_pairs.size() + frame.closest_parts.size();
    for (const ProximityPair& row : frame.closest_parts) {
      const Pair people{row.pair.a(), row.pair.b()};
      proximity.insert({second, people});
      for (const double level : {0.5, 1.0, 2.0}) {
        below[level][people] += static_cast<double>(row.hi_m) <= level;
        undetermined[level][people] +=
            static_cast<double>(row.lo_m) <= level && static_cast<double>(row.hi_m) > level;
      }
    }
  }
  void end(const RunInfo&, const RunEnd&) override {}

  uint32_t avatars = 0;
  size_t rows = 0;
  std::set<std::pair<int64_t, Pair>> touching, proximity;
  std::map<Pair, std::set<int64_t>> touching_frames;
  std::map<double, std::map<Pair, int>> below, undetermined;
};

class Networks : public SceneFile {
 protected:
  /// Runs `people` people in the metro (0: all); returns the note on omitted levels.
  std::string run_metro(int people, double seconds, double proximity_m, double closest_parts_m,
                        uint64_t seed, bool exact) {
    Scene scene = load_scene("metro");
    std::vector<std::string> notes;
    if (people > 0) scale_to(scene, people, notes);
    scene.seed = seed;
    scene.proximity_m = proximity_m;
    scene.closest_parts_m = closest_parts_m;
    scene.exact = exact;
    scene.duration_s = seconds;
    step_s_ = scene.step_s;
    Simulation simulation(std::move(scene), {});
    ContactSink contacts(folder_);
    Sink* const sinks[] = {&oracle_, &contacts};
    run(simulation, sinks);
    for (const std::string& note : contacts.notes())
      if (note.find("exposure") != std::string::npos) return note;
    return "";
  }
  std::vector<std::string> lines_of(const std::string& name) const {
    std::ifstream in(folder_ / name);
    std::vector<std::string> lines;
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    return lines;
  }
  bool is_there(const std::string& name) const { return std::filesystem::exists(folder_ / name); }
  /// Lines of a .tij file, which must be sorted and unique.
  std::set<std::pair<int64_t, Pair>> seconds_of(const std::string& name) const {
    std::vector<std::pair<int64_t, Pair>> all;
    for (const std::string& line : lines_of(name)) {
      std::istringstream in(line);
      int64_t t = 0;
      Pair pair;
      EXPECT_TRUE(in >> t >> pair.first >> pair.second) << line;
      all.push_back({t, pair});
    }
    std::set<std::pair<int64_t, Pair>> set(all.begin(), all.end());
    EXPECT_TRUE(std::equal(all.begin(), all.end(), set.begin(), set.end())) << name;
    return set;
  }
  /// Attribute values of the edges of a graph.
  std::map<Pair, std::vector<std::string>> edges_of(const std::string& name) const {
    static const std::regex edge_line("<edge source=\"(\\d+)\" target=\"(\\d+)\">(.*)</edge>");
    static const std::regex data_field("<data key=\"e\\d+\">([^<]*)</data>");
    std::map<Pair, std::vector<std::string>> edges;
    size_t nodes = 0;
    for (const std::string& line : lines_of(name)) {
      nodes += line.find("<node ") != std::string::npos;
      std::smatch found;
      if (!std::regex_search(line, found, edge_line)) continue;
      const Pair pair(std::stoul(found[1]), std::stoul(found[2]));
      const std::string data = found[3];
      for (std::sregex_iterator at(data.begin(), data.end(), data_field), end; at != end; ++at)
        edges[pair].push_back((*at)[1]);
    }
    EXPECT_EQ(nodes, oracle_.avatars);
    return edges;
  }

  Oracle oracle_;
  double step_s_ = 0;
};

TEST_F(Networks, ListEverySecondAndSpellOfContact) {
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(fmt::format("seed {}", seed));
    oracle_ = {};
    run_metro(0, 15, 0, 0, seed, false);
    EXPECT_GT(oracle_.touching.size(), 20u);
    EXPECT_EQ(seconds_of("touching.tij"), oracle_.touching);
    const auto edges = edges_of("touching.graphml");
    EXPECT_EQ(edges.size(), oracle_.touching_frames.size());
    for (const auto& [pair, frames] : oracle_.touching_frames) {
      int spells = 0;
      for (const int64_t frame : frames) spells += !frames.contains(frame - 1);
      const std::vector<std::string>& edge = edges.at(pair);
      EXPECT_EQ(std::stoi(edge[0]), spells);
      EXPECT_NEAR(std::stod(edge[1]), static_cast<double>(frames.size()) * step_s_, 1e-3);
      EXPECT_NEAR(std::stod(edge[2]), static_cast<double>(*frames.begin()) * step_s_, 1e-4);
      EXPECT_EQ(std::count(edge[3].begin(), edge[3].end(), ';'), spells - 1);
    }
  }
  for (const char* name : {"proximity.csv", "exposure.csv", "proximity.tij", "proximity.graphml"})
    EXPECT_FALSE(is_there(name)) << "the run has no margin";
}

TEST_F(Networks, ListEverySecondOfProximity) {
  for (const bool exact : {false, true}) {
    oracle_ = {};
    EXPECT_THAT(run_metro(24, 1.3, 0.1, 2, 4, exact), "");
    EXPECT_EQ(lines_of("proximity.csv").size(), 1 + oracle_.rows);
    EXPECT_EQ(seconds_of("proximity.tij"), oracle_.proximity);
    const auto lines = lines_of("exposure.csv");
    EXPECT_EQ(lines[0],
              "person_a,person_b,below_0.5_m_s,undetermined_0.5_m_s,below_1_m_s,undetermined_1_m_s,"
              "below_2_m_s,undetermined_2_m_s");
    const auto edges = edges_of("proximity.graphml");
    ASSERT_EQ(lines.size(), 1 + edges.size());
    ASSERT_EQ(edges.size(), oracle_.below[2].size());
    for (size_t i = 1; i < lines.size(); ++i) {
      std::vector<double> fields;
      std::istringstream in(lines[i]);
      for (std::string field; std::getline(in, field, ',');) fields.push_back(std::stod(field));
      ASSERT_EQ(fields.size(), 8u);
      const Pair pair(static_cast<uint32_t>(fields[0]), static_cast<uint32_t>(fields[1]));
      size_t at = 2;
      for (const double level : {0.5, 1.0, 2.0}) {
        EXPECT_NEAR(fields[at], oracle_.below[level][pair] * step_s_, 1e-4);
        EXPECT_NEAR(fields[at + 1], oracle_.undetermined[level][pair] * step_s_, 1e-4);
        EXPECT_NEAR(std::stod(edges.at(pair)[at / 2 - 1]), fields[at], 1e-9);
        at += 2;
      }
    }
  }
}

TEST_F(Networks, OmitLevelsBeyondTheMargin) {
  EXPECT_THAT(run_metro(24, 1.3, 0, 1.2, 5, false),
              HasSubstr("exposure.csv has no seconds below 2 m because closest_parts_m is 1.2 m"));
  EXPECT_EQ(lines_of("exposure.csv")[0],
            "person_a,person_b,below_0.5_m_s,undetermined_0.5_m_s,below_1_m_s,undetermined_1_m_s");
  oracle_ = {};
  run_metro(24, 1.3, 0.1, 0, 5, false);
  EXPECT_TRUE(is_there("proximity.csv"));
  EXPECT_FALSE(is_there("exposure.csv")) << "stale";
}

TEST(GraphFiles, EscapeNames) {
  const std::filesystem::path file =
      std::filesystem::path(testing::TempDir()) / "throng_graph_names.graphml";
  RunInfo run;
  run.model_of_avatar = {0};
  run.groups = {"a < b & \"c\""};
  run.group_of_avatar = {0};
  GraphFile graph(file, run, {});
  graph.end();
  std::stringstream text;
  text << std::ifstream(file).rdbuf();
  EXPECT_THAT(text.str(), HasSubstr("a &lt; b &amp; \"c\""));
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace throng::networks_test
