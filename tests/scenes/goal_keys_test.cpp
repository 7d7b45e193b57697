// Keys of goals: queues, capacities, waiting times.
#include "tests/scenes/scene_file.h"

namespace throng::goal_keys_test {
namespace {

class GoalKeys : public SceneFile {};

/// Scene with one group whose goal in the east has these keys.
std::string with_goal(const std::string& keys) {
  return kGround +
         "groups:\n"
         "  - count: 3\n"
         "    spawn: {min_m: [1, 1], max_m: [4, 9]}\n"
         "    goals:\n"
         "      - {min_m: [15, 1], max_m: [19, 9]" +
         keys + "}\n";
}

TEST_F(GoalKeys, ReadQueues) {
  const Scene plain = load(with_goal(""));
  EXPECT_FALSE(plain.groups[0].goals[0].is_limited());
  const Scene counter = load(with_goal(", queue: {}"));
  EXPECT_TRUE(counter.groups[0].goals[0].is_limited());
  EXPECT_EQ(counter.groups[0].goals[0].max_inside(), 1);
  EXPECT_EQ(counter.groups[0].goals[0].queue.spacing_m, 0.9);
  EXPECT_NE(counter.content_hash, plain.content_hash);
  const Scene few = load(with_goal(", capacity: 5"));
  EXPECT_TRUE(few.groups[0].goals[0].is_limited());
  EXPECT_EQ(few.groups[0].goals[0].max_inside(), 5);
  EXPECT_NE(few.content_hash, plain.content_hash);
  const Scene both =
      load(with_goal(", capacity: 5, queue: {spacing_m: 1, line: [[14, 5], [9, 5], [9, 2]]}"));
  EXPECT_EQ(both.groups[0].goals[0].queue.line_m[2], Eigen::Vector2d(9, 2));
  EXPECT_NE(both.content_hash, few.content_hash);
  const Scene other =
      load(with_goal(", capacity: 5, queue: {spacing_m: 1, line: [[14, 5], [9, 5], [9, 3]]}"));
  EXPECT_NE(both.content_hash, other.content_hash);
}

TEST_F(GoalKeys, ReadWaitDistributions) {
  const Scene fixed = load(with_goal(", wait_s: 5"));
  EXPECT_EQ(fixed.groups[0].goals[0].wait_s, (Distribution{5, 0, 5, 5}));
  const Scene drawn = load(with_goal(", wait_s: {mean: 5, std_dev: 2, max: 9}"));
  EXPECT_EQ(drawn.groups[0].goals[0].wait_s, (Distribution{5, 2, 0, 9}));
  EXPECT_NE(drawn.content_hash, fixed.content_hash);
  EXPECT_EQ(complaint(with_goal(", wait_s: {mean: 5, max: 4}")),
            "s.yaml:6: expected min <= mean <= max in wait_s, found min 0, mean 5, max 4");
}

TEST_F(GoalKeys, RejectBlockedQueueLines) {
  const auto of_line = [&](const std::string& line) {
    return complaint(with_goal(", queue: {line: " + line + "}"));
  };
  EXPECT_EQ(of_line("[[14, 5], [14, 12]]"),
            "s.yaml:6: expected a line within the ground ([0, 0] to [20, 10]), found [14, 9.9]");
  EXPECT_EQ(of_line("[[16, 5], [9, 5]]"),
            "s.yaml:6: expected a line that ends before the goal, found [16, 5] in it");
  EXPECT_EQ(of_line("[[14, 5]]"),
            "s.yaml:6: expected a list of at least 2 points for 'line', found a list of 1");
  EXPECT_EQ(of_line("[[14, 5], [14, 5.05]]"),
            "s.yaml:6: expected corners of a line at least 0.1 m apart, found [14, 5] and [14, "
            "5.05]");
  EXPECT_EQ(of_line("[[14, 5], 3]"), "s.yaml:6: expected a point [x, y] in 'line', found '3'");
  EXPECT_EQ(complaint(with_goal(", queue: {line: [[14, 5], [9, 5]]}") +
                      "obstacles:\n"
                      "  - {name: wall, kind: box, position_m: [12, 5], size_m: [0.2, 2, 3]}\n"),
            "s.yaml:6: expected a line with free ground to stand on, found [12.25, 5] at obstacle "
            "'wall'");
  EXPECT_EQ(complaint(with_goal(", queue: {line: [[14, 5], [9, 5]]}") +
                      "      - {min_m: [15, 1], max_m: [19, 9], capacity: 2}\n"),
            fmt::format("s.yaml:7: expected the same 'capacity' and 'queue' as of the goal of the "
                        "same areas at {}/s.yaml:6, found other values",
                        folder_.string()));
}

}  // namespace
}  // namespace throng::goal_keys_test
