// BodyMap places the contact points of a run on the skin of the body at rest.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "analysis/contacts/contact_sink.h"
#include "scenes/run/runner.h"
#include "scenes/run/simulation.h"

namespace throng::body_map_test {
namespace {

/// Distance from a point to a triangle: plane, edges and corners.
double distance_m(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                  const Eigen::Vector3d& c) {
  const auto to_edge = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    const Eigen::Vector3d way = to - from;
    const double along = std::clamp((p - from).dot(way) / way.squaredNorm(), 0.0, 1.0);
    return (p - from - along * way).norm();
  };
  double min_m = std::min({to_edge(a, b), to_edge(b, c), to_edge(c, a)});
  const Eigen::Vector3d normal = (b - a).cross(c - a).normalized();
  const Eigen::Vector3d foot = p - normal.dot(p - a) * normal;
  const bool inside = normal.dot((b - a).cross(foot - a)) >= 0 &&
                      normal.dot((c - b).cross(foot - b)) >= 0 &&
                      normal.dot((a - c).cross(foot - c)) >= 0;
  if (inside) min_m = std::min(min_m, (p - foot).norm());
  return min_m;
}

/// Triangles of the bundled adult with all joints at zero.
std::vector<std::array<Eigen::Vector3d, 3>> skin() {
  const std::shared_ptr<const Model> adult = load_model(adult_urdf());
  const std::vector<float> zeros(static_cast<size_t>(adult->kinematics.column_count()));
  std::vector<PartPose> poses(adult->parts.size());
  const RootFrame root;
  forward_kinematics(adult->kinematics, zeros, {&root, 1}, poses);
  std::vector<std::array<Eigen::Vector3d, 3>> triangles;
  for (size_t part = 0; part < poses.size(); ++part)
    for (const Eigen::Vector3i& triangle : adult->parts[part].mesh.triangles) {
      auto& corners = triangles.emplace_back();
      for (int i = 0; i < 3; ++i)
        corners[static_cast<size_t>(i)] =
            to_isometry(poses[part]) *
            adult->parts[part].mesh.vertices[static_cast<size_t>(triangle[i])].cast<double>();
    }
  return triangles;
}

/// Feeds a map and counts the contact points that it should hold.
struct Counted final : public Sink {
  SinkNeeds needs() const override { return {.postures = true}; }
  void begin(const RunInfo& run) override { map.emplace(run); }
  void frame(const RunInfo& run, const Frame& frame) override {
    map->frame(run, frame);
    for (const PairKey& pair : frame.pairs) {
      for (const uint32_t body : {pair.a(), pair.b()})
        seconds += body < run.model_of_avatar.size() ? run.step_s : 0;
    }
  }
  void end(const RunInfo&, const RunEnd&) override {}
  std::optional<BodyMap> map;
  double seconds = 0;
};

TEST(BodyMap, PlacesContactPointsOnTheSkin) {
  const auto triangles = skin();
  for (uint64_t seed = 1; seed <= 2; ++seed) {
    SCOPED_TRACE(fmt::format("seed {}", seed));
    Scene scene = load_scene("metro");
    scene.seed = seed;
    scene.exact = true;
    scene.proximity_m = seed == 1 ? 0.001 : 0;
    scene.contact_points = seed != 1;
    scene.duration_s = 6;
    EXPECT_TRUE(BodyMap::is_known(scene));
    Simulation simulation(std::move(scene), {});
    Counted counted;
    Sink* const sinks[] = {&counted};
    run(simulation, sinks);
    ASSERT_TRUE(counted.map->has_figure());
    EXPECT_NEAR(counted.map->total_s(), counted.seconds, 1e-6);
    double sum_s = 0, on_skin_s = 0;
    for (const BodyMap::TouchedPoint& touched : counted.map->touched()) {
      const Eigen::Vector3d at = touched.at_m.cast<double>();
      double min_m = 1;
      for (const auto& [a, b, c] : triangles) min_m = std::min(min_m, distance_m(at, a, b, c));
      sum_s += touched.seconds;
      // Half the diagonal of a cell. Points deep in another solid are not on the skin.
      if (min_m < 0.0045) on_skin_s += touched.seconds;
      EXPECT_LT(min_m, 0.1);
    }
    EXPECT_NEAR(sum_s, counted.seconds, 1e-6);
    EXPECT_GT(on_skin_s, 0.98 * sum_s);
  }
}

TEST(BodyMap, IsEmptyWithoutPeopleOrContacts) {
  Scene scene = load_scene("corridor");
  EXPECT_FALSE(BodyMap::is_known(scene));
  RunInfo empty_run;
  BodyMap map(empty_run);
  map.frame(empty_run, {});
  EXPECT_FALSE(map.has_figure());
}

TEST(BodyMap, IsDrawnWithTheOtherFigures) {
  if (!has_gnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  const std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) / "throng_body_map";
  Scene scene = load_scene("metro");
  scene.exact = true;
  scene.proximity_m = 0.001;
  scene.duration_s = 6;
  Simulation simulation(std::move(scene), {});
  ContactSink contacts(folder, true);
  Sink* const sinks[] = {&contacts};
  run(simulation, sinks);
  const auto bytes = std::filesystem::file_size(folder / "contact_body.svg");
  EXPECT_GT(bytes, 20'000u);
  EXPECT_LT(bytes, 1'000'000u) << "the body is not stored as an image";
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace throng::body_map_test
