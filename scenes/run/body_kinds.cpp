#include "scenes/run/body_kinds.h"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <utility>

#include "base/errors.h"
#include "base/limits.h"
#include "base/portable_math.h"
#include "crowd/crowd_plan.h"
#include "scenes/motion/external_avatars.h"

namespace throng {
namespace {

/// Float spheres must hold points that rounding moved, by up to an ulp at 10 km.
constexpr float kSphereSlack_m = 1e-3f;
static_assert(BodyType::kMaxParts == kMaxModelParts);
static_assert(kMaxModels + kMaxObstacles <= UINT16_MAX, "types of bodies are 16 bits");

}  // namespace

Kinds kinds_of(const Scene& scene) {
  Kinds kinds;
  std::vector<const Model*>
      walking;  // by kind; null for externally controlled kinds, which are never shared
  for (const Group& group : scene.groups) {
    if (group.body->part_count() < 1 || group.body->part_count() > BodyType::kMaxParts)
      throw InputError(group.model.string(),
                       fmt::format("a model of 1 to {} parts", BodyType::kMaxParts),
                       fmt::format("{}", group.body->part_count()));
    auto kind = walking.end();
    if (!group.is_external()) kind = std::find(walking.begin(), walking.end(), group.body.get());
    kinds.of_group.push_back(static_cast<uint16_t>(kind - walking.begin()));
    if (kind != walking.end()) continue;
    if (static_cast<int64_t>(kinds.models.size()) >= kMaxModels)
      throw InputError(
          scene.file.string(),
          fmt::format("at most {} models, one per externally controlled group", kMaxModels),
          "more");
    walking.push_back(group.is_external() ? nullptr : group.body.get());
    kinds.models.push_back(group.body);
  }
  return kinds;
}

RootSphere any_posture_sphere(const Model& model) {
  const float reach_m = reach_of(model) + kSphereSlack_m;
  return {Eigen::Vector3f::Zero(), reach_m, reach_m};
}

namespace {

struct Ball {
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();
  double radius_m = 0;
};

Ball ball_around(const std::vector<Eigen::Vector3f>& points) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3f& point : points) box.extend(point.cast<double>());
  Ball ball{box.center(), 0};
  for (const Eigen::Vector3f& point : points)
    ball.radius_m = std::max(ball.radius_m, (point.cast<double>() - ball.centre_m).norm());
  return ball;
}

std::pair<double, double> values_of(const Model& model, const Joint& joint,
                                    std::span<const ColumnSpan> spans) {
  double multiplier = 1, offset = 0;
  const Joint* leader = &joint;
  while (leader->mimic) {  // q = m (m' q' + o') + o
    offset += multiplier * leader->mimic->offset;
    multiplier *= leader->mimic->multiplier;
    leader = &model.robot.joints[static_cast<size_t>(leader->mimic->joint)];
  }
  const ColumnSpan& span = spans[static_cast<size_t>(model.kinematics.column_of(leader->name))];
  const double a = multiplier * static_cast<double>(span.low) + offset;
  const double b = multiplier * static_cast<double>(span.high) + offset;
  return std::minmax(a, b);
}

/// Ball around all images of a ball under the joint, in the frame of the parent link.
Ball moved(const Model& model, const Joint& joint, std::span<const ColumnSpan> spans, Ball ball) {
  if (joint.kind != Joint::Kind::kFixed) {
    const auto [low, high] = values_of(model, joint, spans);
    const double middle = 0.5 * (low + high), half = 0.5 * (high - low);
    if (joint.kind == Joint::Kind::kPrismatic) {
      ball.centre_m += middle * joint.axis;
      ball.radius_m += half;
    } else {
      // The centre moves on an arc; the ball around it has the chord as its diameter.
      const Eigen::Vector3d along = ball.centre_m.dot(joint.axis) * joint.axis;
      const Eigen::Vector3d out = ball.centre_m - along;
      // Far from zero, floats do not resolve angles: assume a full turn.
      const bool is_far = std::max(std::abs(low), std::abs(high)) > 8 * std::numbers::pi;
      const SinCos open =
          sin_cos(is_far ? 0.5 * std::numbers::pi : std::min(half, 0.5 * std::numbers::pi));
      const SinCos turn = sin_cos(is_far ? 0.0 : middle);
      const Eigen::Vector3d turned = turn.cos * out + turn.sin * joint.axis.cross(out);
      ball.centre_m = along + open.cos * turned;
      ball.radius_m += open.sin * out.norm();
    }
  }
  ball.centre_m = joint.parent_from_joint * ball.centre_m;
  return ball;
}

}  // namespace

RootSphere sphere_around(const Model& model, std::span<const ColumnSpan> spans) {
  std::vector<Ball> balls;
  double low_m = std::numeric_limits<double>::infinity(), high_m = -low_m;
  for (const Part& part : model.parts) {
    Ball ball = ball_around(part.mesh.vertices);
    for (int link = part.link; link > 0;) {
      const Joint& joint = model.robot.joints[static_cast<size_t>(link - 1)];
      ball = moved(model, joint, spans, ball);
      link = joint.parent_link;
    }
    low_m = std::min(low_m, ball.centre_m.z() - ball.radius_m);
    high_m = std::max(high_m, ball.centre_m.z() + ball.radius_m);
    balls.push_back(ball);
  }
  // Centre on the axis of the cylinder, whose radius is then that of the sphere.
  RootSphere sphere{{0, 0, static_cast<float>(0.5 * (low_m + high_m))}, 0, 0};
  const Eigen::Vector3d centre = sphere.centre_m.cast<double>();
  double radius_m = 0, upright_m = 0;
  for (const Ball& ball : balls) {
    const double apart_m = (ball.centre_m - centre).norm();
    radius_m = std::max(radius_m, apart_m + ball.radius_m);
    upright_m = std::max(upright_m, ball.centre_m.head<2>().norm() + ball.radius_m);
  }
  // As in reach_of(): float poses have rounding errors.
  sphere.radius_m = static_cast<float>(radius_m * 1.001) + kSphereSlack_m;
  sphere.upright_radius_m = static_cast<float>(upright_m * 1.001) + kSphereSlack_m;
  return sphere;
}

std::shared_ptr<const BodyType> body_type(const Model& model, const RootSphere& sphere,
                                          const PartVolumes& volumes) {
  std::vector<PartShape> shapes;
  for (const Part& part : model.parts) {
    shapes.push_back({part.mesh.vertices, part.mesh.triangles});
    if (!volumes.named.empty()) shapes.back().volume = volumes.of(part.name);
  }
  return std::make_shared<BodyType>(std::move(shapes), sphere, false);
}

std::shared_ptr<const BodyType> obstacle_type(const Obstacle& obstacle) {
  const std::vector<Eigen::Vector3f>& points = obstacle.mesh.vertices;
  Eigen::Vector3f low = points.front();
  Eigen::Vector3f high = low;
  for (const Eigen::Vector3f& point : points) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  RootSphere sphere{0.5f * (low + high), 0};
  for (const Eigen::Vector3f& point : points)
    sphere.radius_m = std::max(sphere.radius_m, (point - sphere.centre_m).norm());
  sphere.radius_m += kSphereSlack_m;
  return std::make_shared<BodyType>(std::vector<PartShape>{{points, obstacle.mesh.triangles}},
                                    sphere, true);
}

}  // namespace throng
