// Extreme crowds: dense, in one point, entering and leaving every frame, at 1000 m/s, ten
// kilometres from the origin. Nothing crashes, no contact is missed, and every begin has an end.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "avatars/avatars.h"
#include "base/random.h"
#include "culling/culling.h"
#include "culling/triangles/triangle_bvh.h"
#include "scenes/run/simulation.h"

namespace throng::stress_test {
namespace {

constexpr uint64_t kSeed = 31;

double uniform(uint64_t id, uint64_t step, double low, double high, uint32_t index = 0) {
  return random_uniform({kSeed, id, step, Purpose::kBoxWorld}, low, high, index);
}

/// Standing adults at given places.
class StandIns : public PoseSource {
 public:
  StandIns() : adult_(load_model(adult_urdf())) {
    std::vector<PartShape> shapes;
    for (const Part& part : adult_->parts) {
      shapes.push_back({part.mesh.vertices, part.mesh.triangles});
      trees_.emplace_back(part.mesh.vertices, part.mesh.triangles);
    }
    const Gait gait(*adult_);
    type_ = std::make_shared<BodyType>(
        std::move(shapes),
        RootSphere{gait.sphere_centre_m(), gait.sphere_radius_m(), gait.upright_radius_m()}, false);
    standing_.resize(static_cast<size_t>(adult_->kinematics.column_count()));
    const float phase[] = {0}, speed[] = {0}, scale[] = {1};
    gait.postures(phase, speed, scale, standing_);
  }

  void place(uint32_t id, const Eigen::Vector3d& position, double turn_rad) {
    ids.push_back(id);
    types.push_back(0);
    scales.push_back(1);
    const Eigen::AngleAxisd turn(turn_rad, Eigen::Vector3d::UnitZ());
    roots.push_back({position, Eigen::Quaterniond(turn).cast<float>()});
  }
  void clear() {
    ids.clear();
    types.clear();
    scales.clear();
    roots.clear();
  }
  BodiesView view() const { return {ids, types, scales, roots}; }
  const std::shared_ptr<const BodyType>& type() const { return type_; }
  size_t parts() const { return trees_.size(); }

  void poses(std::span<const uint32_t> bodies, std::span<PartPose> out) const override {
    for (size_t i = 0; i < bodies.size(); ++i) {
      const RootFrame root{roots[bodies[i]].world_from_root, scales[bodies[i]]};
      forward_kinematics(adult_->kinematics, standing_, {&root, 1},
                         out.subspan(i * parts(), parts()));
    }
  }

  /// Returns the number of unreported touching pairs of parts; counts touching ones in `touching`.
  int missed_of(uint32_t a, uint32_t b, std::span<const PairKey> reported, int& touching) const {
    std::vector<PartPose> of_a(parts()), of_b(parts());
    poses({&a, 1}, of_a);
    poses({&b, 1}, of_b);
    const Eigen::Vector3f a_to_b = (roots[b].position_m - roots[a].position_m).cast<float>();
    int missed = 0;
    TriangleCounters counters;
    for (uint32_t i = 0; i < parts(); ++i)
      for (uint32_t j = 0; j < parts(); ++j) {
        if (!solids_touch(trees_[i], of_a[i], 1, trees_[j], of_b[j], 1, a_to_b, counters)) continue;
        ++touching;
        missed +=
            !std::binary_search(reported.begin(), reported.end(), PairKey(ids[a], ids[b], i, j));
      }
    return missed;
  }

  std::vector<uint32_t> ids;
  std::vector<uint16_t> types;
  std::vector<float> scales;
  std::vector<RootPose> roots;

 private:
  std::shared_ptr<const Model> adult_;
  std::vector<TriangleBvh> trees_;
  std::shared_ptr<const BodyType> type_;
  std::vector<float> standing_;
};

void expect_sorted(std::span<const PairKey> pairs) {
  EXPECT_EQ(std::adjacent_find(pairs.begin(), pairs.end(), std::greater_equal<>()), pairs.end());
  for (const PairKey& pair : pairs) ASSERT_LT(pair.a(), pair.b());
}

/// Begins minus ends since the start equal the touching pairs.
struct Balance {
  int64_t begun = 0, ended = 0;
  void add(const Culler& culler) {
    for (const PairEvent& event : culler.events())
      ++(event.kind == EventKind::kBegin ? begun : ended);
    EXPECT_EQ(begun - ended, static_cast<int64_t>(culler.pairs().size()));
  }
};

TEST(Stress, MissesNothingAtEightPeoplePerSquareMetre) {
  StandIns people;
  constexpr int kSide = 12;
  for (int i = 0; i < kSide * kSide; ++i) {
    const auto id = static_cast<uint64_t>(i);
    const double pitch_m = 1 / std::sqrt(8.0);
    const int column = i % kSide, row = i / kSide;
    people.place(static_cast<uint32_t>(i),
                 {pitch_m * column + uniform(id, 0, -0.05, 0.05),
                  pitch_m * row + uniform(id, 0, -0.05, 0.05, 1), 0},
                 uniform(id, 0, -3.1, 3.1, 2));
  }
  Workers workers(2);
  Culler culler({people.type()}, {}, workers);
  culler.step(people.view(), people);
  expect_sorted(culler.pairs());
  int touching = 0, missed = 0;
  for (uint32_t a = 0; a < people.ids.size(); ++a)
    for (uint32_t b = a + 1; b < people.ids.size(); ++b)
      if ((people.roots[a].position_m - people.roots[b].position_m).norm() < 1.0)
        missed += people.missed_of(a, b, culler.pairs(), touching);
  std::printf("[ figures ] 8 people a m2: %d pairs touch by triangles, %zu reported\n", touching,
              culler.pairs().size());
  EXPECT_EQ(missed, 0);
  EXPECT_GT(touching, 500);
}

TEST(Stress, FindsAllContactsInOnePoint) {
  StandIns people;
  constexpr uint32_t kPeople = 120;
  for (uint32_t id = 0; id < kPeople; ++id) people.place(id, {1, 2, 0}, 0);
  Workers workers(2);
  for (const PairSearch search : {PairSearch::kGrid, PairSearch::kSweep, PairSearch::kBrute}) {
    CullerOptions options;
    options.pair_search = search;
    Culler culler({people.type()}, options, workers);
    Balance balance;
    culler.step(people.view(), people);
    balance.add(culler);
    expect_sorted(culler.pairs());
    int touching = 0;
    EXPECT_EQ(people.missed_of(0, kPeople - 1, culler.pairs(), touching), 0);
    EXPECT_GE(touching, 15) << "a part touches itself in the other";
    EXPECT_EQ(culler.pairs().size() % (kPeople * (kPeople - 1) / 2), 0u)
        << "all couples stand alike";
    culler.finish();
    balance.add(culler);
  }
}

TEST(Stress, EndsPairsOfAvatarsThatLeave) {
  StandIns people;
  Workers workers(2);
  Culler culler({people.type()}, {}, workers);
  Balance balance;
  for (uint64_t frame = 0; frame < 120; ++frame) {
    people.clear();
    std::vector<bool> is_there(400);
    for (uint32_t id = 0; id < 400; ++id) {
      if (uniform(id, frame, 0, 1) < 0.5) continue;
      is_there[id] = true;
      people.place(id, {uniform(id, 0, 0, 9, 1), uniform(id, 0, 0, 9, 2), 0}, 0);
    }
    culler.step(people.view(), people);
    balance.add(culler);
    expect_sorted(culler.pairs());
    for (const PairKey& pair : culler.pairs())
      ASSERT_TRUE(is_there[pair.a()] && is_there[pair.b()]) << "frame " << frame;
  }
  // Down to no person, and back.
  people.clear();
  culler.step(people.view(), people);
  balance.add(culler);
  EXPECT_TRUE(culler.pairs().empty());
  EXPECT_GT(balance.begun, 10'000);
  culler.finish();
  balance.add(culler);
  EXPECT_EQ(balance.begun, balance.ended);
}

TEST(Stress, HandlesAThousandMetresPerSecond) {
  constexpr uint32_t kPeople = 100'000;
  StandIns people;
  for (uint32_t id = 0; id + 1 < kPeople; ++id) {
    const uint32_t column = id % 400, row = id / 400;
    people.place(id, {2.0 * column, 2.0 * row, 0}, 0);
  }
  people.place(kPeople - 1, Eigen::Vector3d::Zero(), 0);
  Workers workers(2);
  Culler culler({people.type()}, {}, workers);
  Balance balance;
  int touching = 0;
  // Contacts are found at sampled instants, 16.7 m apart.
  for (int frame = 0; frame < 12; ++frame) {
    Eigen::Vector3d& fast = people.roots.back().position_m;
    fast = {1000.0 / 60 * frame, 2.0 * frame + 0.1, 0};
    const auto column = static_cast<uint32_t>(std::lround(fast.x() / 2));
    culler.step(people.view(), people);
    balance.add(culler);
    for (const uint32_t near : {column, column + 1})
      EXPECT_EQ(people.missed_of(near + 400 * static_cast<uint32_t>(frame), kPeople - 1,
                                 culler.pairs(), touching),
                0);
  }
  EXPECT_GT(touching, 20);
  culler.finish();
  balance.add(culler);
  EXPECT_EQ(balance.begun, balance.ended);
}

TEST(Stress, IsIndependentOfTheOrigin) {
  std::vector<PairKey> expected;
  for (const double away : {0.0, 1e4, -1e4}) {
    StandIns people;
    for (uint32_t id = 0; id < 300; ++id)
      // Multiples of 1/1024 m, which doubles add exactly at all of these places.
      people.place(id,
                   {away + std::floor(uniform(id, 0, 0, 7, 0) * 1024) / 1024,
                    -away + std::floor(uniform(id, 0, 0, 7, 1) * 1024) / 1024, 0},
                   uniform(id, 0, -3, 3, 2));
    Workers workers(1);
    CullerOptions options;
    options.exact = true;
    Culler culler({people.type()}, options, workers);
    culler.step(people.view(), people);
    if (expected.empty()) expected.assign(culler.pairs().begin(), culler.pairs().end());
    EXPECT_TRUE(
        std::equal(expected.begin(), expected.end(), culler.pairs().begin(), culler.pairs().end()))
        << away << " m away";
  }
  EXPECT_GT(expected.size(), 500u);
}

TEST(Stress, EndsAllPairsOfADenseCrowd) {
  Scene scene = load_scene("corridor");
  std::vector<std::string> notes;
  scale_to(scene, 400, notes);
  scene.body_avoidance = false;  // for more contacts
  SimulationOptions options;
  options.threads = 2;
  Simulation simulation(std::move(scene), options);
  for (int i = 0; i < 240; ++i)
    for (const RootPose& root : simulation.step().roots)
      ASSERT_TRUE(root.position_m.allFinite()) << "frame " << i;
  const RunEnd end = simulation.finish();
  EXPECT_EQ(end.begins, end.ends);
  EXPECT_GT(end.begins, 100u);
}

}  // namespace
}  // namespace throng::stress_test
