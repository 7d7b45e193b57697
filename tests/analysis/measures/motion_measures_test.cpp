// Measures of motion, on synthetic tracks with known results.
#include "analysis/measures/motion_measures.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>
#include <numbers>

#include "analysis/measures/speed_and_spacing.h"
#include "base/random.h"
#include "tests/crowd/crowd_world.h"

namespace throng::motion_measures_test {
namespace {

constexpr double kSample_s = 0.1;

/// Position of a person at a time; nothing: absent.
using Track = std::function<std::optional<Eigen::Vector2d>(double time_s)>;

/// Calls visit(crowd) after every instant.
void watch(const std::vector<Track>& tracks, double seconds,
           const std::function<void(const RecentCrowd&)>& look) {
  RecentCrowd crowd(tracks.size(), 21);
  for (int n = 0; n * kSample_s <= seconds; ++n) {
    Moment& now = crowd.next();
    now.time_s = n * kSample_s;
    for (size_t i = 0; i < tracks.size(); ++i) {
      const std::optional<Eigen::Vector2d> place = tracks[i](now.time_s);
      now.present[i] = place.has_value();
      if (place) now.heads_m[i] = now.roots_m[i] = *place;
    }
    crowd.pushed();
    look(crowd);
  }
}

Track straight(const Eigen::Vector2d& from, const Eigen::Vector2d& velocity_mps) {
  return [=](double time_s) { return Eigen::Vector2d(from + time_s * velocity_mps); };
}

Scene ground(double half_m) {
  Scene scene;
  scene.ground = {{-half_m, -half_m}, {half_m, half_m}};
  return scene;
}

std::vector<Track> walkers(uint64_t seed, int count, double half_m) {
  std::vector<Track> tracks;
  for (int i = 0; i < count; ++i) {
    const RandomKey key{seed, static_cast<uint64_t>(i), 0, Purpose::kSpawnPosition};
    const double heading = random_uniform(key, 0, 2 * std::numbers::pi, 2);
    const double speed = random_uniform(key, 0, 1.5, 3);
    tracks.push_back(
        straight({random_uniform(key, -half_m, half_m), random_uniform(key, -half_m, half_m, 1)},
                 speed * Eigen::Vector2d(std::cos(heading), std::sin(heading))));
  }
  return tracks;
}

TEST(Velocities, CoverOneSecondAroundTheMoment) {
  const std::vector<Track> tracks = {
      straight({0, 0}, {1.2, -0.5}),
      [](double t) { return t < 0.95 ? std::nullopt : std::optional(Eigen::Vector2d(t, 0.0)); },
      // Moved elsewhere after 2 s.
      [](double t) { return Eigen::Vector2d(t < 2.05 ? 0.0 : 30.0, t); }};
  int known[3] = {};
  watch(tracks, 4, [&](const RecentCrowd& crowd) {
    Velocities velocities;
    velocities.find(crowd, 5, kSample_s);
    for (size_t i = 0; i < 3; ++i) {
      if (velocities.known[i] == 0) continue;
      ++known[i];
      const Eigen::Vector2d expected[] = {{1.2, -0.5}, {1, 0}, {0, 1}};
      EXPECT_LT((velocities.of_mps[i] - expected[i]).norm(), 1e-9) << "person " << i;
    }
  });
  EXPECT_EQ(known[0], 31) << "41 instants minus 5 at both ends";
  EXPECT_EQ(known[1], 21) << "31 instants minus 5 at both ends";
  EXPECT_EQ(known[2], 11 + 10) << "21 and 20 instants minus 5 at both ends";
}

/// Distances between all pairs, without a spatial index.
struct SpacingByAllPairs {
  std::map<std::string, std::vector<double>> distances;

  void take(const Moment& moment, const Velocities& velocities) {
    for (size_t i = 0; i < moment.present.size(); ++i) {
      if (!velocities.known[i] || velocities.of_mps[i].norm() < 0.1) continue;
      std::vector<double> all;
      for (size_t j = 0; j < moment.present.size(); ++j)
        if (j != i) all.push_back((moment.heads_m[j] - moment.heads_m[i]).norm());
      std::sort(all.begin(), all.end());
      const double density = 6 / (std::numbers::pi * all[5] * all[5]);
      const char* level = density < 1   ? "0 to 1"
                          : density < 2 ? "1 to 2"
                          : density < 3 ? "2 to 3"
                          : density < 5 ? "3 to 5"
                                        : "above 5";
      for (size_t j = 0; j < moment.present.size(); ++j) {
        const Eigen::Vector2d offset_m = moment.heads_m[j] - moment.heads_m[i];
        if (j == i || offset_m.norm() > 1.2) continue;
        const double angle =
            std::acos(
                std::clamp(offset_m.normalized().dot(velocities.of_mps[i].normalized()), -1., 1.)) *
            180 / std::numbers::pi;
        if (angle <= 30) distances[std::string(level) + " ahead"].push_back(offset_m.norm());
        if (angle >= 60 && angle <= 120)
          distances[std::string(level) + " beside"].push_back(offset_m.norm());
      }
    }
  }
};

TEST(SpeedAndSpacing, MatchesTheSpacingOfAllPairs) {
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    const double half_m = 1 + static_cast<double>(seed);
    SpeedAndSpacing measure(ground(20));
    SpacingByAllPairs oracle;
    watch(walkers(seed, 50, half_m), 5, [&](const RecentCrowd& crowd) {
      Velocities velocities;
      velocities.find(crowd, 5, kSample_s);
      measure.take(crowd.ago(5), velocities);
      oracle.take(crowd.ago(5), velocities);
    });
    const MeasureTable table = measure.spacing_table();
    size_t rows = 0;
    for (auto& named : oracle.distances) {
      const std::string& name = named.first;
      std::vector<double>& distances = named.second;
      if (distances.size() < SpeedAndSpacing::kMinValues) continue;
      std::sort(distances.begin(), distances.end());
      const size_t blank = name.rfind(' ');
      for (const auto& [what, share] : {std::pair("1 %", 0.01), {"5 %", 0.05}, {"25 %", 0.25}}) {
        ++rows;
        const double rank = share * static_cast<double>(distances.size());
        const auto at = [&](double index) {
          return distances[static_cast<size_t>(
              std::clamp(index, 0.0, static_cast<double>(distances.size() - 1)))];
        };
        const double found = table.value(name.substr(0, blank), name.substr(blank + 1), what);
        EXPECT_GE(found, at(rank - 2) - 0.006) << name << " " << what << ", seed " << seed;
        EXPECT_LE(found, at(rank + 1) + 0.006) << name << " " << what << ", seed " << seed;
      }
    }
    EXPECT_EQ(table.rows.size(), rows) << "seed " << seed;
    EXPECT_GT(rows, 12u) << "seed " << seed;
  }
}

// A square grid of people who walk together; each cell is one square.
TEST(SpeedAndSpacing, AssignsSpeedToTheDensityOfTheGrid) {
  for (const double spacing_m : {0.52, 0.72, 1.1}) {
    std::vector<Track> tracks;
    for (int i = 0; i < 12; ++i)
      for (int j = 0; j < 12; ++j)
        tracks.push_back(straight({spacing_m * i, spacing_m * j}, {0.6, 0.8}));
    SpeedAndSpacing measure(ground(40));
    watch(tracks, 3, [&](const RecentCrowd& crowd) {
      Velocities velocities;
      velocities.find(crowd, 5, kSample_s);
      measure.take(crowd.ago(5), velocities);
    });
    const double bin = std::floor(1 / (spacing_m * spacing_m) / 0.25);
    const MeasureTable table = measure.speed_table();
    EXPECT_NEAR(table.value(range_text(0.25 * bin, 0.25 * (bin + 1)), "", "mean"), 1, 1e-9)
        << spacing_m;
    EXPECT_EQ(measure.off_the_area(), 0u);
  }
}

/// All tables of motion, optionally of the mirrored scene.
std::vector<MeasureTable> all_tables(const std::vector<Track>& tracks, const Scene& scene,
                                     const Passage& line) {
  SpeedAndSpacing motion(scene);
  HeadSway sway(tracks.size(), kSample_s);
  Accelerations accelerations(kSample_s);
  FlowLines flow(scene, tracks.size(), line);
  watch(tracks, 8, [&](const RecentCrowd& crowd) {
    Velocities velocities;
    velocities.find(crowd, 5, kSample_s);
    motion.take(crowd.ago(5), velocities);
    sway.take(crowd);
    accelerations.take(crowd);
    flow.take(crowd);
  });
  return {motion.speed_table(), motion.spacing_table(), sway.table(), accelerations.table(),
          flow.table()};
}

TEST(MotionMeasures, AreEqualForAMirroredCrowd) {
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    std::vector<Track> tracks, mirrored;
    for (const Track& track : walkers(seed, 60, 4)) {
      const auto swaying = [track](double t) {
        return Eigen::Vector2d(*track(t) + 0.04 * std::sin(6 * t) * Eigen::Vector2d(0.6, 0.8));
      };
      tracks.emplace_back(swaying);
      mirrored.emplace_back(
          [swaying](double t) { return Eigen::Vector2d(-swaying(t).x(), swaying(t).y()); });
    }
    Scene scene = ground(30), other = ground(30);
    scene.obstacles = {box(1.5, 2.2, 1, 0.4), box(1.5, -1.2, 1, 0.4)};
    other.obstacles = {box(-1.5, 2.2, 1, 0.4), box(-1.5, -1.2, 1, 0.4)};
    const std::vector<MeasureTable> a = all_tables(tracks, scene, {{1, -3}, {1, 3}});
    const std::vector<MeasureTable> b = all_tables(mirrored, other, {{-1, -3}, {-1, 3}});
    for (size_t i = 0; i < a.size(); ++i) {
      ASSERT_FALSE(a[i].rows.empty()) << a[i].id << ", seed " << seed;
      ASSERT_EQ(a[i].rows.size(), b[i].rows.size()) << a[i].id << ", seed " << seed;
      for (size_t k = 0; k < a[i].rows.size(); ++k) {
        const MeasureRow &of_a = a[i].rows[k], &of_b = b[i].rows[k];
        if (of_a.what == "people in the minor direction") continue;
        EXPECT_TRUE(of_a.matches(of_b)) << a[i].id << ", seed " << seed;
        EXPECT_NEAR(of_a.value, of_b.value, 1e-3 + 1e-3 * std::abs(of_a.value))
            << a[i].id << " " << of_a.at << " " << of_a.what << ", seed " << seed;
      }
    }
  }
}

TEST(FlowLines, CountAndTimePassages) {
  const Passage line{{0, -1}, {0, 1}};
  std::vector<Track> tracks;
  for (int i = 0; i < 5; ++i) tracks.push_back(straight({-1 - 2 * i, 0.1 * i}, {1, 0}));
  tracks.push_back(straight({3.05, -0.5}, {-1, 0}));  // opposite direction, after 3.05 s
  tracks.push_back(straight({-1.5, 1.5}, {1, 0}));    // past an end of the line
  tracks.push_back([](double t) {                     // stands on it and sways
    return Eigen::Vector2d(0.1 * std::cos(5 * t), 0.5);
  });
  FlowLines flow(ground(20), tracks.size(), line);
  watch(tracks, 12, [&](const RecentCrowd& crowd) { flow.take(crowd); });
  const MeasureTable table = flow.table();
  EXPECT_EQ(table.value("the line", "", "people"), 7) << "five, one in the other direction, one "
                                                         "who sways";
  EXPECT_EQ(table.value("the line", "", "people in the minor direction"), 2);
  EXPECT_EQ(table.value("the line", "", "people past its ends"), 1);
  EXPECT_NEAR(table.value("the line", "", "width"), 2, 1e-9);
  // The swaying person passes after pi / 10 s, the last of the five after 9 s.
  EXPECT_NEAR(table.value("the line", "", "flow"), 6 / (9 - std::numbers::pi / 10), 0.01);
}

TEST(FlowLines, CountASecondPassageOnlyAfterLeaving) {
  FlowLines flow(ground(20), 1, Passage{{0, -1}, {0, 1}});
  watch({[](double t) { return Eigen::Vector2d(-2 * std::cos(t), 0); }}, 6.2,
        [&](const RecentCrowd& crowd) { flow.take(crowd); });
  EXPECT_EQ(flow.used().forward, 1u);
  EXPECT_EQ(flow.used().back, 1u);
}

TEST(FlowLines, FindTheNeckInUse) {
  Scene scene;
  scene.ground = {{-10, -5}, {10, 5}};
  // A neck of 1 m at x = 2, and an unused gap of 0.5 m behind the wall.
  scene.obstacles = {box(2, 2.75, 0.4, 4.5), box(2, -2.75, 0.4, 4.5), box(-8, 4, 2, 1)};
  std::vector<Track> tracks;
  for (int i = 0; i < 10; ++i) tracks.push_back(straight({-5.0 - i, -0.2 + 0.04 * i}, {1.3, 0}));
  FlowLines flow(scene, tracks.size(), {});
  watch(tracks, 16, [&](const RecentCrowd& crowd) { flow.take(crowd); });
  EXPECT_NEAR(flow.used().width_m, 1, 1e-6);
  EXPECT_NEAR(flow.used().across.from_m.x(), 2, 0.2);
  EXPECT_EQ(flow.used().passed(), 10u);
}

TEST(WidthUse, ComputesTheShareOfTimePerLane) {
  Scene scene;
  scene.ground = {{0, 0}, {30, 2}};
  WidthUse width(scene);
  // From right to left for a person who walks along x: lanes from y = 0 upwards.
  const std::vector<Track> tracks = {straight({0, 0.2}, {1, 0}), straight({0, 0.3}, {1, 0}),
                                     straight({0, 1.7}, {1, 0}), straight({0, 0.7}, {1, 0})};
  watch(tracks, 5, [&](const RecentCrowd& crowd) {
    Velocities velocities;
    velocities.find(crowd, 5, kSample_s);
    width.take(crowd.ago(5), velocities);
  });
  EXPECT_LT((width.main_direction() - Eigen::Vector2d(1, 0)).norm(), 1e-9);
  const MeasureTable table = width.table();
  ASSERT_EQ(table.rows.size(), 4u);
  const double expected[] = {50, 25, 0, 25};
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(table.rows[i].value, expected[i], 1e-9) << "lane " << i;
    EXPECT_NEAR(*table.rows[i].from, 0.5 * static_cast<double>(i), 1e-9);
  }
}

TEST(HeadSway, IsMeasuredAcrossAnyPathDespiteNoise) {
  for (const double radius_m : {1e6, 6.0}) {
    for (const auto& [speed_mps, hz] : {std::pair(1.4, 0.97), {1.0, 0.88}, {0.6, 0.75}}) {
      std::vector<Track> tracks;
      for (uint64_t i = 0; i < 20; ++i)
        tracks.push_back([=, speed = speed_mps, f = hz](double t) {
          const RandomKey key{1, i, static_cast<uint64_t>(std::llround(t * 10)),
                              Purpose::kSpawnPosition};
          const double turn = speed * t / radius_m;
          const double sway =
              0.037 * std::sin(2 * std::numbers::pi * f * t + 0.3 * static_cast<double>(i));
          const Eigen::Vector2d out(std::sin(turn), 1 - std::cos(turn));
          const Eigen::Vector2d left(-std::sin(turn), std::cos(turn));
          const Eigen::Vector2d noise(random_normal(key, 0, 0.005),
                                      random_normal(key, 0, 0.005, 2));
          return Eigen::Vector2d(radius_m * out + sway * left + noise);
        });
      HeadSway sway(tracks.size(), kSample_s);
      watch(tracks, 20, [&](const RecentCrowd& crowd) { sway.take(crowd); });
      const MeasureTable table = sway.table();
      EXPECT_NEAR(table.value("amplitude", "", "mean"), 0.037, 0.005)
          << speed_mps << " m/s, radius " << radius_m;
      double found = 0;
      for (const MeasureRow& row : table.rows)
        if (row.what == "frequency") found = row.value;
      EXPECT_NEAR(found, hz, 0.04) << speed_mps << " m/s, radius " << radius_m;
    }
  }
}

TEST(HeadSway, RequiresWalkingPeopleAndFrequentSamples) {
  HeadSway standing(1, kSample_s);
  watch({[](double t) { return Eigen::Vector2d(0, 0.04 * std::sin(6 * t)); }}, 10,
        [&](const RecentCrowd& crowd) { standing.take(crowd); });
  EXPECT_TRUE(standing.table().rows.empty());
  EXPECT_EQ(HeadSway::half_window(0.5), 0u);
  EXPECT_EQ(HeadSway::half_window(0.1), 10u);
}

TEST(Accelerations, EqualSpeedSquaredOverRadiusOnACircle) {
  Accelerations accelerations(kSample_s);
  constexpr double kSpeed_mps = 1.5, kRadius_m = 2;
  watch({[](double t) {
          const double turn = kSpeed_mps * t / kRadius_m;
          return Eigen::Vector2d(kRadius_m * std::cos(turn), kRadius_m * std::sin(turn));
        }},
        5, [&](const RecentCrowd& crowd) { accelerations.take(crowd); });
  const double expected = kSpeed_mps * kSpeed_mps / kRadius_m;
  EXPECT_NEAR(accelerations.table().value("head", "", "50 %"), expected, 0.01 * expected);
  EXPECT_NEAR(accelerations.table().value("body", "", "99.9 %"), expected, 0.01 * expected);
  EXPECT_FALSE(Accelerations(0.5).is_measured());
}

TEST(Histogram, ReturnsQuantilesAccurateToABin) {
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    Histogram histogram(-2, 0.01, 400);
    std::vector<double> numbers;
    for (uint64_t i = 0; i < 700; ++i) {
      numbers.push_back(random_normal({seed, i, 0, Purpose::kHeight}, 0, 0.3));
      histogram.add(numbers.back());
    }
    std::sort(numbers.begin(), numbers.end());
    for (const double share : {0.0, 0.01, 0.05, 0.25, 0.5, 0.9, 0.99, 1.0}) {
      const double rank = std::clamp(share * 700 - 1, 0.0, 699.0);
      EXPECT_NEAR(histogram.quantile(share), numbers[static_cast<size_t>(rank)], 0.03)
          << share << ", seed " << seed;
    }
    const auto above =
        std::count_if(numbers.begin(), numbers.end(), [](double x) { return x >= 0.2; });
    EXPECT_NEAR(histogram.share_above(0.2), static_cast<double>(above) / 700, 1e-9);
    EXPECT_EQ(histogram.max(), numbers.back());
  }
  EXPECT_TRUE(std::isnan(Histogram(0, 1, 5).quantile(0.5)));
}

}  // namespace
}  // namespace throng::motion_measures_test
