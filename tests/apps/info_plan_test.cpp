// `throng info SCENE --plan FILE` draws every scene as well-formed XML, to scale.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "tests/apps/cli.h"

namespace throng::info_plan_test {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr const char* kScene = R"(
name: hall <1> & "two"
description: a hall
ground: {min_m: [0, 0], max_m: [30, 20]}
groups:
  - {name: "R&D <team>", count: 3, spawn: {min_m: [1, 1], max_m: [4, 4]},
     goals: [{min_m: [20, 12], max_m: [26, 16]}, {min_m: [1, 14], max_m: [4, 18]}]}
  - {name: class, sources: [{area: {min_m: [27, 1], max_m: [29, 4]}, count: 5, rate_per_s: 1}],
     goals: [{min_m: [12, 15], max_m: [16, 19], capacity: 1, queue: {line: [[14, 14], [14, 11]]}}]}
  - {name: guide, count: 1, spawn: {min_m: [8, 8], max_m: [9, 9]}, control_channel: GUIDE}
doors:
  - {name: back door, from_m: [20, 6], to_m: [20, 9], opens: [5]}
  - {name: front door, from_m: [10, 6], to_m: [10, 9], closes: [99]}
obstacles:
  - {name: balcony, kind: box, position_m: [25, 18], size_m: [8, 3, 0.3], bottom_m: 3}
  - {name: vitrine & <glass>, kind: box, position_m: [25, 7], size_m: [5, 1.5, 1.2]}
  - {name: pin, kind: cylinder, position_m: [5, 10], diameter_m: 0.1, height_m: 2}
)";

/// Returns plan.svg, which must be well-formed XML.
std::string plan_in(const ScratchFolder& folder) {
  const Outcome parsed = shell(
      "python3 -c 'import xml.sax; xml.sax.parse(\"plan.svg\", xml.sax.ContentHandler())'", folder);
  EXPECT_EQ(parsed.exit_code, 0) << parsed.err;
  return read_file(folder / "plan.svg");
}

std::string plan_of(const std::string& scene, const ScratchFolder& folder) {
  const Outcome outcome = shell("throng info " + scene + " --plan plan.svg", folder);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  return outcome.exit_code == 0 ? plan_in(folder) : "";
}

double number_in(const std::string& text, const std::string& pattern) {
  std::smatch found;
  EXPECT_TRUE(std::regex_search(text, found, std::regex(pattern))) << pattern;
  return found.size() > 1 ? std::stod(found[1]) : 0;
}

TEST(InfoPlan, DrawsEveryBundledScene) {
  const ScratchFolder folder;
  std::istringstream lines(shell("throng scenes", folder).out);
  int drawn = 0;
  for (std::string line; std::getline(lines, line);) {
    const std::string name = line.substr(0, line.find(' '));
    if (name.empty() || name == "NAME") continue;
    SCOPED_TRACE(name);
    const std::string svg = plan_of(name, folder);
    EXPECT_THAT(svg, HasSubstr(">" + name + "</text>"));
    EXPECT_LT(svg.size(), 1'000'000u);
    ++drawn;
  }
  EXPECT_GE(drawn, 18);
}

TEST(InfoPlan, ShowsWhatASceneHas) {
  const ScratchFolder folder;
  write_file(folder / "hall.yaml", kScene);
  const Outcome outcome = shell("throng info hall.yaml --plan plan.svg", folder);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("Groups:")) << "the description is printed as well";
  EXPECT_EQ(outcome.err, "plan: plan.svg\n");
  const std::string svg = plan_in(folder);
  for (const char* text : {">hall &lt;1&gt; &amp; \"two\"</text>",
                           ">R&amp;D &lt;team&gt;</text>",
                           ">class</text>",
                           ">A start</text>",
                           ">A1</text>",
                           ">A2</text>",
                           ">B enter</text>",
                           ">B1</text>",
                           ">C external</text>",
                           "moved by messages on channel GUIDE",
                           ">3 people: A1, A2, repeat</text>",
                           "door back door, shut at first",
                           "door front door, open at first",
                           ">back door</text>",
                           ">front door</text>",
                           ">balcony</text>",
                           ">vitrine &amp; &lt;glass&gt;</text>",
                           "<title>pin: 0.1 x 0.1 x 2 m</title>",
                           "class=\"overhead\"",
                           "class=\"queue\"",
                           "class=\"route\"",
                           "9 avatars in 3 groups, 3 obstacles, 2 doors"})
    EXPECT_THAT(svg, HasSubstr(text));
}

TEST(InfoPlan, ShowsRecordedPeople) {
  const ScratchFolder folder;
  std::string table = "id,frame,x,y\n";
  for (int i = 0; i < 50; ++i)
    table += fmt::format("1,{},{},2\n2,{},5,{}\n", i, i * 0.1, i, i * 0.1);
  write_file(folder / "walk.csv", table);
  write_file(folder / "s.yaml",
             "name: s\nkind: recorded\nrecording: {file: walk.csv, fps: 25, unit_m: 1}\n");
  const std::string svg = plan_of("s.yaml", folder);
  for (const char* text : {"class=\"track\"", "bounds of 2 recorded people", ">A recorded</text>",
                           ">2 recorded people</text>"})
    EXPECT_THAT(svg, HasSubstr(text));
  EXPECT_THAT(svg, Not(HasSubstr(">not walkable</text>")));
}

TEST(InfoPlan, IsToScale) {
  const ScratchFolder folder;
  for (const double size_m : {0.5, 2.0, 5.0, 36.0, 700.0, 3000.0}) {
    SCOPED_TRACE(size_m);
    write_file(folder / "s.yaml",
               fmt::format("name: s\nground: {{min_m: [0, 0], max_m: [{0}, {0}]}}\ngroups:\n- "
                           "{{name: g, count: 1, spawn: {{min_m: [0, 0], max_m: [{0}, {0}]}}, "
                           "goals: [{{min_m: [0, 0], max_m: [{0}, {0}]}}]}}\n",
                           size_m));
    const std::string svg = plan_of("s.yaml", folder);
    const double ground_px = number_in(svg, "id=\"ground\"[^>]* width=\"([0-9.]+)\"");
    const double bar_px = number_in(svg, "id=\"scale-bar\" d=\"M[0-9.]+ 60v-8v4h([0-9.]+)v");
    std::smatch label;
    ASSERT_TRUE(std::regex_search(svg, label,
                                  std::regex("scale-bar\"[^>]*/><text[^>]*>([0-9]+) (cm|m|km)<")));
    const double unit_m = label[2] == "cm" ? 0.01 : label[2] == "m" ? 1 : 1000;
    EXPECT_NEAR(std::stod(label[1]) * unit_m * ground_px / size_m, bar_px, 0.01);
    EXPECT_THAT(label[1].str(), testing::MatchesRegex("[125]0*"));
    EXPECT_GT(bar_px, 60);
    EXPECT_GT(ground_px, 600) << "the page is used";
    EXPECT_LT(ground_px, 1200);
  }
}

TEST(InfoPlan, StaysSmallAndLegibleWithManyObstacles) {
  const ScratchFolder folder;
  std::string text =
      "name: many\nground: {min_m: [0, 0], max_m: [2500, 2500]}\ngroups:\n- {name: g, count: 1, "
      "spawn: {min_m: [0, 0], max_m: [9, 9]}, goals: [{min_m: [0, 0], max_m: [9, 9]}]}\n"
      "obstacles:\n";
  for (int i = 0; i < 20'000; ++i)
    text += fmt::format(
        "- {{name: pillar number {}, kind: cylinder, position_m: [{}, {}], diameter_m: {}, "
        "height_m: 3, bottom_m: {}}}\n",
        i, 20 + 16 * (i % 150), 20 + 16 * (i / 150), i % 1000 == 0 ? 200 : 8, i % 100 == 0 ? 0 : 5);
  write_file(folder / "many.yaml", text);
  const std::string svg = plan_of("many.yaml", folder);
  EXPECT_LT(svg.size(), 10'000'000u);
  EXPECT_THAT(svg, HasSubstr("pillar number 19999:"));
  // No two names overlap.
  const std::regex name("class=\"name\" x=\"([0-9.]+)\" y=\"([0-9.]+)\">([^<]*)<");
  std::vector<std::array<double, 3>> names;
  for (std::sregex_iterator at(svg.begin(), svg.end(), name), end; at != end; ++at)
    names.push_back(
        {std::stod((*at)[1]), std::stod((*at)[2]), 6.0 * static_cast<double>((*at)[3].length())});
  for (size_t i = 0; i < names.size(); ++i)
    for (size_t j = 0; j < i; ++j)
      EXPECT_TRUE(std::abs(names[i][0] - names[j][0]) >= (names[i][2] + names[j][2]) / 2 ||
                  std::abs(names[i][1] - names[j][1]) >= 12);
}

/// Centre of a label in metres, for a ground from the origin.
std::array<double, 2> label_at(const std::string& svg, const std::string& label,
                               const std::string& style, double height_m) {
  const auto ground = [&](const std::string& attribute) {
    return number_in(svg, "id=\"ground\"[^>]* " + attribute + "=\"([0-9.]+)\"");
  };
  const std::string begin = "class=\"" + style + "\" x=\"";
  const double x = number_in(svg, begin + "([0-9.]+)\"[^>]*>" + label + "<");
  const double y = number_in(svg, begin + "[0-9.]+\" y=\"([0-9.]+)\"[^>]*>" + label + "<");
  const double px_per_m = ground("height") / height_m;
  return {(x - ground("x")) / px_per_m, height_m - (y - ground("y")) / px_per_m};
}

TEST(InfoPlan, LabelsStandOnConcaveAndDividedAreas) {
  const ScratchFolder folder;
  write_file(folder / "s.yaml", R"yaml(
ground: {min_m: [0, 0], max_m: [60, 40]}
groups:
  - name: g
    count: 1
    spawn: {polygon: [[2, 2], [58, 2], [58, 12], [54, 12], [54, 6], [6, 6], [6, 12], [2, 12]]}
    goals:
      - {wkt: "MULTIPOLYGON (((2 30, 4 30, 4 34, 2 34)), ((40 26, 56 26, 56 38, 40 38)))"}
obstacles:
  - {name: bar, kind: polygon, polygon: [[8, 14], [34, 14], [34, 32], [26, 32], [26, 18], [8, 18]],
     top_m: 1.2}
)yaml");
  const std::string svg = plan_of("s.yaml", folder);
  const auto [start_x, start_y] = label_at(svg, "A start", "code", 40);
  EXPECT_TRUE(start_y > 2 && start_y < 12 && (start_y < 6 || start_x < 6 || start_x > 54))
      << start_x << ", " << start_y;
  const auto [goal_x, goal_y] = label_at(svg, "A1", "code", 40);
  EXPECT_NEAR(goal_x, 48, 2);
  EXPECT_NEAR(goal_y, 32, 2);
  const auto [bar_x, bar_y] = label_at(svg, "bar", "name", 40);
  EXPECT_TRUE(bar_y > 14 && bar_y < 32 && bar_x < 34 && (bar_y < 18 || bar_x > 26))
      << bar_x << ", " << bar_y;
}

TEST(InfoPlan, DrawsPiecesOfAPolygonAsOneShape) {
  const ScratchFolder folder;
  write_file(folder / "s.yaml", R"(
ground: {min_m: [0, 0], max_m: [30, 20]}
groups:
  - {name: g, count: 1, spawn: {min_m: [1, 1], max_m: [3, 3]}, goals: [{min_m: [1, 1], max_m: [3, 3]}]}
obstacles:
  - {name: counter, kind: polygon, polygon: [[5, 5], [9.1, 5], [9.1, 8.3], [7.7, 8.3], [7.7, 6.1],
     [5, 6.1]], top_m: 1}
  - {name: pillar, kind: cylinder, position_m: [4, 15], diameter_m: 1, height_m: 3}
  - {name: fence, kind: wall, line: [[15, 5], [25, 5], [25, 15], [15, 15], [15, 5]],
     thickness_m: 0.2, top_m: 1}
)");
  const std::string svg = plan_of("s.yaml", folder);
  const auto outline = [&](const std::string& title) {
    const std::string before = "<path d=\"";
    const size_t end = svg.find("\"><title>" + title + " m</title>");
    EXPECT_NE(end, std::string::npos) << title;
    const size_t begin = svg.rfind(before, end) + before.size();
    std::string path = svg.substr(begin, end - begin);
    EXPECT_THAT(path, Not(HasSubstr("\""))) << "another element";
    return path;
  };
  const std::string counter = outline("counter: 4.1 x 3.3 x 1");
  EXPECT_EQ(std::count(counter.begin(), counter.end(), 'M'), 1) << counter;
  EXPECT_EQ(std::count(counter.begin(), counter.end(), 'L'), 5) << counter;
  const std::string fence = outline("fence: 10.2 x 10.2 x 1");
  EXPECT_EQ(std::count(fence.begin(), fence.end(), 'M'), 2) << fence;
  EXPECT_EQ(std::count(fence.begin(), fence.end(), 'L'), 6) << fence;
  EXPECT_THAT(svg, Not(HasSubstr("counter 1")));
  EXPECT_THAT(svg, Not(HasSubstr("fence 2")));
  EXPECT_THAT(svg, HasSubstr(">counter</text>"));
}

TEST(InfoPlan, RejectsOtherFilesInOneLine) {
  const ScratchFolder folder;
  ASSERT_EQ(shell("throng run corridor --avatars 4 --seconds 0.1 --lcm off --log a.lcmlog "
                  "--trajectory a.csv",
                  folder)
                .exit_code,
            0);
  write_file(folder / "hall.yaml", kScene);
  write_file(folder / "a.stl", "solid a\nendsolid a\n");
  const std::string adult = repository("avatars/models/adult/");
  for (const std::string& file :
       {std::string("a.lcmlog"), std::string("a.csv"), std::string("a.stl"), adult + "head.tri",
        adult + "adult.urdf", std::string("corridr")}) {
    const Outcome outcome = shell("throng info " + file + " --plan plan.svg", folder);
    EXPECT_EQ(outcome.exit_code, 2) << file;
    EXPECT_EQ(line_count(outcome.err), 1) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("scene")) << file;
    EXPECT_EQ(outcome.out, "") << file;
    EXPECT_EQ(shell("test -e plan.svg", folder).exit_code, 1) << file;
  }
  const Outcome in_place = shell("throng info hall.yaml --plan hall.yaml", folder);
  EXPECT_EQ(in_place.exit_code, 2);
  EXPECT_EQ(line_count(in_place.err), 1) << in_place.err;
  EXPECT_EQ(read_file(folder / "hall.yaml"), kScene);
  const Outcome nowhere = shell("throng info hall.yaml --plan no/plan.svg", folder);
  EXPECT_EQ(nowhere.exit_code, 3);
  EXPECT_EQ(line_count(nowhere.err), 1) << nowhere.err;
}

}  // namespace
}  // namespace throng::info_plan_test
