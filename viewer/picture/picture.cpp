#include "viewer/picture/picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <utility>

#include "avatars/gait/gait.h"
#include "viewer/picture/clothes.h"
#include "viewer/picture/volume_outline.h"

namespace throng {
namespace {

using BodyPart = std::pair<uint32_t, uint32_t>;

const Eigen::Vector3f kObstacle(0.485F, 0.451F, 0.397F);
/// Touching parts glow a little: shadow does not hide them in a crowd.
constexpr float kGlow = 1.25F;
constexpr float kPersonHeight_m = 1.7F;
constexpr float kBarShare = 0.0012F;  // fraction of the distance: equally wide near and far
constexpr const char* kBodySphere = "body-sphere";
constexpr const char* kBodyBox = "body-box";

using PartLevels = std::map<BodyPart, PairLevel>;

/// Returns the highest level of each part's pairs.
PartLevels parts_in_touch(const RunReader::Touching& pairs) {
  PartLevels parts;
  for (const auto& [pair, level] : pairs)
    for (const BodyPart& part :
         {BodyPart(pair.a(), pair.part_a()), BodyPart(pair.b(), pair.part_b())}) {
      const auto [at, is_new] = parts.try_emplace(part, level);
      if (!is_new) at->second = std::max(at->second, level);
    }
  return parts;
}

std::optional<PairLevel> level_of(const BodyPart& part, const PartLevels& in_touch) {
  for (const uint32_t touched : {part.second, kWholeBody})
    if (const auto found = in_touch.find({part.first, touched}); found != in_touch.end())
      return found->second;
  return std::nullopt;
}

Mesh to_mesh(const mesh_t& received) {
  Mesh mesh;
  for (size_t i = 0; i + 2 < received.coordinates_m.size(); i += 3)
    mesh.vertices.emplace_back(received.coordinates_m[i], received.coordinates_m[i + 1],
                               received.coordinates_m[i + 2]);
  for (size_t i = 0; i + 2 < received.indices.size(); i += 3)
    mesh.triangles.emplace_back(received.indices[i], received.indices[i + 1],
                                received.indices[i + 2]);
  return mesh;
}

Eigen::Isometry3f world_from(const RootPose& root, const PartPose& pose) {
  Eigen::Isometry3d world = to_isometry(pose);
  world.pretranslate(root.position_m);
  return world.cast<float>();
}

/// A body's shape, coarser with the distance.
struct DetailLevel {
  float max_pixel_m;  ///< drawn up to this size of a pixel at the body
  Shape (*shape)(const Mesh&);
};
const std::array<DetailLevel, 6> kLevels = {
    {{0.007F, [](const Mesh& m) { return shape_of(m); }},
     {0.016F, [](const Mesh& m) { return shape_of(simplified(m, 0.014F)); }},
     {0.035F, [](const Mesh& m) { return shape_of(simplified(m, 0.028F)); }},
     {0.070F, [](const Mesh& m) { return shape_of(sleeve(m, 6, 8), Edges::kSmooth); }},
     {0.140F, [](const Mesh& m) { return shape_of(sleeve(m, 3, 5), Edges::kSmooth); }},
     {std::numeric_limits<float>::max(),
      [](const Mesh& m) { return shape_of(sleeve(m, 2, 4), Edges::kSmooth); }}}};
/// Shadows have no light and shade: sleeves suffice.
constexpr size_t kFinestShadowLevel = 3;
constexpr int kPeoplePerBlock = 64;

size_t level_for(float pixel_m) {
  size_t level = 0;
  while (pixel_m > kLevels[level].max_pixel_m) ++level;
  return level;
}

}  // namespace

/// A part with its shape at each level of detail.
struct DrawnPart {
  explicit DrawnPart(const Part& part) : slot(slot_of(part.name)) {
    for (size_t level = 0; level < kLevels.size(); ++level) {
      levels[level] = kLevels[level].shape(part.mesh);
      if (slot == Slot::kSkin) add_hair(part, levels[level]);
    }
  }
  Slot slot;
  std::array<Shape, kLevels.size()> levels;
};

namespace {

/// A person or robot in a frame.
struct Body {
  uint32_t avatar;
  const RootPose& root;
  float scale;
  const std::vector<PartPose>& poses;
};

void add_body(const std::vector<DrawnPart>& parts, const Body& body, size_t level,
              const PartLevels& in_touch, std::vector<RenderItem>& items) {
  const auto first_touched = in_touch.lower_bound({body.avatar, 0});
  const bool touches = first_touched != in_touch.end() && first_touched->first.first == body.avatar;
  for (size_t i = 0; i < parts.size(); ++i) {
    const DrawnPart& part = parts[i];
    RenderItem item{&part.levels[level], world_from(body.root, body.poses[i]), body.scale};
    item.rgb = clothes_rgb(part.slot, body.avatar);
    item.second_rgb = clothes_rgb(Slot::kHair, body.avatar);
    item.shadow = &part.levels[std::max(level, kFinestShadowLevel)];
    if (touches)
      if (const std::optional<PairLevel> touching =
              level_of({body.avatar, static_cast<uint32_t>(i)}, in_touch))
        item.rgb = item.second_rgb = kGlow * mark_rgb(*touching);
    items.push_back(item);
  }
}

std::unique_ptr<const BodyType> type_of(const Model& model) {
  std::vector<PartShape> shapes;
  for (const Part& part : model.parts) shapes.push_back({part.mesh.vertices, part.mesh.triangles});
  return std::make_unique<const BodyType>(std::move(shapes), RootSphere{}, false);
}

VolumeOutline body_sphere(const Gait& gait, const RootPose& root, float scale) {
  return sphere_outline(root.world_from_root * Eigen::Vector3f(scale * gait.sphere_centre_m()),
                        scale * gait.sphere_radius_m());
}

VolumeOutline body_box(const BodyType& type, std::span<const PartPose> poses, float scale) {
  Eigen::AlignedBox3f box;
  for (size_t part = 0; part < poses.size(); ++part)
    for (const Eigen::Vector3f& p :
         outline_of(VolumeKind::kAabb, type, part, poses[part], scale).faces.vertices)
      box.extend(p);
  return box_outline(box.min(), box.max());
}

void add_outlines(const BodyType& type, const Gait& gait, std::span<const PartPose> poses,
                  const RootPose& root, float scale, const std::vector<std::string>& layers,
                  float thickness_m, VolumeItems& out) {
  const Eigen::Vector3f root_m = root.position_m.cast<float>();
  for (const std::string& layer : layers) {
    const auto add = [&](const VolumeOutline& outline) {
      out.add(outline, root_m, volume_rgb(layer), thickness_m);
    };
    if (layer == kBodySphere) add(body_sphere(gait, root, scale));
    if (layer == kBodyBox) add(body_box(type, poses, scale));
    if (const std::optional<VolumeKind> kind = volume_of(layer))
      for (size_t part = 0; part < poses.size(); ++part)
        add(outline_of(*kind, type, part, poses[part], scale));
  }
}

/// Returns the distance to the eye from which all present avatars are in the picture, head to foot.
float distance_to_all(const CrowdState& crowd, const Eigen::Vector3f& target_m,
                      const Eigen::Vector3f& back, float half_width, float half_height) {
  constexpr float kRimFactor = 1.06F;  // at the rim: arms, shadows
  const Eigen::Vector3f right = Eigen::Vector3f::UnitZ().cross(back).normalized();
  const Eigen::Vector3f up = back.cross(right);
  float distance_m = 3 * kPersonHeight_m;
  for (size_t avatar = 0; avatar < crowd.roots.size(); ++avatar) {
    if (crowd.present[avatar] == 0) continue;
    for (const float z_m : {0.0F, kPersonHeight_m}) {
      const Eigen::Vector3f point =
          crowd.roots[avatar].position_m.cast<float>() + Eigen::Vector3f(0, 0, z_m) - target_m;
      const float aside =
          std::max(std::abs(point.dot(right)) / half_width, std::abs(point.dot(up)) / half_height);
      distance_m = std::max(distance_m, point.dot(back) + kRimFactor * aside);
    }
  }
  return distance_m;
}

/// Returns the centre of the bounding box of all present avatars.
Eigen::Vector3f middle_of(const CrowdState& crowd) {
  Eigen::AlignedBox3d box;
  for (size_t avatar = 0; avatar < crowd.roots.size(); ++avatar)
    if (crowd.present[avatar] != 0) box.extend(crowd.roots[avatar].position_m);
  if (box.isEmpty()) return Eigen::Vector3f::Zero();
  return box.center().cast<float>();
}

/// Returns a camera to the south-east and above, from which the crowd fills the picture.
Camera camera_of(const CrowdState& crowd, const PictureOptions& options) {
  Camera camera;
  camera.vertical_fov_rad = options.fov_rad;
  camera.target_m =
      options.target_m.value_or(middle_of(crowd) + Eigen::Vector3f(0, 0, 0.5F * kPersonHeight_m));
  const float aspect = static_cast<float>(options.width) / static_cast<float>(options.height);
  const float half_height = std::tan(0.5F * camera.vertical_fov_rad);
  const float half_width = half_height * std::max(aspect, 0.1F);
  const Eigen::Vector3f back = Eigen::Vector3f(0.45F, -0.75F, 0.5F).normalized();
  const float distance_m = distance_to_all(crowd, camera.target_m, back, half_width, half_height);
  camera.eye_m = options.eye_m.value_or(camera.target_m + distance_m * back);
  return camera;
}

}  // namespace

struct CrowdPainter::DrawnModel {
  explicit DrawnModel(const Model& model) {
    for (const Part& part : model.parts) parts.emplace_back(part);
  }
  std::vector<DrawnPart> parts;
  std::unique_ptr<const BodyType> type;  ///< for volumes only
  std::unique_ptr<const Gait> gait;
};

CrowdPainter::CrowdPainter(RecordedFrame& frame, PictureOptions options, int threads)
    : frame_(frame), options_(std::move(options)), workers_(threads) {
  for (const obstacle_t& obstacle : frame.run().run()->obstacles)
    obstacles_.push_back(shape_of(to_mesh(obstacle.mesh)));
  models_.resize(frame.run().run()->models.size());
}

CrowdPainter::~CrowdPainter() = default;

void CrowdPainter::fix_camera() {
  const Camera camera = camera_of(frame_.crowd(), options_);
  options_.eye_m = camera.eye_m;
  options_.target_m = camera.target_m;
}

Image CrowdPainter::paint() {
  const Camera camera = camera_of(frame_.crowd(), options_);
  std::vector<RenderItem> items;
  add_people(camera, items);
  add_obstacles(items);
  VolumeItems volumes;
  if (!options_.volumes.empty()) add_volumes(camera, volumes);
  volumes.append_to(items);
  RenderOptions render_options;
  render_options.width = options_.width;
  render_options.height = options_.height;
  if (!frame_.floor().vertices.empty()) render_options.floor = &frame_.floor();
  return render(items, camera, render_options, workers_);
}

CrowdPainter::DrawnModel& CrowdPainter::model(size_t index) {
  if (models_[index] == nullptr)
    models_[index] = std::make_unique<DrawnModel>(*frame_.run().model(index));
  return *models_[index];
}

void CrowdPainter::add_people(const Camera& camera, std::vector<RenderItem>& items) {
  const CrowdState& crowd = frame_.crowd();
  const run_description_t& run = *frame_.run().run();
  const PartLevels in_touch = parts_in_touch(frame_.touching());
  const Eigen::Vector3f ahead = (camera.target_m - camera.eye_m).normalized();
  const float focal_px = focal_length_px(camera, options_.height);
  const auto count = static_cast<int>(crowd.roots.size());
  for (size_t avatar = 0; avatar < crowd.roots.size(); ++avatar)  // threads below only read models
    if (crowd.present[avatar] != 0) model(static_cast<size_t>(run.model_of_avatar[avatar]));
  const int blocks = (count + kPeoplePerBlock - 1) / kPeoplePerBlock;
  std::vector<std::vector<RenderItem>> items_of_block(static_cast<size_t>(blocks));
  workers_.for_blocks(blocks, [&](int block, int) {
    std::vector<PartPose> poses;
    const int end = std::min(count, (block + 1) * kPeoplePerBlock);
    for (int id = block * kPeoplePerBlock; id < end; ++id) {
      const auto avatar = static_cast<size_t>(id);
      if (crowd.present[avatar] == 0) continue;
      frame_.run().part_poses(id, poses);
      const RootPose& root = crowd.roots[avatar];
      const float scale = run.scale_of_avatar[avatar];
      const float depth_m = ahead.dot(root.position_m.cast<float>() - camera.eye_m);
      add_body(models_[static_cast<size_t>(run.model_of_avatar[avatar])]->parts,
               {static_cast<uint32_t>(id), root, scale, poses},
               level_for(std::max(0.0F, depth_m) / focal_px / scale), in_touch,
               items_of_block[static_cast<size_t>(block)]);
    }
  });
  for (const std::vector<RenderItem>& block : items_of_block)
    items.insert(items.end(), block.begin(), block.end());
}

/// Obstacles keep their colour: one hand on a wall would paint the whole wall.
void CrowdPainter::add_obstacles(std::vector<RenderItem>& items) const {
  for (size_t i = 0; i < obstacles_.size(); ++i) {
    const obstacle_t& obstacle = frame_.run().run()->obstacles[i];
    RenderItem item{&obstacles_[i]};
    item.world_from_shape.rotate(
        Eigen::AngleAxisf(static_cast<float>(obstacle.heading_rad), Eigen::Vector3f::UnitZ()));
    item.world_from_shape.pretranslate(
        Eigen::Map<const Eigen::Vector3d>(obstacle.centre_m).cast<float>());
    item.rgb = kObstacle;
    item.shadow = item.shape;
    items.push_back(item);
  }
}

void CrowdPainter::add_volumes(const Camera& camera, VolumeItems& out) {
  const CrowdState& crowd = frame_.crowd();
  const run_description_t& run = *frame_.run().run();
  const std::vector<uint32_t>& chosen = options_.volumes_of;
  std::vector<PartPose> poses;
  for (size_t avatar = 0; avatar < crowd.roots.size(); ++avatar) {
    const auto id = static_cast<uint32_t>(avatar);
    const bool is_asked =
        chosen.empty() || std::find(chosen.begin(), chosen.end(), id) != chosen.end();
    if (crowd.present[avatar] == 0 || !is_asked) continue;
    const auto index = static_cast<size_t>(run.model_of_avatar[avatar]);
    DrawnModel& body = model(index);
    if (body.type == nullptr) {
      body.type = type_of(*frame_.run().model(index));
      body.gait = std::make_unique<const Gait>(*frame_.run().model(index));
    }
    frame_.run().part_poses(static_cast<int>(avatar), poses);
    const RootPose& root = crowd.roots[avatar];
    const float thickness_m = kBarShare * (camera.eye_m - root.position_m.cast<float>()).norm();
    add_outlines(*body.type, *body.gait, poses, root, run.scale_of_avatar[avatar], options_.volumes,
                 thickness_m, out);
  }
}

std::vector<std::string> volume_layers() {
  std::vector<std::string> names{kBodySphere, kBodyBox};
  for (const VolumeKind kind : kAllVolumes) names.emplace_back(name_of(kind));
  return names;
}

}  // namespace throng
