#include "bench/paper/pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

#include "avatars/mesh/primitives.h"
#include "base/text.h"
#include "bench/paper/census.h"
#include "bench/paper/strategies.h"
#include "culling/exact/triangle_bvh.h"
#include "culling/volumes/pose_math.h"
#include "viewer/picture/volume_outline.h"

namespace throng::paper {
namespace {

constexpr int kFrames = 60;
const Eigen::Vector3f kColliding(0.85F, 0.10F, 0.08F);
const Eigen::Vector3f kMoving(0.40F, 0.52F, 0.68F);
const Eigen::Vector3f kStatic(0.62F, 0.60F, 0.55F);
const Eigen::Vector3f kWall(0.25F, 0.25F, 0.28F);
constexpr float kBarShare = 0.0012F;  // of the distance to the eye

/// The twelve edges of the box, as thin bars.
struct Frame {
  explicit Frame(double edge_m) {
    const double thickness_m = 0.004 * edge_m;
    for (int axis = 0; axis < 3; ++axis) {
      Eigen::Vector3d size = Eigen::Vector3d::Constant(thickness_m);
      size[axis] = edge_m;
      bars[static_cast<size_t>(axis)] = box_mesh(size);
    }
  }
  void add(double edge_m, std::vector<RenderItem>& items) const {
    for (int axis = 0; axis < 3; ++axis)
      for (int corner = 0; corner < 4; ++corner) {
        Eigen::Vector3d place(0, 0, 0.5 * edge_m);
        place[(axis + 1) % 3] += (corner % 2 == 0 ? -0.5 : 0.5) * edge_m;
        place[(axis + 2) % 3] += (corner / 2 == 0 ? -0.5 : 0.5) * edge_m;
        RenderItem item{&bars[static_cast<size_t>(axis)]};
        item.world_from_mesh.translation() = place.cast<float>();
        item.rgb = kWall;
        items.push_back(item);
      }
  }
  std::array<Mesh, 3> bars;
};

/// Things to draw, and the eye.
class Scenery {
 public:
  explicit Scenery(const Camera& camera) : camera_(camera) {}

  void add(const Object& object, const PartPose& pose, const Eigen::Vector3f& rgb) {
    RenderItem item{&object.mesh};
    item.world_from_mesh = to_isometry(pose).cast<float>();
    item.rgb = rgb;
    items_.push_back(item);
  }
  void add(VolumeKind kind, const BodyType& type, const PartPose& pose) {
    const VolumeOutline outline = outline_of(kind, type, 0, pose, 1);
    const float far = (camera_.eye_m - translation_m(pose)).norm();
    volumes_.add(outline, Eigen::Vector3f::Zero(), volume_rgb(name_of(kind)), kBarShare * far);
  }
  void add_box(double edge_m) {
    frame_.emplace(edge_m);
    frame_->add(edge_m, items_);
  }
  Image draw(int width, int height) {
    volumes_.append_to(items_);
    RenderOptions options;
    options.width = width;
    options.height = height;
    options.samples = 3;
    return render(items_, camera_, options);
  }

 private:
  Camera camera_;
  std::vector<RenderItem> items_;
  VolumeItems volumes_;
  std::optional<Frame> frame_;
};

/// The whole box; with the sphere of every object where asked.
Image draw_world(const std::vector<Object>& objects, const BoxWorld& world,
                 const std::vector<SlotPair>& pairs, bool with_spheres) {
  std::vector<uint8_t> collides(world.size());
  for (const SlotPair& pair : pairs) collides[pair.a] = collides[pair.b] = 1;
  const auto edge = static_cast<float>(world.options().edge_m);
  Camera camera;
  camera.target_m = {0, 0, 0.47F * edge};
  camera.eye_m = {1.05F * edge, -2.1F * edge, 1.35F * edge};
  Scenery scenery(camera);
  for (size_t i = 0; i < world.size(); ++i) {
    const Object& object = objects[i % objects.size()];
    const bool moves = world.velocities_mps()[i].squaredNorm() > 0;
    scenery.add(object, world.pose(i), collides[i] != 0 ? kColliding : moves ? kMoving : kStatic);
    if (with_spheres) scenery.add(VolumeKind::kSphere, *object.type, world.pose(i));
  }
  scenery.add_box(world.options().edge_m);
  return scenery.draw(800, 600);
}

const Object& object_named(const std::vector<Object>& objects, const char* name) {
  for (const Object& object : objects)
    if (object.name == name) return object;
  return objects.front();
}

/// A row of objects one beside the other, seen from the front.
class Row {
 public:
  explicit Row(const Object& object, size_t count)
      : object_(object), step_m_(2.5 * object.radius_m), scenery_(camera(count)) {}

  /// The next place of the row, turned.
  PartPose next(const Eigen::Quaterniond& turn) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = turn.toRotationMatrix();
    pose.translation() =
        Eigen::Vector3d(step_m_ * static_cast<double>(placed_++), 0, 1.4 * object_.radius_m);
    const PartPose placed = to_part_pose(pose);
    scenery_.add(object_, placed, kMoving);
    return placed;
  }
  void add(VolumeKind kind, const BodyType& type, const PartPose& pose) {
    scenery_.add(kind, type, pose);
  }
  Image draw() { return scenery_.draw(1200, 420); }

 private:
  Camera camera(size_t count) const {
    Camera out;
    const auto middle = static_cast<float>(0.5 * step_m_ * static_cast<double>(count - 1));
    const auto radius = static_cast<float>(object_.radius_m);
    out.vertical_fov_rad = 0.35F;
    out.target_m = {middle, 0, 1.25F * radius};
    out.eye_m = out.target_m + Eigen::Vector3f(0, -13.5F * radius, 4 * radius);
    return out;
  }

  const Object& object_;
  double step_m_;
  size_t placed_ = 0;
  Scenery scenery_;
};

const Eigen::Quaterniond kTurn(Eigen::AngleAxisd(0.6, Eigen::Vector3d::UnitY()) *
                               Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX()));

PartPose without_turn(const PartPose& pose) {
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  out.translation() = to_isometry(pose).translation();
  return to_part_pose(out);
}

/// The same object with its points turned, so that a volume along the world's axes is fitted to
/// them.
BodyType turned_type(const Object& object, const Eigen::Quaterniond& turn) {
  PartShape shape = object.shape;
  for (Eigen::Vector3f& p : shape.points) p = turn.cast<float>() * p;
  return BodyType({shape}, RootSphere{}, false);
}

Picture figure_1(const std::vector<Object>& objects) {
  const Object& object = object_named(objects, "lowerRightLeg");
  const BodyType turned = turned_type(object, kTurn);
  constexpr VolumeKind kKinds[] = {VolumeKind::kSphere, VolumeKind::kAabb, VolumeKind::kObb,
                                   VolumeKind::kKdop26, VolumeKind::kOrdop26};
  Row row(object, std::size(kKinds));
  for (const VolumeKind kind : kKinds) {
    const PartPose pose = row.next(kTurn);
    const bool is_ordop = kind == VolumeKind::kOrdop26;
    row.add(kind, is_ordop ? *object.type : turned, is_ordop ? pose : without_turn(pose));
  }
  return {"figure_01", "Figure 1: the five volumes around one object",
          "Sphere, AABB, OBB, k-DOP and or-DOP (k = 26) around the lower leg. The paper shows the "
          "volumes that it compares.",
          row.draw()};
}

Picture figure_2(const std::vector<Object>& objects) {
  const Object& object = object_named(objects, "lowerRightLeg");
  Row row(object, 5);
  for (const VolumeKind kind : {VolumeKind::kOrdop14, VolumeKind::kOrdop18, VolumeKind::kOrdop26})
    row.add(kind, *object.type, row.next(Eigen::Quaterniond::Identity()));
  for (const VolumeKind kind : {VolumeKind::kOrdop26, VolumeKind::kKdop26})
    row.add(kind, *object.type, row.next(kTurn));
  return {"figure_02", "Figure 2: the or-DOP, and what a turn does to it",
          "or-DOPs with 14, 18 and 26 faces; then the object turned, with its or-DOP 26, which "
          "turned along, and with the k-DOP 26, which is refitted to the turned volume and grows. "
          "The paper shows how a DOP is made and oriented.",
          row.draw()};
}

/// The pair whose triangles touch and whose sizes differ least, with its volumes alone.
Picture figure_11(const std::vector<Object>& objects, const BoxWorld& world,
                  const std::vector<SlotPair>& pairs) {
  const auto object = [&](uint32_t i) -> const Object& { return objects[i % objects.size()]; };
  const auto difference = [&](const SlotPair& pair) {
    return std::abs(object(pair.a).radius_m - object(pair.b).radius_m);
  };
  const SlotPair* best = nullptr;
  ExactCounters counters;
  for (const SlotPair& pair : pairs) {
    const Object &a = object(pair.a), &b = object(pair.b);
    if (!solids_touch({a.shape.points, a.shape.triangles}, world.pose(pair.a), 1,
                      {b.shape.points, b.shape.triangles}, world.pose(pair.b), 1,
                      Eigen::Vector3f::Zero(), counters))
      continue;
    if (best == nullptr || difference(pair) < difference(*best)) best = &pair;
  }
  if (best == nullptr) best = &pairs.front();
  // On the ground, so that there is a shadow.
  const double largest_m = std::max(object(best->a).radius_m, object(best->b).radius_m);
  const Eigen::Vector3d middle = 0.5 * (to_isometry(world.pose(best->a)).translation() +
                                        to_isometry(world.pose(best->b)).translation());
  Camera camera;
  camera.target_m = {0, 0, static_cast<float>(1.9 * largest_m)};
  camera.eye_m = camera.target_m + static_cast<float>(6.2 * largest_m) *
                                       Eigen::Vector3f(0.35F, -0.85F, 0.35F).normalized();
  Scenery scenery(camera);
  for (const uint32_t i : {best->a, best->b}) {
    Eigen::Isometry3d pose = to_isometry(world.pose(i));
    pose.pretranslate(Eigen::Vector3d(0, 0, 1.9 * largest_m) - middle);
    const PartPose placed = to_part_pose(pose);
    scenery.add(object(i), placed, kColliding);
    scenery.add(VolumeKind::kSphere, *object(i).type, placed);
    scenery.add(VolumeKind::kOrdop26, *object(i).type, placed);
  }
  return {"figure_11",
          fmt::format("Figure 11: a pair that collides, {} and {}", spoken(object(best->a).name),
                      spoken(object(best->b).name)),
          "Spheres and or-DOPs 26 of both; the triangles touch. The paper shows one colliding pair "
          "with its sphere and both or-DOPs.",
          scenery.draw(800, 600)};
}

std::vector<SlotPair> ordop_pairs(const std::vector<Object>& objects, const BoxWorld& world) {
  using Method = Turned<Ordop<26>>;
  const auto fitted = fit_all<Method>(objects);
  const float margin = margin_m(objects, world);
  ExactCounters unused;
  std::vector<SlotPair> pairs;
  for (uint32_t a = 0; a < world.size(); ++a)
    for (uint32_t b = a + 1; b < world.size(); ++b)
      if (Method::test(Method::update(fitted[a], objects[a], world.pose(a)),
                       Method::update(fitted[b], objects[b], world.pose(b)), margin, unused))
        pairs.push_back({a, b});
  return pairs;
}

Picture figure_4(const std::vector<Object>& objects, uint64_t seed) {
  BoxWorld world = world_of(objects, objects.size(), 0, part_one_box(objects, seed));
  std::vector<SlotPair> pairs;
  for (int frame = 0; frame < kFrames || (pairs.empty() && frame < 10 * kFrames); ++frame) {
    world.step();
    if (frame + 1 >= kFrames) pairs = ordop_pairs(objects, world);
  }
  return {"figure_04",
          fmt::format("Figure 4: the {} objects of Part I with their spheres; {} by "
                      "or-DOP (red)",
                      objects.size(), counted(pairs.size(), "pair collides", "pairs collide")),
          "The paper shows its 15 objects, each in its sphere.",
          draw_world(objects, world, pairs, true)};
}

}  // namespace

std::vector<Picture> pictures_of(const std::vector<Object>& objects, uint64_t seed) {
  std::vector<Picture> pictures{figure_1(objects), figure_2(objects), figure_4(objects, seed)};
  StrategyRun few(Strategy::kTwoPass, objects, 50, seed);
  StrategyRun many(Strategy::kTwoPass, objects, 350, seed);
  for (int frame = 0; frame < kFrames; ++frame) {
    few.frame();
    many.frame();
  }
  const std::vector<SlotPair> of_few = few.pairs(), of_many = many.pairs();
  pictures.push_back({"figure_05a",
                      fmt::format("Figure 5a: 50 objects, grey ones static; {} (red)",
                                  counted(of_few.size(), "pair collides", "pairs collide")),
                      "The paper shows 50 objects without volumes.",
                      draw_world(objects, few.world(), of_few, false)});
  pictures.push_back({"figure_05b", "Figure 5b: the same 50 objects with their spheres",
                      "The paper shows 50 objects with their spheres.",
                      draw_world(objects, few.world(), of_few, true)});
  if (!of_many.empty()) pictures.push_back(figure_11(objects, many.world(), of_many));
  pictures.push_back({"figure_12",
                      fmt::format("Figure 12: 350 objects, grey ones static; {} (red)",
                                  counted(of_many.size(), "pair collides", "pairs collide")),
                      "The paper shows 350 objects.",
                      draw_world(objects, many.world(), of_many, false)});
  return pictures;
}

}  // namespace throng::paper
