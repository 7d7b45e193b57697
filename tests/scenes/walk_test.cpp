// How people of a real scene walk: their feet on the ground, their bodies inside their bounds.
#include "scenes/run/walk.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "avatars/gait/gait_curves.h"
#include "scenes/run/simulation.h"

namespace throng {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

/// A bundled scene with so many people.
Scene small(const std::string& name, int people) {
  Scene scene = load_scene(name);
  scene.planted_feet = true;
  std::vector<std::string> notes;
  scale_to(scene, people, notes);
  return scene;
}

/// Looks at everybody's planted feet, frame by frame: by vertices of the posed foot.
class SlideMeter {
 public:
  explicit SlideMeter(const Simulation& simulation) : simulation_(simulation) {
    const Model& model = *simulation.info().models.front();
    for (const Part& part : model.parts)
      for (size_t side = 0; side < 2; ++side)
        if (part.name == (side == 0 ? "rightFoot" : "leftFoot"))
          parts_[side] = static_cast<size_t>(&part - model.parts.data());
    feet_.resize(simulation.info().model_of_avatar.size());
    // A stride is kStridePerRootSpeed times the root of speed times leg length.
    const float root = Gait(model).stride_length_m(1, 1) / static_cast<float>(kStridePerRootSpeed);
    leg_m_ = root * root;
  }

  void watch(const Frame& frame) {
    const Model& model = *simulation_.info().models.front();
    const BodyStates& bodies = simulation_.bodies();
    std::vector<PartPose> poses(model.parts.size());
    for (size_t id = 0; id < feet_.size(); ++id) {
      const size_t begin = frame.posture_offsets[id], end = frame.posture_offsets[id + 1];
      const RootFrame root{frame.roots[id].world_from_root, bodies.scales[id]};
      forward_kinematics(model.kinematics, frame.postures.subspan(begin, end - begin), {&root, 1},
                         poses);
      const float leg_m = leg_m_ * bodies.scales[id];
      const double stance =
          stance_fraction(static_cast<double>(std::max(0.0f, bodies.gait_mps[id]) / leg_m));
      for (size_t side = 0; side < 2; ++side) {
        const float phase = bodies.phases[id];
        const float own = side == 0 ? phase : phase + (phase < 0.5f ? 0.5f : -0.5f);
        watch(model.parts[parts_[side]].mesh, poses[parts_[side]], frame.roots[id].position_m,
              static_cast<double>(bodies.scales[id]), static_cast<double>(own) < stance,
              feet_[id][side]);
      }
    }
  }

  std::vector<double> slides_m;  ///< of each stance that ended

 private:
  struct Foot {
    bool was_planted = false;
    double slid_m = 0;
    size_t contact = 0;
    Vector3d was_m = Vector3d::Zero();
  };

  void watch(const Mesh& mesh, const PartPose& pose, const Vector3d& position, double scale,
             bool is_planted, Foot& foot) {
    if (!is_planted) {
      if (foot.was_planted) slides_m.push_back(foot.slid_m);
      foot = {};
      return;
    }
    const Isometry3d turned = to_isometry(pose);
    const auto place = [&](size_t v) -> Vector3d {
      return position + turned.linear() * (scale * mesh.vertices[v].cast<double>()) +
             turned.translation();
    };
    if (foot.was_planted) foot.slid_m += (place(foot.contact) - foot.was_m).head<2>().norm();
    foot.was_planted = true;
    double low = 1e9;
    for (size_t v = 0; v < mesh.vertices.size(); ++v)
      if (const Vector3d p = place(v); p.z() < low) low = p.z(), foot.contact = v, foot.was_m = p;
  }

  const Simulation& simulation_;
  std::array<size_t, 2> parts_{};
  std::vector<std::array<Foot, 2>> feet_;
  float leg_m_ = 1;
};

TEST(Walk, PlantedFeetOfARealCrowdStayWhereTheyArePut) {
  for (const char* name : {"plaza", "corridor"}) {
    Simulation simulation(small(name, 200), {});
    SlideMeter meter(simulation);
    for (int i = 0; i < 900; ++i) meter.watch(simulation.step());
    std::vector<double>& slides = meter.slides_m;
    ASSERT_GT(slides.size(), 2000u);
    std::sort(slides.begin(), slides.end());
    const auto at = [&](double share) {
      return slides[static_cast<size_t>(share * static_cast<double>(slides.size() - 1))];
    };
    std::printf(
        "%s, 200 people, 15 s: %zu steps slide %.1f mm in the median, %.1f mm at 95 %%, "
        "%.1f mm at 99 %%, %.1f mm at most\n",
        name, slides.size(), 1e3 * at(0.5), 1e3 * at(0.95), 1e3 * at(0.99), 1e3 * at(1));
    EXPECT_LT(at(0.5), 0.002) << name;
    EXPECT_LT(at(0.95), 0.01) << name;
    // What is left are steps of people who are stopped, pushed or turned all at once, and of those
    // whose stride is as long as the room of all postures: see docs/architecture.md.
    EXPECT_LT(at(0.99), 0.02) << name;
  }
}

/// What culling goes by before it poses anybody, against what it gets when it does.
TEST(Walk, EverybodyIsInsideTheBoundsGivenBeforePosing) {
  for (const char* name : {"plaza", "evacuation"}) {
    Simulation simulation(small(name, 120), {});
    const BodyStates& bodies = simulation.bodies();
    Workers workers(1);
    std::vector<ModelUse> uses(simulation.info().models.size());
    for (const GaitStyle style : bodies.styles) uses[0].styles.set(static_cast<size_t>(style));
    const Posing posing(simulation.info().models, uses, bodies, workers);
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
}  // namespace throng
