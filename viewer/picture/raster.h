// render() draws people, obstacles and ground into a picture, without a graphics card.
// Invariant: the same input gives the same bytes on any machine, with any number of threads.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "base/workers.h"
#include "viewer/picture/shape.h"

namespace throng {

/// Camera looks from `eye_m` at `target_m`, z upwards. Straight up and straight down are allowed.
struct Camera {
  Eigen::Vector3f eye_m = Eigen::Vector3f(-6, -6, 4);
  Eigen::Vector3f target_m = Eigen::Vector3f::Zero();
  float vertical_fov_rad = 0.7F;
};

/// One shape in the picture. Its point p lies at world_from_shape * (scale * p).
struct RenderItem {
  const Shape* shape = nullptr;
  Eigen::Isometry3f world_from_shape = Eigen::Isometry3f::Identity();
  float scale = 1;
  Eigen::Vector3f rgb = Eigen::Vector3f::Constant(0.7F);         ///< linear light, 0..1
  Eigen::Vector3f second_rgb = Eigen::Vector3f::Constant(0.7F);  ///< colour of Shape::is_second
  float opacity = 1;  ///< below 1: translucent, drawn after the opaque items, from far to near
  const Shape* shadow = nullptr;  ///< casts the shadow, often a coarser shape; null: none
};

struct RenderOptions {
  int width = 1280;
  int height = 720;
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

/// Focal length in pixels: an object of 1 m at a distance of 1 m is this high in the picture.
float focal_length_px(const Camera& camera, int height);

/// Draws with the threads of `workers`.
Image render(std::span<const RenderItem> items, const Camera& camera, const RenderOptions& options,
             Workers& workers);

/// Writes an 8-bit RGB PNG. Throws EnvironmentError if the file cannot be written.
void write_png(const std::filesystem::path& file, const Image& image);

}  // namespace throng
