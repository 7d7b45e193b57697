// Walking in bundled scenes: planted feet, bodies within their bounds.
#include "scenes/motion/walk.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "scenes/run/body_tables.h"
#include "scenes/run/simulation.h"
#include "tests/scenes/slide_meter.h"

namespace throng::walk_test {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

/// Bundled scene with this many people.
Scene small(const std::string& name, int people) {
  Scene scene = load_scene(name);
  scene.planted_feet = true;
  std::vector<std::string> notes;
  scale_to(scene, people, notes);
  return scene;
}

/// Prints the slide of planted feet per step: median and percentiles.
void print_slides(const char* who, const char* name, const Slides& slides) {
  const auto mm = [&](double share) { return 1e3 * slides.quantile_m(share); };
  std::printf(
      "%s, 200 people%s, 15 s: %zu steps slide %.1f mm in the median, %.1f mm at 95 %%, "
      "%.1f mm at 99 %%, %.1f mm at most\n",
      name, who, slides.all_m.size(), mm(0.5), mm(0.95), mm(0.99), mm(1));
}

TEST(Walk, KeepsPlantedFeetInPlace) {
  for (const char* name : {"plaza", "corridor"}) {
    Scene scene = small(name, 200);
    scene.body_avoidance = false;
    Slides slides;
    for (scene.seed = 1; scene.seed <= 3; ++scene.seed) {
      Simulation simulation(scene, {});
      SlideMeter meter(simulation);
      for (int i = 0; i < 900; ++i) meter.watch(simulation.step());
      slides.add(meter.slides);
    }
    ASSERT_GT(slides.all_m.size(), 10000u);
    print_slides(", three seeds", name, slides);
    EXPECT_LT(slides.quantile_m(0.5), 0.002) << name;
    EXPECT_LT(slides.quantile_m(0.95), 0.01) << name;
    // The rest are steps of people who stop, are pushed or turn abruptly, and strides at the limit
    // of the bounds.
    EXPECT_LT(slides.quantile_m(0.99), 0.02) << name;
  }
}

/// Feet that avoid other feet may end a stance farther behind than a leg reaches; these slide.
TEST(Walk, KeepsMostFeetInPlaceWithBodyAvoidance) {
  for (const char* name : {"plaza", "corridor"}) {
    Simulation simulation(small(name, 200), {});
    SlideMeter meter(simulation);
    for (int i = 0; i < 900; ++i) meter.watch(simulation.step());
    ASSERT_GT(meter.slides.all_m.size(), 2000u);
    print_slides(" with body avoidance", name, meter.slides);
    EXPECT_LT(meter.slides.quantile_m(0.5), 0.002) << name;
  }
}

/// Bounds that culling uses before posing contain the posed vertices.
TEST(Walk, KeepsBodiesWithinTheirBounds) {
  for (const char* name : {"plaza", "evacuation"}) {
    Simulation simulation(small(name, 120), {});
    const BodyStates& bodies = simulation.bodies();
    Workers workers(1);
    std::vector<ModelUse> uses(simulation.info().models.size());
    for (const GaitStyle style : bodies.styles) uses[0].styles.set(static_cast<size_t>(style));
    BodyTables tables;
    const Posing posing(simulation.info().models, uses, bodies, tables, workers);
    const RootSphere sphere = posing.sphere(0);
    const Model& model = *simulation.info().models.front();
    std::vector<PartPose> poses(model.parts.size());
    int shifted = 0;
    for (int i = 0; i < 360; ++i) {
      const Frame& frame = simulation.step();
      if (i % 15 != 0) continue;
      for (uint32_t id = 0; id < frame.roots.size(); ++id) {
        shifted += std::hypot(bodies.feet[0][id], bodies.feet[1][id]) > 0.002f;
        RootBox box;
        posing.bounds({&id, 1}, {&box, 1});
        posing.poses({&id, 1}, poses);
        ASSERT_TRUE(box.is_known());
        const float scale = bodies.scales[id];
        const Eigen::Matrix3d root_from_world =
            frame.roots[id].world_from_root.conjugate().toRotationMatrix().cast<double>();
        for (size_t part = 0; part < poses.size(); ++part) {
          const Isometry3d pose = to_isometry(poses[part]);
          for (const Eigen::Vector3f& vertex : model.parts[part].mesh.vertices) {
            const Eigen::Vector3f p =
                (root_from_world * (pose * (static_cast<double>(scale) * vertex.cast<double>())))
                    .cast<float>();
            for (int axis = 0; axis < 3; ++axis) {
              ASSERT_GE(p[axis], box.min_m[axis]) << name << ", " << id << ", frame " << i;
              ASSERT_LE(p[axis], box.max_m[axis]) << name << ", " << id << ", frame " << i;
            }
            ASSERT_LE(p.head<2>().norm(), scale * sphere.upright_radius_m);
            ASSERT_LE((p - scale * sphere.centre_m).norm(), scale * sphere.radius_m);
          }
        }
      }
    }
    EXPECT_GT(shifted, 500) << name;
  }
}

}  // namespace
}  // namespace throng::walk_test
