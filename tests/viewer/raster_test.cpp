// Tests the rasteriser: coverage, occlusion, and pictures that are equal to the byte.
#include "viewer/picture/raster.h"

#include <gtest/gtest.h>
#include <png.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <utility>
#include <vector>

#include "base/errors.h"

namespace throng::raster_test {
namespace {

constexpr float kRightAngle = 1.57079632679F;  // field of view: at 1 m, the picture is 2 m high

Image drawn(std::span<const RenderItem> items, const Camera& camera, const RenderOptions& options,
            int threads = 1) {
  Workers workers(threads);
  return render(items, camera, options, workers);
}

/// Renders from the origin along +x, `size` x `size` pixels without ground.
Image rendered(std::span<const RenderItem> items, int size) {
  const Camera camera{{0, 0, 0}, {1, 0, 0}, kRightAngle};
  return drawn(items, camera, {.width = size, .height = size, .ground = false});
}

std::array<int, 3> pixel(const Image& image, int x, int y) {
  const int place = y * image.width + x;
  const size_t at = 3 * static_cast<size_t>(place);
  return {image.rgb[at], image.rgb[at + 1], image.rgb[at + 2]};
}

bool is_red(const std::array<int, 3>& p) { return p[0] > 2 * p[1] && p[0] > 2 * p[2]; }
bool is_blue(const std::array<int, 3>& p) { return p[2] > 2 * p[0] && p[2] > 2 * p[1]; }

/// Returns a triangle at distance x that faces the origin; right in the picture is -y.
Mesh triangle_mesh(float x) {
  return {{{x, x, x}, {x, x, -x}, {x, -x, -x}},
          {{0, 1, 2}}};  // upper left, lower left, lower right
}
Shape triangle_at(float x) { return shape_of(triangle_mesh(x)); }

Mesh sphere_mesh(int rings, int segments) {
  Mesh mesh;
  const double pi = 3.14159265358979;
  for (int r = 0; r <= rings; ++r)
    for (int s = 0; s < segments; ++s)
      mesh.vertices.push_back(
          Eigen::Vector3d(std::sin(pi * r / rings) * std::cos(2 * pi * s / segments),
                          std::sin(pi * r / rings) * std::sin(2 * pi * s / segments),
                          std::cos(pi * r / rings))
              .cast<float>());
  for (int r = 0; r < rings; ++r)
    for (int s = 0; s < segments; ++s) {
      const int a = r * segments + s;
      const int b = r * segments + (s + 1) % segments;
      mesh.triangles.emplace_back(a, a + segments, b + segments);
      mesh.triangles.emplace_back(a, b + segments, b);
    }
  return mesh;
}

Shape sphere(int rings, int segments) { return shape_of(sphere_mesh(rings, segments)); }

TEST(Raster, CoversPixelsBelowADiagonal) {
  const Shape shape = triangle_at(1);
  RenderItem item;
  item.shape = &shape;
  item.rgb = {0.9F, 0.05F, 0.05F};
  const Image image = rendered({&item, 1}, 16);
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x)
      if (x != y) {  // the diagonal crosses these pixels
        EXPECT_EQ(is_red(pixel(image, x, y)), x < y) << x << ' ' << y;
      }
}

TEST(Raster, NearerItemsHideFartherOnes) {
  const Shape near = triangle_at(2);
  const Shape far = triangle_at(3);
  RenderItem red;
  red.shape = &near;
  red.rgb = {0.9F, 0.05F, 0.05F};
  RenderItem blue;
  blue.shape = &far;
  blue.rgb = {0.05F, 0.05F, 0.9F};
  for (const auto& order : {std::array<RenderItem, 2>{red, blue}, {blue, red}}) {
    const Image image = rendered(order, 16);
    EXPECT_TRUE(is_red(pixel(image, 3, 12)));
    EXPECT_FALSE(is_blue(pixel(image, 3, 12)));
  }
}

TEST(Raster, CullsBackFacesAndItemsBehindTheEye) {
  Mesh turned = triangle_mesh(1);
  std::swap(turned.triangles[0][1], turned.triangles[0][2]);
  const Shape away = shape_of(turned), behind = triangle_at(-1);
  for (const Shape* shape : {&away, &behind}) {
    RenderItem item;
    item.shape = shape;
    const Image image = rendered({&item, 1}, 16);
    EXPECT_EQ(image.rgb, rendered({}, 16).rgb);
  }
}

TEST(Raster, DrawsASphereWithoutHoles) {
  const Shape shape = sphere(24, 37);
  RenderItem item;
  item.shape = &shape;
  item.rgb = {0.9F, 0.05F, 0.05F};
  item.world_from_shape.translate(Eigen::Vector3f(3, 0, 0));
  constexpr int kSize = 200;
  const Image image = rendered({&item, 1}, kSize);
  // From 3 m, a unit sphere covers the disc of radius 1 / sqrt(9 - 1) at 1 m. Its 37 segments
  // differ from the circle by less than 1 %.
  const double radius = kSize / 2.0 / std::sqrt(8.0);
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      const double off = std::hypot(x + 0.5 - kSize / 2.0, y + 0.5 - kSize / 2.0);
      if (off < 0.97 * radius) {
        ASSERT_TRUE(is_red(pixel(image, x, y))) << "hole at " << x << ' ' << y;
      }
      if (off > radius + 1) {
        ASSERT_FALSE(is_red(pixel(image, x, y))) << x << ' ' << y;
      }
    }
}

TEST(Raster, CastsShadowsAwayFromTheSun) {
  const Shape shape = sphere(12, 16);
  RenderItem item;
  item.shape = &shape;
  item.scale = 0.3F;
  item.shadow = &shape;
  item.world_from_shape.translate(Eigen::Vector3f(0, 0, 1));
  const Camera from_above{{0, 0, 6}, {0, 0, 0}, kRightAngle};
  const RenderOptions options{.width = 120, .height = 120};
  const Image bare = drawn({}, from_above, options);
  const Image image = drawn({&item, 1}, from_above, options);
  // The sun is at (-0.45, -0.55, 1), the ball's shadow at (0.45, 0.55); 10 pixels per metre.
  EXPECT_LT(pixel(image, 64, 54)[0] + 20, pixel(bare, 64, 54)[0]);
  EXPECT_EQ(pixel(image, 40, 80), pixel(bare, 40, 80));
}

TEST(Raster, DrawsTheSameBytesWithAnyNumberOfThreads) {
  const Shape ball = sphere(12, 16);
  std::vector<RenderItem> items;
  for (int i = 0; i < 60; ++i) {
    RenderItem item{&ball};
    item.scale = 0.3F;
    item.world_from_shape.translate(Eigen::Vector3f(0.5F * static_cast<float>(i % 10) - 2,
                                                    0.6F * static_cast<float>(i / 10), 0.3F));
    item.rgb = {0.1F * static_cast<float>(i % 7), 0.4F, 0.2F};
    item.opacity = i % 5 == 0 ? 0.5F : 1;
    item.shadow = &ball;
    items.push_back(item);
  }
  const RenderOptions options{.width = 300, .height = 170};
  const Image one = drawn(items, Camera{}, options, 1);
  for (const int threads : {2, 3, 8})
    EXPECT_EQ(one.rgb, drawn(items, Camera{}, options, threads).rgb) << threads << " threads";
}

TEST(Raster, DrawsAShapeAcrossTheEdgeOfThePictureOrBehindTheEye) {
  // From inside a ball that faces inwards, all pixels show it.
  Mesh mesh = sphere_mesh(24, 37);
  for (Eigen::Vector3i& t : mesh.triangles) std::swap(t[1], t[2]);
  const Shape shape = shape_of(mesh);
  RenderItem item{&shape};
  item.rgb = {0.9F, 0.05F, 0.05F};
  const Image image = rendered({&item, 1}, 150);
  for (int y = 0; y < 150; ++y)
    for (int x = 0; x < 150; ++x) ASSERT_TRUE(is_red(pixel(image, x, y))) << x << ' ' << y;
}

TEST(Raster, PaintsTheSecondColour) {
  Shape shape = triangle_at(1);
  shape.is_second.assign(shape.vertices.size(), 1);
  RenderItem item{&shape};
  item.rgb = {0.05F, 0.05F, 0.9F};
  item.second_rgb = {0.9F, 0.05F, 0.05F};
  EXPECT_TRUE(is_red(pixel(rendered({&item, 1}, 16), 3, 12)));
}

TEST(Raster, WritesEqualFilesForEqualPictures) {
  const Shape shape = sphere(12, 16);
  RenderItem item;
  item.shape = &shape;
  const Image once = drawn({&item, 1}, Camera{}, {.width = 160, .height = 90});
  const Image twice = drawn({&item, 1}, Camera{}, {.width = 160, .height = 90}, 3);
  EXPECT_EQ(once.rgb, twice.rgb);
  EXPECT_EQ(once.rgb.size(), 160u * 90u * 3u);
}

TEST(Raster, BlendsTranslucentItems) {
  const Shape near = triangle_at(1), far = triangle_at(2);
  RenderItem red{&far}, veil{&near};
  red.rgb = {0.8F, 0, 0};
  veil.rgb = {0, 0, 0.8F};
  veil.opacity = 0.5F;
  const std::array both{veil, red};
  const auto mixed = pixel(rendered(both, 64), 20, 40);
  const auto alone = pixel(rendered({&red, 1}, 64), 20, 40);
  EXPECT_GT(mixed[2], alone[2]);
  EXPECT_LT(mixed[0], alone[0]);
  EXPECT_GT(mixed[0], mixed[1]);
  // Paler in front of the background than a solid item; invisible behind a solid item.
  EXPECT_FALSE(is_blue(pixel(rendered({&veil, 1}, 64), 20, 40)));
  RenderItem solid{&near};
  solid.rgb = red.rgb;
  RenderItem behind{&far};
  behind.opacity = 0.5F;
  const std::array hidden{behind, solid};
  EXPECT_EQ(rendered(hidden, 64).rgb, rendered({&solid, 1}, 64).rgb);
}

TEST(Raster, WritesReadablePng) {
  const Shape shape = sphere(12, 16);
  RenderItem item;
  item.shape = &shape;
  const Image image = drawn({&item, 1}, Camera{}, {.width = 33, .height = 21});
  const std::filesystem::path file = testing::TempDir() + "throng_raster.png";
  write_png(file, image);
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  ASSERT_NE(png_image_begin_read_from_file(&header, file.c_str()), 0);
  header.format = PNG_FORMAT_RGB;
  std::vector<uint8_t> rgb(PNG_IMAGE_SIZE(header));
  ASSERT_NE(png_image_finish_read(&header, nullptr, rgb.data(), 0, nullptr), 0);
  EXPECT_EQ(rgb, image.rgb);
  std::filesystem::remove(file);
}

TEST(Raster, ReportsWriteErrors) {
  const Image image = drawn({}, Camera{}, {.width = 64, .height = 64});
  EXPECT_THROW(write_png("/nowhere/picture.png", image), EnvironmentError);
  EXPECT_THROW(write_png("/dev/full", image), EnvironmentError);
}

}  // namespace
}  // namespace throng::raster_test
