// Bounds and postures that culling uses before and after posing.
#include "scenes/run/posing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "scenes/motion/walk.h"
#include "scenes/run/body_tables.h"
#include "tests/same_bits.h"

namespace throng::posing_test {
namespace {

TEST(Posing, DoesNotBoundExternalPosturesByTheGait) {
  const std::shared_ptr<const Model> adult = load_model(adult_urdf());
  const std::vector<float> row(static_cast<size_t>(adult->kinematics.column_count()));
  BodyStates bodies;
  bodies.types = {0, 1};
  bodies.roots.resize(2);
  bodies.scales = {1, 1};
  bodies.phases = {0, 0};
  bodies.resize_steps(2);
  bodies.external_rows = {nullptr, row.data()};
  const std::array<ModelUse, 2> uses = {ModelUse{}, ModelUse{{}, PostureKind::kExternal}};
  Workers workers(1);
  BodyTables tables;
  const Posing posing({adult, adult}, uses, bodies, tables, workers);
  advance_walk(posing, std::array<WalkInput, 2>{}, 0.1, 0, SimdTarget::kScalar, bodies);
  const std::array<uint32_t, 2> both = {0, 1};
  std::array<RootBox, 2> boxes;
  posing.bounds(both, boxes);
  EXPECT_TRUE(boxes[0].is_known());
  EXPECT_FALSE(boxes[1].is_known()) << "an arm may reach out of the gait's box";
}

TEST(Posing, KeepsAllStylesWithinCommonBounds) {
  const std::shared_ptr<const Model> adult = load_model(adult_urdf());
  constexpr uint32_t kAvatars = 60;
  BodyStates bodies;
  std::vector<uint32_t> ids;
  for (uint32_t id = 0; id < kAvatars; ++id) {
    ids.push_back(id);
    bodies.types.push_back(0);
    bodies.scales.push_back(1);
    bodies.styles.push_back(static_cast<GaitStyle>(id % 3 == 0 ? 0 : id % kGaitStyleCount));
    bodies.phases.push_back(static_cast<float>(id) / kAvatars);
  }
  bodies.roots.resize(kAvatars);
  bodies.resize_steps(kAvatars);
  std::vector<float> looks;
  for (uint32_t id = 0; id < kAvatars; ++id)
    looks.push_back((id % 5 < 3 ? 0.25f : -0.2f) * static_cast<float>(id % 3));
  bodies.head_yaws_rad = looks;
  const std::array<ModelUse, 1> all = {ModelUse{GaitStyles().set(), PostureKind::kStepping}};
  Workers workers(2);
  BodyTables tables;
  const Posing posing({adult}, all, bodies, tables, workers);
  const std::vector<WalkInput> comes_in(kAvatars, WalkInput{{}, 1.4f, true});
  advance_walk(posing, comes_in, 0.1, 0, SimdTarget::kScalar, bodies);
  const auto columns = static_cast<size_t>(posing.column_count(0));
  std::vector<float> rows(kAvatars * columns), own(columns);
  posing.postures(0, kAvatars, rows);
  std::vector<Gait> gaits;
  for (size_t style = 0; style < kGaitStyleCount; ++style)
    gaits.emplace_back(*adult, static_cast<GaitStyle>(style));
  const size_t parts = adult->parts.size();
  std::vector<PartPose> poses(ids.size() * parts);
  posing.poses(ids, poses);
  std::vector<RootBox> boxes(kAvatars);
  posing.bounds(ids, boxes);
  const RootSphere sphere = posing.sphere(0);
  for (const uint32_t id : ids) {
    SCOPED_TRACE(id);
    const Gait& gait = gaits[static_cast<size_t>(bodies.styles[id])];
    gait.postures({&bodies.phases[id], 1}, {&bodies.gait_mps[id], 1}, {&bodies.scales[id], 1}, own);
    gait.apply_head_yaw(looks[id], own);
    // Legs are recomputed to the same feet: near a straight knee 1 mm is half a degree.
    for (size_t c = 0; c < columns; ++c) EXPECT_NEAR(own[c], rows[id * columns + c], 0.02f);
    for (size_t part = 0; part < parts; ++part)
      for (const Eigen::Vector3f& vertex : adult->parts[part].mesh.vertices) {
        const Eigen::Vector3f p =
            (to_isometry(poses[id * parts + part]) * vertex.cast<double>()).cast<float>();
        ASSERT_LE((p - sphere.centre_m).norm(), sphere.radius_m);
        ASSERT_LE(p.head<2>().norm(), sphere.upright_radius_m);
        for (int axis = 0; axis < 3; ++axis) {
          ASSERT_GE(p[axis], boxes[id].min_m[axis]);
          ASSERT_LE(p[axis], boxes[id].max_m[axis]);
        }
      }
  }
}

TEST(Posing, ReadsExternalRowsInPlace) {
  const std::shared_ptr<const Model> adult = load_model(adult_urdf());
  const auto columns = static_cast<size_t>(adult->kinematics.column_count());
  std::vector<float> external(columns, 0.1f), scratch(2 * columns, 7.0f);
  BodyStates bodies;
  bodies.external_rows = {nullptr, external.data()};
  const uint32_t external_id = 1;
  const float* row = nullptr;
  ModelGaits gaits;
  gaits.of_style(0) = std::make_unique<Gait>(*adult);
  make_posture_provider(PostureKind::kExternal, gaits, bodies)
      ->rows({&external_id, 1}, scratch, {&row, 1});
  EXPECT_EQ(row, external.data());
  EXPECT_EQ(scratch, std::vector<float>(2 * columns, 7.0f));
}

TEST(Posing, IsIndependentOfPrecomputedRows) {
  const std::shared_ptr<const Model> adult = load_model(adult_urdf());
  const auto columns = static_cast<size_t>(adult->kinematics.column_count());
  constexpr uint32_t kAvatars = 200;
  for (const PostureKind kind :
       {PostureKind::kExternal, PostureKind::kStepping, PostureKind::kTable}) {
    SCOPED_TRACE(static_cast<int>(kind));
    const std::vector<float> external(columns, 0.1f);
    BodyStates bodies;
    bodies.types.assign(kAvatars, 0);
    bodies.scales.assign(kAvatars, 1.1f);
    bodies.roots.resize(kAvatars);
    bodies.external_rows.assign(kAvatars, external.data());
    for (uint32_t id = 0; id < kAvatars; ++id)
      bodies.phases.push_back(static_cast<float>(id) / kAvatars);
    bodies.resize_steps(kAvatars);
    Workers workers(1);
    BodyTables tables;
    Posing posing({adult}, std::array<ModelUse, 1>{ModelUse{{}, kind}}, bodies, tables, workers);
    for (uint32_t first = 0; first < kAvatars; first += 50)
      advance_walk(posing, std::vector<WalkInput>(50, WalkInput{{}, 1.3f, true}), 0.1, first,
                   SimdTarget::kScalar, bodies);
    std::vector<float> rows(kAvatars * columns);
    std::vector<size_t> offsets;
    for (size_t id = 0; id < kAvatars; ++id) offsets.push_back(id * columns);
    posing.postures(0, kAvatars, rows);
    const std::array<uint32_t, 3> some = {199, 3, 128};
    std::vector<PartPose> computed(3 * adult->parts.size()), read(computed.size());
    posing.poses(some, computed);
    posing.use_rows(rows, offsets);
    posing.poses(some, read);
    EXPECT_TRUE(same_bits(std::span<const PartPose>(computed), std::span<const PartPose>(read)));
  }
}

}  // namespace
}  // namespace throng::posing_test
