// Foxglove messages as JSON (https://docs.foxglove.dev/docs/sdk/schemas). Lengths are in metres,
// times in simulated nanoseconds; names are those of the log.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <string_view>

namespace throng::foxglove {

extern const char* const kFrameTransformsSchema;
extern const char* const kSceneUpdateSchema;
/// Schema of throng.Contact: a contact begins or ends.
extern const char* const kContactSchema;

std::string json_text(std::string_view text);
/// Returns {"sec":0,"nsec":0}.
std::string json_time(int64_t utime_us);

/// Adds an item of FrameTransforms.transforms.
void add_transform(std::string& json, int64_t utime_us, std::string_view frame,
                   const Eigen::Isometry3d& world_from_frame);

struct Colour {
  double r = 0.7, g = 0.7, b = 0.7, a = 1;
};

/// Returns an item of SceneUpdate.entities that moves with its frame. `shapes` is one of its lists,
/// filled: "\"spheres\":[...]".
std::string entity(int64_t utime_us, std::string_view frame, std::string_view id,
                   const std::string& shapes);
std::string sphere(const Eigen::Vector3d& centre_m, double diameter_m, const Colour& colour);
/// Three coordinates per vertex, three indices per triangle.
std::string triangles(const float* coordinates_m, size_t coordinates, const int32_t* indices,
                      size_t index_count, double scale, const Colour& colour);
/// Returns an item of SceneUpdate.deletions.
std::string deletion(int64_t utime_us, std::string_view id);
std::string scene_update(const std::string& deletions, const std::string& entities);

}  // namespace throng::foxglove
