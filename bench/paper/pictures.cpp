#include "bench/paper/pictures.h"

#include <fmt/format.h>

#include <array>

#include "avatars/mesh/primitives.h"
#include "bench/paper/census.h"
#include "bench/paper/strategies.h"

namespace throng::paper {
namespace {

constexpr int kFrames = 60;
const Eigen::Vector3f kColliding(0.85F, 0.10F, 0.08F);
const Eigen::Vector3f kMoving(0.40F, 0.52F, 0.68F);
const Eigen::Vector3f kStatic(0.62F, 0.60F, 0.55F);
const Eigen::Vector3f kWall(0.25F, 0.25F, 0.28F);

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

Image draw_world(const std::vector<Object>& objects, const BoxWorld& world,
                 const std::vector<SlotPair>& pairs) {
  std::vector<uint8_t> collides(world.size());
  for (const SlotPair& pair : pairs) collides[pair.a] = collides[pair.b] = 1;
  std::vector<RenderItem> items;
  for (size_t i = 0; i < world.size(); ++i) {
    RenderItem item{&objects[i % objects.size()].mesh};
    item.world_from_mesh = to_isometry(world.pose(i)).cast<float>();
    const bool moves = world.velocities_mps()[i].squaredNorm() > 0;
    item.rgb = collides[i] != 0 ? kColliding : moves ? kMoving : kStatic;
    items.push_back(item);
  }
  const double edge_m = world.options().edge_m;
  const Frame frame(edge_m);
  frame.add(edge_m, items);
  const auto edge = static_cast<float>(edge_m);
  Camera camera;
  camera.target_m = {0, 0, 0.47F * edge};
  camera.eye_m = {1.05F * edge, -2.1F * edge, 1.35F * edge};
  RenderOptions options;
  options.width = 800;
  options.height = 600;
  return render(items, camera, options);
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

}  // namespace

std::vector<Picture> pictures_of(const std::vector<Object>& objects, uint64_t seed) {
  std::vector<Picture> pictures;
  BoxWorld world = world_of(objects, objects.size(), 0, part_one_box(seed));
  std::vector<SlotPair> pairs;
  for (int frame = 0; frame < kFrames || (pairs.empty() && frame < 10 * kFrames); ++frame) {
    world.step();
    if (frame + 1 >= kFrames) pairs = ordop_pairs(objects, world);
  }
  pictures.push_back(
      {"figure_04",
       fmt::format("Figure 4: the 15 objects of Part I; {} pairs collide (red)", pairs.size()),
       draw_world(objects, world, pairs)});
  const std::array<std::pair<size_t, const char*>, 3> sizes = {
      {{50, "05"}, {350, "11"}, {500, "12"}}};
  for (const auto& [size, figure] : sizes) {
    StrategyRun run(Strategy::kTwoPass, objects, size, seed);
    for (int frame = 0; frame < kFrames; ++frame) run.frame();
    const std::vector<SlotPair> found = run.pairs();
    pictures.push_back(
        {fmt::format("figure_{}", figure),
         fmt::format("Figure {}: {} objects, grey ones static; {} pairs collide (red)",
                     std::stoi(figure), size, found.size()),
         draw_world(objects, run.world(), found)});
  }
  return pictures;
}

}  // namespace throng::paper
