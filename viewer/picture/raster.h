// render() draws people, obstacles and ground into a picture, without a graphics card.
// Invariant: the same input gives the same bytes on any machine.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "avatars/mesh/mesh.h"

namespace throng {

/// Camera looks from `eye_m` at `target_m`, z upwards. Straight up and straight down are allowed.
struct Camera {
  Eigen::Vector3f eye_m = Eigen::Vector3f(-6, -6, 4);
  Eigen::Vector3f target_m = Eigen::Vector3f::Zero();
  float vertical_fov_rad = 0.7F;
};

/// One mesh in the picture. Its point p lies at world_from_mesh * (scale * p).
struct RenderItem {
  const Mesh* mesh = nullptr;  ///< a point cloud (no triangles) draws nothing
  Eigen::Isometry3f world_from_mesh = Eigen::Isometry3f::Identity();
  float scale = 1;
  Eigen::Vector3f rgb = Eigen::Vector3f::Constant(0.7F);  ///< 0..1
  float opacity = 1;  ///< below 1: translucent, drawn after the opaque items, from far to near
  bool casts_shadow = true;
};

struct RenderOptions {
  int width = 1280;
  int height = 720;
  int samples = 2;              ///< samples per pixel and axis, averaged; 1 to 4
  bool ground = true;           ///< draws the plane z = 0 with a grid of metres and shadows
  const Mesh* floor = nullptr;  ///< flat, its part of the ground is lighter; none: all of it
  float fog_start_m = 120;      ///< distance from which the ground fades into the background
};

/// Rows from the top, 3 bytes (red, green, blue) per pixel.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<uint8_t> rgb;
};

Image render(std::span<const RenderItem> items, const Camera& camera,
             const RenderOptions& options = {});

/// Writes an 8-bit RGB PNG. Throws EnvironmentError if the file cannot be written.
void write_png(const std::filesystem::path& file, const Image& image);

}  // namespace throng
