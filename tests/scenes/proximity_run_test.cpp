// Proximity in runs: rows are independent of threads and checkpoints, and events of proximity.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "base/errors.h"
#include "scenes/file/part_words.h"
#include "scenes/run/named_bodies.h"
#include "scenes/run/runner.h"
#include "scenes/run/simulation.h"
#include "tests/nightly.h"

namespace throng::proximity_run_test {
namespace {

Scene plaza(double proximity_m, double closest_parts_m) {
  Scene scene = load_scene("plaza");
  std::vector<std::string> notes;
  scale_to(scene, 80, notes);
  scene.exact = true;
  scene.proximity_m = proximity_m;
  scene.closest_parts_m = closest_parts_m;
  scene.duration_s = 0.5;
  return scene;
}

RunSummary summary_of(const Scene& scene, int threads) {
  SimulationOptions options;
  options.threads = threads;
  Simulation simulation(scene, options);
  return run(simulation, {});
}

TEST(ProximityRun, IsIndependentOfThreadsAndKeepsEvents) {
  const RunSummary one = summary_of(plaza(0.2, 0.6), 1), three = summary_of(plaza(0.2, 0.6), 3),
                   none = summary_of(plaza(0, 0), 1);
  EXPECT_GT(one.proximity.pairs, 100u);
  EXPECT_GT(one.proximity.closest_parts, 100u);
  EXPECT_EQ(one.proximity.hash, three.proximity.hash);
  EXPECT_EQ(one.hash, three.hash);
  EXPECT_EQ(one.hash, none.hash);
  EXPECT_FALSE(none.proximity.is_enabled);
  EXPECT_NE(one.run_id, none.run_id) << "what a run lists is part of its name";
}

TEST(ProximityRun, ContinuesAfterACheckpoint) {
  const Scene scene = plaza(0.2, 0.6);
  Simulation whole(scene, {}), rest(scene, {});
  for (int i = 0; i < 10; ++i) whole.step();
  rest.resume(whole.saved(), "test");
  for (int i = 0; i < 10; ++i) {
    const Frame &expected = whole.step(), &found = rest.step();
    ASSERT_EQ(found.proximity_hash, expected.proximity_hash) << "frame " << expected.number;
    ASSERT_EQ(found.proximity_pairs.size(), expected.proximity_pairs.size());
    for (size_t k = 0; k < found.proximity_pairs.size(); ++k) {
      const float a = found.proximity_pairs[k].closing_speed_mps,
                  b = expected.proximity_pairs[k].closing_speed_mps;
      ASSERT_TRUE(a == b || (a != a && b != b)) << "frame " << expected.number << ", row " << k;
    }
  }
}

/// After a checkpoint, for any number of threads, with and without a margin.
TEST(ContactPointsRun, MatchesPairsAndKeepsEvents) {
  Scene scene = load_scene("robot_in_crowd");
  scene.exact = true;
  Simulation plain(scene, {});
  scene.contact_points = true;
  SimulationOptions threads;
  threads.threads = 3;
  Simulation with(scene, {}), rest(scene, threads);
  scene.proximity_m = 0.1;
  Simulation with_proximity(scene, {});
  size_t points = 0;
  for (int i = 0; i < 60; ++i) {
    if (i == 20) rest.resume(with.saved(), "test");
    const Frame &expected = plain.step(), &found = with.step(), &near = with_proximity.step();
    EXPECT_EQ(found.hash, expected.hash);
    EXPECT_EQ(near.hash, expected.hash);
    EXPECT_TRUE(expected.contact_points.empty());
    ASSERT_EQ(found.contact_points.size(), found.pairs.size()) << "frame " << i;
    ASSERT_EQ(near.contact_points.size(), found.pairs.size()) << "frame " << i;
    const Frame* resumed = i < 20 ? nullptr : &rest.step();
    for (size_t k = 0; k < found.pairs.size(); ++k) {
      const ContactPoint& point = found.contact_points[k];
      ASSERT_EQ(point.pair, found.pairs[k]) << "frame " << i;
      ASSERT_EQ(point.point_m, near.contact_points[k].point_m);
      ASSERT_EQ(point.depth_m, near.contact_points[k].depth_m);
      if (resumed == nullptr) continue;
      ASSERT_EQ(point.point_m, resumed->contact_points[k].point_m);
      ASSERT_EQ(point.depth_m, resumed->contact_points[k].depth_m);
    }
    points += found.contact_points.size();
  }
  EXPECT_GT(points, 100u);
}

/// In rows of closest parts all other parts are at least as far apart.
TEST(ProximityRun, ReportsClosestPartsOfTwoAvatars) {
  Simulation simulation(plaza(0.3, 0.3), {});
  int rows = 0;
  for (int i = 0; i < 20; ++i) {
    const Frame& frame = simulation.step();
    for (const ProximityPair& closest : frame.closest_parts) {
      ++rows;
      for (const ProximityPair& parts : frame.proximity_pairs)
        if (parts.pair.a() == closest.pair.a() && parts.pair.b() == closest.pair.b()) {
          ASSERT_LE(closest.hi_m, parts.hi_m);
        }
    }
  }
  EXPECT_GT(rows, 50);
}

struct ListedRow {
  PairKey pair;
  float lo_m, hi_m;
  PairLevel level;
  bool operator==(const ListedRow&) const = default;
};

std::vector<ListedRow> rows_of(const ProximityRows& rows) {
  std::vector<ListedRow> out;
  for (const ProximityPair& row : rows) out.push_back({row.pair, row.lo_m, row.hi_m, row.level});
  return out;
}

struct ListedFrames {
  std::vector<std::vector<ListedRow>> parts, closest_parts;
  size_t rows() const {
    size_t sum = 0;
    for (const auto& frame : parts) sum += frame.size();
    return sum;
  }
};

ListedFrames rows_of_run(const Scene& scene, int threads) {
  SimulationOptions options;
  options.threads = threads;
  Simulation run(scene, options);
  ListedFrames out;
  for (int i = 0; i < 8; ++i) {
    const Frame& frame = run.step();
    out.parts.push_back(rows_of(frame.proximity_pairs));
    out.closest_parts.push_back(rows_of(frame.closest_parts));
  }
  return out;
}

/// Rows of the pairs that a filter selects.
ListedFrames filtered(const ListedFrames& all, const Scene& scene) {
  const Simulation run(scene, {});
  const PairFilter filter = filter_of(scene, run.info());
  const auto type_of = [&](uint32_t body) -> size_t {
    const std::vector<uint16_t>& models = run.info().model_of_avatar;
    return body < models.size() ? models[body] : run.info().models.size() + body - models.size();
  };
  ListedFrames out;
  for (const auto& frame : all.parts) {
    std::vector<ListedRow>& kept = out.parts.emplace_back();
    for (const ListedRow& row : frame)
      if (filter.includes_bodies(row.pair.a(), row.pair.b()) &&
          filter.includes_parts(type_of(row.pair.a()), row.pair.part_a(), type_of(row.pair.b()),
                                row.pair.part_b()))
        kept.push_back(row);
  }
  return out;
}

TEST(ProximityRun, RowsDependOnTheirOwnMarginOnly) {
  for (const char* const name : {"robot_in_crowd", "plaza"})
    for (uint64_t seed = 1; seed <= 2; ++seed)
      for (const bool exact : {false, true}) {
        // Every change once with robots and people, once with people and triangles.
        const bool is_plaza = std::string_view(name) == "plaza";
        if (!test::is_nightly() && (seed > 1 || exact != is_plaza)) continue;
        SCOPED_TRACE(fmt::format("{}, seed {}, exact {}", name, seed, exact));
        Scene scene = load_scene(name);
        std::vector<std::string> notes;
        scale_to(scene, 120, notes);
        scene.seed = seed;
        scene.exact = exact;
        scene.proximity_m = 0.2;
        const ListedFrames whole = rows_of_run(scene, 1);
        ASSERT_GT(whole.rows(), 100u);
        for (const double closest_parts_m : {0.0, 0.05, 0.9})
          for (const auto& [groups, parts] : {std::pair("", ""),
                                              {"robots: people", ""},
                                              {"", "hands: torso, head"},
                                              {"people, robots: obstacles", "lower arms"}}) {
            if (is_plaza && *groups != 0) continue;  // plaza has no robots
            SCOPED_TRACE(
                fmt::format("closest_parts_m {}, '{}', '{}'", closest_parts_m, groups, parts));
            Scene other = scene;
            other.closest_parts_m = closest_parts_m;
            if (*groups != 0) other.group_filter = pair_rules_of(groups, "test");
            if (*parts != 0) other.part_filter = part_rules_of(parts, "test");
            const ListedFrames found = rows_of_run(other, closest_parts_m == 0.9 ? 3 : 1),
                               expected = filtered(whole, other);
            for (size_t frame = 0; frame < expected.parts.size(); ++frame)
              ASSERT_EQ(found.parts[frame], expected.parts[frame]) << "frame " << frame;
          }
        // Closest parts do not depend on the other margin either.
        scene.proximity_m = 0;
        scene.closest_parts_m = 0.3;
        const ListedFrames alone = rows_of_run(scene, 1);
        for (const double proximity_m : {0.1, 0.8}) {
          scene.proximity_m = proximity_m;
          EXPECT_EQ(rows_of_run(scene, 1).closest_parts, alone.closest_parts)
              << "proximity_m " << proximity_m;
        }
      }
}

/// Compared by volumes: the wall of a shop is 48 m long, with its corners far away.
TEST(ProximityRun, KeepsBoundsTightAtLargeObstacles) {
  Scene scene = load_scene("robot_in_crowd");
  scene.proximity_m = 0.2;
  Simulation by_volumes(scene, {});
  scene.exact = true;
  Simulation by_triangles(scene, {});
  size_t at_obstacles = 0;
  for (int i = 0; i < 90; ++i) {
    const Frame &wide = by_volumes.step(), &narrow = by_triangles.step();
    const uint32_t avatars = static_cast<uint32_t>(by_volumes.info().avatar_count());
    auto exact = narrow.proximity_pairs.begin();
    for (const ProximityPair& row : wide.proximity_pairs) {
      at_obstacles += row.pair.b() >= avatars;
      ASSERT_LE(row.hi_m - row.lo_m, 0.1f) << "frame " << i << ": " << row.lo_m << ", " << row.hi_m;
      while (exact != narrow.proximity_pairs.end() && (*exact).pair < row.pair) {
        ADD_FAILURE() << "frame " << i << ": a row is missing at " << (*exact).lo_m;
        ++exact;
      }
      if (exact == narrow.proximity_pairs.end() || (*exact).pair != row.pair) continue;
      ASSERT_LE(row.lo_m, (*exact).hi_m + 1e-6f) << "frame " << i;
      ASSERT_GE(row.hi_m, (*exact).lo_m - 1e-6f) << "frame " << i;
      ++exact;
    }
  }
  EXPECT_GT(at_obstacles, 500u);
}

struct Named {
  std::string body, part;
  bool is_robot, is_obstacle;
};

Named named(const Simulation& run, uint32_t id, uint32_t part) {
  const RunInfo& info = run.info();
  if (id >= info.model_of_avatar.size())
    return {"", run.scene().obstacles[id - info.model_of_avatar.size()].name, false, true};
  const Model& model = *info.models[info.model_of_avatar[id]];
  return {info.groups[info.group_of_avatar[id]], model.parts[part].name, !model.is_person, false};
}

/// Pairs of several frames, as text, for which a predicate of both sides holds.
template <typename Keeps>
std::vector<std::string> pairs_of(const Scene& scene, const Keeps& keeps) {
  Simulation run(scene, {});
  std::vector<std::string> out;
  for (int i = 0; i < 40; ++i) {
    const Frame& frame = run.step();
    const auto add = [&](const PairKey& key, const std::string& what) {
      const Named a = named(run, key.a(), key.part_a()), b = named(run, key.b(), key.part_b());
      if (keeps(a, b) || keeps(b, a))
        out.push_back(fmt::format("{} {} {} {} {} {}", frame.number, what, key.a(), key.b(),
                                  key.part_a(), key.part_b()));
    };
    for (const PairKey& key : frame.pairs) add(key, "touches");
    for (const ProximityPair& row : frame.proximity_pairs)
      add(row.pair, fmt::format("{}", row.lo_m));
  }
  return out;
}

constexpr auto kAny = [](const Named&, const Named&) { return true; };

Scene hall() {
  Scene scene = load_scene("robot_in_crowd");
  scene.proximity_m = 0.3;
  return scene;
}

TEST(PairRules, SelectPairsOfGroups) {
  Scene scene = hall();
  const std::vector<std::string> robots = pairs_of(scene, [](const Named& a, const Named& b) {
    return a.is_robot && !b.is_robot && !b.is_obstacle;
  });
  scene.group_filter = pair_rules_of("robots: people", "test");
  EXPECT_GT(robots.size(), 20u);
  EXPECT_EQ(pairs_of(scene, kAny), robots);
  scene = hall();
  const std::string group = Simulation(scene, {}).info().groups.front();
  const std::vector<std::string> own =
      pairs_of(scene, [&](const Named& a, const Named&) { return a.body == group; });
  scene.group_filter = pair_rules_of(group, "test");
  EXPECT_EQ(pairs_of(scene, kAny), own) << "a name alone is with all";
}

std::vector<std::string> notes_of(const Scene& scene) {
  std::vector<std::string> out;
  const Simulation run(scene, {});
  for (const std::string& note : run.notes())
    if (note.starts_with("group_filter: ")) out.push_back(note);
  return out;
}

TEST(PairRules, SelectKindsRegardlessOfGroupNames) {
  const auto is_person = [](const Named& one) { return !one.is_robot && !one.is_obstacle; };
  Scene plain = hall();
  const std::vector<std::string> all =
      pairs_of(plain, [&](const Named& a, const Named& b) { return a.is_robot && is_person(b); });
  const std::vector<std::string> eastbound = pairs_of(
      plain, [&](const Named& a, const Named& b) { return a.is_robot && b.body == "eastbound"; });
  ASSERT_LT(eastbound.size(), all.size());
  EXPECT_TRUE(notes_of(plain).empty());
  for (const std::string_view name : {"people", "robots", "obstacles", "all"}) {
    Scene scene = hall();
    for (Group& group : scene.groups)
      if (group.name == "eastbound") group.name = name;
    EXPECT_TRUE(notes_of(scene).empty()) << "no filter";
    scene.group_filter = pair_rules_of("robots: people", "test");
    EXPECT_EQ(pairs_of(scene, kAny), all) << name;
    EXPECT_EQ(notes_of(scene).size(), name == "people" || name == "robots" ? 1u : 0u) << name;
    scene.group_filter = pair_rules_of(fmt::format("robots: group:{}", name), "test");
    EXPECT_EQ(pairs_of(scene, kAny), eastbound) << name;
    scene.group_filter = pair_rules_of(fmt::format("group:{}:group:robot", name), "test");
    EXPECT_EQ(pairs_of(scene, kAny), eastbound) << name;
    scene.group_filter = pair_rules_of(std::string(name), "test");
    ASSERT_EQ(notes_of(scene).size(), 1u) << name;
    EXPECT_EQ(
        notes_of(scene).front(),
        fmt::format("group_filter: '{0}' means all bodies of that kind; the group of this name is "
                    "'group:{0}'",
                    name));
  }
  Scene scene = hall();
  scene.obstacles.back().name = "people";
  scene.group_filter = pair_rules_of("robots: people", "test");
  EXPECT_EQ(pairs_of(scene, kAny), all) << "and no obstacle of that name";
  EXPECT_NE(notes_of(scene).front().find("'obstacle:people'"), std::string::npos);
}

TEST(PairRules, ParsePrefixes) {
  const auto text = [](const char* given) { return to_text(pair_rules_of(given, "test")); };
  EXPECT_EQ(text("group:people"), "group:people: all");
  EXPECT_EQ(text(" group:people : robots"), "group:people: robots");
  EXPECT_EQ(text("robots:group:people, obstacle:all:group:all"),
            "robots: group:people, obstacle:all: group:all");
  EXPECT_EQ(text("group: people"), "group: people") << "a group that is called group";
  EXPECT_EQ(text(text("group:a: obstacle:b").c_str()), "group:a: obstacle:b");
  for (const char* wrong : {"group:", "robots: group:", "group:a:b:c", "group:a: group:b: c"})
    EXPECT_THROW(pair_rules_of(wrong, "--filter-groups"), InputError) << wrong;
  EXPECT_EQ(to_text(part_rules_of("group:hand", "test")), "group: hand") << "parts have no groups";
}

TEST(PairRules, ParseQuotedNames) {
  const auto rules = [](const std::string& given) { return pair_rules_of(given, "test"); };
  const auto same = [&](const std::string& given, const std::string& left,
                        const std::string& right) {
    EXPECT_EQ(rules(given), (PairRules{{left, right}})) << given;
    EXPECT_EQ(rules(to_text(rules(given))), rules(given)) << to_text(rules(given));
  };
  same(R"("doors: east": people)", "doors: east", "people");
  same(R"('doors: east':people)", "doors: east", "people");
  same(R"( robots : 'a, b' )", "robots", "a, b");
  same(R"(group:"a, b")", "group:a, b", "all");
  same(R"(obstacle:"a:b": group:'c,d')", "obstacle:a:b", "group:c,d");
  same(R"("it says ""a, b""": 'it''s: c')", R"(it says "a, b")", "it's: c");
  same(R"(" a ": people)", " a ", "people");
  same(R"(group:"group:a": people)", "group:group:a", "people");
  same(R"("""a""": people)", R"("a")", "people");
  // Text that is not a complete quotation is part of the name.
  same("O'Brien: it's", "O'Brien", "it's");
  same(R"("a: b)", R"("a)", "b");
  same(R"('a' b: c)", "'a' b", "c");
  same("\xd0\xbc\xd0\xbe\xd1\x81\xd1\x82: people", "\xd0\xbc\xd0\xbe\xd1\x81\xd1\x82", "people");
  EXPECT_EQ(rules(R"("a, b", 'c: d': e)"), (PairRules{{"a, b", "all"}, {"c: d", "e"}}));
  for (const char* wrong : {R"("")", R"(group:"": people)", R"("a": "b": "c")", R"("a",)"})
    EXPECT_THROW(rules(wrong), InputError) << wrong;

  Scene plain = hall();
  const std::vector<std::string> eastbound = pairs_of(plain, [&](const Named& a, const Named& b) {
    return a.is_robot && !b.is_obstacle && b.body == "eastbound";
  });
  ASSERT_FALSE(eastbound.empty());
  for (const std::string name :
       {"east: fast", "east, fast", "a:b", "group:robot", "'east', \"x\""}) {
    Scene scene = hall();
    for (Group& group : scene.groups)
      if (group.name == "eastbound") group.name = name;
    scene.group_filter = rules("robots: " + rule_name("group:" + name));
    EXPECT_EQ(pairs_of(scene, kAny), eastbound) << name;
    scene.group_filter = rules("unknown");
    try {
      const Simulation run(scene, {});
      ADD_FAILURE() << name;
    } catch (const InputError& error) {
      const bool has_prefix = name.starts_with("group:");
      EXPECT_NE(std::string(error.what()).find(rule_name((has_prefix ? "group:" : "") + name)),
                std::string::npos)
          << error.what();
    }
  }
}

TEST(PairRules, SelectPairsOfParts) {
  Scene scene = plaza(0.2, 0);
  scene.exact = false;
  const auto has = [](const Named& one, std::string_view word) {
    return has_words(one.part, word);
  };
  const std::vector<std::string> hands =
      pairs_of(scene, [&](const Named& a, const Named&) { return has(a, "hand"); });
  const std::vector<std::string> arms = pairs_of(scene, [&](const Named& a, const Named& b) {
    return (has(a, "hands") && has(b, "lower arms")) || (has(a, "torso") && has(b, "torso"));
  });
  scene.part_filter = pair_rules_of("hands", "test");
  EXPECT_GT(hands.size(), 20u);
  EXPECT_EQ(pairs_of(scene, kAny), hands);
  scene.part_filter = pair_rules_of("hands: lower arms, torso: torso", "test");
  EXPECT_GT(arms.size(), 5u);
  EXPECT_EQ(pairs_of(scene, kAny), arms);
}

TEST(PairRules, ChangeTheRunIdOnly) {
  Scene scene = plaza(0.2, 0.6);
  const RunSummary all = summary_of(scene, 1);
  scene.part_filter = pair_rules_of("hands, head: torso", "test");
  const RunSummary one = summary_of(scene, 1), three = summary_of(scene, 3);
  EXPECT_EQ(one.hash, three.hash);
  EXPECT_EQ(one.proximity.hash, three.proximity.hash);
  EXPECT_NE(one.run_id, all.run_id);
  EXPECT_LT(one.proximity.pairs, all.proximity.pairs);
}

TEST(PairRules, RejectUnknownNames) {
  const auto rejection = [](const char* groups, const char* parts) -> std::string {
    Scene scene = hall();
    if (*groups != 0) scene.group_filter = pair_rules_of(groups, "--filter-groups");
    if (*parts != 0) scene.part_filter = pair_rules_of(parts, "--filter-parts");
    try {
      const Simulation run(scene, {});
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(rejection("robbots: people", "").find("did you mean 'robots'"), std::string::npos)
      << rejection("robbots: people", "");
  EXPECT_NE(rejection("group:robots: people", "").find("did you mean 'group:robot'"),
            std::string::npos)
      << rejection("group:robots: people", "");
  EXPECT_NE(rejection("", "tail").find("words of a part"), std::string::npos);
  EXPECT_EQ(rejection("robots: people", "hands"), "");
  for (const char* text : {"", "a:", ":b", "a: b: c", "a,,b", " , "})
    EXPECT_THROW(pair_rules_of(text, "--filter-groups"), InputError) << '\'' << text << '\'';
}

TEST(PairRules, RejectFiltersThatBreakSeparation) {
  Scene scene = hall();
  scene.exact = true;
  scene.proximity_m = 2;
  scene.separation.emplace();
  EXPECT_NO_THROW(Simulation(scene, {}));
  scene.group_filter = pair_rules_of("people: robots", "test");
  EXPECT_NO_THROW(Simulation(scene, {}));
  scene.group_filter = pair_rules_of("people: people", "test");
  EXPECT_THROW(Simulation(scene, {}), InputError);
  scene.group_filter.clear();
  scene.part_filter = pair_rules_of("hands", "test");
  EXPECT_THROW(Simulation(scene, {}), InputError);
}

}  // namespace
}  // namespace throng::proximity_run_test
