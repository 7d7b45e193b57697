#include "viewer/picture/picture.h"

#include <fmt/format.h>
#include <webp/encode.h>
#include <webp/mux.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <deque>
#include <map>
#include <span>
#include <utility>

#include "avatars/gait/gait.h"
#include "base/errors.h"
#include "base/files/atomic_file.h"
#include "viewer/picture/volume_outline.h"

namespace throng {
namespace {

using BodyPart = std::pair<uint32_t, uint32_t>;

/// By level, in linear light: the palette of Okabe and Ito, safe for colour-blind readers.
const std::array<Eigen::Vector3f, 4> kTouching = {
    Eigen::Vector3f(0.09F, 0.46F, 0.82F), Eigen::Vector3f(0.00F, 0.34F, 0.17F),
    Eigen::Vector3f(0.90F, 0.36F, 0.00F), Eigen::Vector3f(0.75F, 0.11F, 0.00F)};
const Eigen::Vector3f kObstacle(0.55F, 0.53F, 0.50F);
/// Muted clothes, because touching parts have to stand out.
const std::array<Eigen::Vector3f, 6> kClothes = {
    Eigen::Vector3f(0.33F, 0.42F, 0.53F), Eigen::Vector3f(0.46F, 0.52F, 0.50F),
    Eigen::Vector3f(0.60F, 0.62F, 0.64F), Eigen::Vector3f(0.38F, 0.40F, 0.46F),
    Eigen::Vector3f(0.55F, 0.58F, 0.66F), Eigen::Vector3f(0.42F, 0.50F, 0.58F)};
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

Eigen::Vector3f colour_of(uint32_t avatar, uint32_t part, const PartLevels& in_touch) {
  for (const uint32_t touched : {part, kWholeBody})
    if (const auto found = in_touch.find({avatar, touched}); found != in_touch.end())
      return kTouching[static_cast<size_t>(found->second)];
  return kClothes[avatar % kClothes.size()];
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

void add_people(RecordedFrame& frame, const PartLevels& in_touch, std::vector<RenderItem>& items) {
  RunReader& run = frame.run();
  const run_description_t& description = *run.run();
  std::vector<PartPose> poses;
  for (size_t avatar = 0; avatar < frame.crowd().roots.size(); ++avatar) {
    if (frame.crowd().present[avatar] == 0) continue;
    const auto id = static_cast<uint32_t>(avatar);
    const auto model = static_cast<size_t>(description.model_of_avatar[avatar]);
    const std::vector<Part>& parts = run.model(model)->parts;
    run.part_poses(static_cast<int>(avatar), poses);
    for (size_t part = 0; part < parts.size(); ++part) {
      items.push_back({&parts[part].mesh, world_from(frame.crowd().roots[avatar], poses[part]),
                       description.scale_of_avatar[avatar],
                       colour_of(id, static_cast<uint32_t>(part), in_touch)});
    }
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

void add_volumes(const BodyType& type, const Gait& gait, std::span<const PartPose> poses,
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

void add_volumes(RecordedFrame& frame, const PictureOptions& options, const Camera& camera,
                 VolumeItems& out) {
  if (options.volumes.empty()) return;
  RunReader& run = frame.run();
  const run_description_t& description = *run.run();
  std::vector<std::unique_ptr<const BodyType>> types(description.models.size());
  std::vector<std::unique_ptr<const Gait>> gaits(description.models.size());
  const auto is_asked = [&](uint32_t id) {
    return options.volumes_of.empty() ||
           std::find(options.volumes_of.begin(), options.volumes_of.end(), id) !=
               options.volumes_of.end();
  };
  std::vector<PartPose> poses;
  for (size_t avatar = 0; avatar < frame.crowd().roots.size(); ++avatar) {
    if (frame.crowd().present[avatar] == 0 || !is_asked(static_cast<uint32_t>(avatar))) continue;
    const auto model = static_cast<size_t>(description.model_of_avatar[avatar]);
    if (types[model] == nullptr) {
      types[model] = type_of(*run.model(model));
      gaits[model] = std::make_unique<const Gait>(*run.model(model));
    }
    run.part_poses(static_cast<int>(avatar), poses);
    const RootPose& root = frame.crowd().roots[avatar];
    const float thickness_m = kBarShare * (camera.eye_m - root.position_m.cast<float>()).norm();
    add_volumes(*types[model], *gaits[model], poses, root, description.scale_of_avatar[avatar],
                options.volumes, thickness_m, out);
  }
}

/// Obstacles keep their colour: one hand on a wall would paint the whole wall.
void add_obstacles(RecordedFrame& frame, std::deque<Mesh>& meshes, std::vector<RenderItem>& items) {
  for (const obstacle_t& obstacle : frame.run().run()->obstacles) {
    Eigen::Isometry3f pose = Eigen::Isometry3f::Identity();
    pose.rotate(
        Eigen::AngleAxisf(static_cast<float>(obstacle.heading_rad), Eigen::Vector3f::UnitZ()));
    pose.pretranslate(Eigen::Map<const Eigen::Vector3d>(obstacle.centre_m).cast<float>());
    meshes.push_back(to_mesh(obstacle.mesh));
    items.push_back({&meshes.back(), pose, 1, kObstacle});
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

PictureOptions with_fixed_camera(const CrowdState& crowd, const PictureOptions& options) {
  const Camera camera = camera_of(crowd, options);
  PictureOptions fixed = options;
  fixed.eye_m = camera.eye_m;
  fixed.target_m = camera.target_m;
  return fixed;
}

Image picture_of(RecordedFrame& frame, const PictureOptions& options) {
  const PartLevels in_touch = parts_in_touch(frame.touching());
  std::vector<RenderItem> items;
  std::deque<Mesh> meshes;  // items point into it: a deque does not move its elements
  add_people(frame, in_touch, items);
  add_obstacles(frame, meshes, items);
  const Camera camera = camera_of(frame.crowd(), options);
  VolumeItems volumes;
  add_volumes(frame, options, camera, volumes);
  volumes.append_to(items);
  RenderOptions render_options;
  render_options.width = options.width;
  render_options.height = options.height;
  render_options.samples = 3;
  if (!frame.floor().vertices.empty()) render_options.floor = &frame.floor();
  return render(items, camera, render_options);
}

std::vector<std::string> volume_layers() {
  std::vector<std::string> names{kBodySphere, kBodyBox};
  for (const VolumeKind kind : kAllVolumes) names.emplace_back(name_of(kind));
  return names;
}

struct Animation::Encoder {
  WebPAnimEncoder* webp = nullptr;
  WebPConfig config{};
  int width = 0, height = 0;
  int time_ms = 0;

  ~Encoder() { WebPAnimEncoderDelete(webp); }

  [[noreturn]] void fail() const {
    throw EnvironmentError(
        fmt::format("libwebp could not encode the animation: {}", WebPAnimEncoderGetError(webp)));
  }
};

Animation::Animation(int width, int height, float quality) : encoder_(std::make_unique<Encoder>()) {
  WebPAnimEncoderOptions options;
  WebPAnimEncoderOptionsInit(&options);
  options.anim_params.loop_count = 0;  // infinite
  encoder_->width = width;
  encoder_->height = height;
  encoder_->webp = WebPAnimEncoderNew(width, height, &options);
  WebPConfigPreset(&encoder_->config, WEBP_PRESET_DRAWING, quality);
  encoder_->config.method = 6;        // smallest file, not fastest
  encoder_->config.thread_level = 0;  // gives the same bytes on any machine
}

Animation::~Animation() = default;

void Animation::add(const Image& image, int shown_ms) {
  assert(image.width == encoder_->width && image.height == encoder_->height);
  WebPPicture picture;
  WebPPictureInit(&picture);
  picture.use_argb = 1;
  picture.width = image.width;
  picture.height = image.height;
  const bool added =
      WebPPictureImportRGB(&picture, image.rgb.data(), 3 * image.width) != 0 &&
      WebPAnimEncoderAdd(encoder_->webp, &picture, encoder_->time_ms, &encoder_->config) != 0;
  WebPPictureFree(&picture);
  if (!added) encoder_->fail();
  encoder_->time_ms += shown_ms;
}

size_t Animation::write(const std::filesystem::path& file) {
  WebPAnimEncoderAdd(encoder_->webp, nullptr, encoder_->time_ms, nullptr);  // ends the last frame
  WebPData data;
  WebPDataInit(&data);
  if (WebPAnimEncoderAssemble(encoder_->webp, &data) == 0) encoder_->fail();
  const std::unique_ptr<WebPData, void (*)(WebPData*)> owned(&data, WebPDataClear);
  write_file_atomically(file, std::span<const uint8_t>(data.bytes, data.size));
  return data.size;
}

}  // namespace throng
