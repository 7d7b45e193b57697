// What culling is told of a body before it is posed.
#include "scenes/posing.h"

#include <gtest/gtest.h>

#include <array>

namespace throng {
namespace {

TEST(Posing, WhoIsMovedFromOutsideIsNotBoundedByTheGait) {
  const std::shared_ptr<const Model> adult = load_model(adult_urdf());
  const std::vector<float> row(static_cast<size_t>(adult->kinematics.column_count()));
  BodyStates bodies;
  bodies.types = {0, 0};
  bodies.roots.resize(2);
  bodies.scales = {1, 1};
  bodies.phases = {0, 0};
  bodies.speeds_mps = {0, 0};
  bodies.held_rows = {nullptr, row.data()};
  const Posing posing({adult}, bodies);
  const std::array<uint32_t, 2> both = {0, 1};
  std::array<RootBox, 2> boxes;
  posing.bounds(both, boxes);
  EXPECT_TRUE(boxes[0].is_known());
  EXPECT_FALSE(boxes[1].is_known()) << "an arm may reach out of the gait's box";
}

}  // namespace
}  // namespace throng
