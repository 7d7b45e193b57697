#include "viewer/picture/raster.h"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cerrno>
#include <cmath>
#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>

#include "base/errors.h"
#include "base/files/atomic_file.h"

// Items are sorted into square tiles of the picture; each tile is then drawn on its own, in the
// order of the items. Triangles are set up again in each tile that their item touches, which keeps
// memory small; most items of a crowd touch one tile.

namespace throng {
namespace {

const Eigen::Vector3f kSun = Eigen::Vector3f(-0.45F, -0.55F, 1.0F).normalized();  // towards the sun
// Colours and light of the page's light theme (viewer/page/src/theme.ts), linear.
const Eigen::Vector3f kBackground(0.815F, 0.855F, 0.905F);
const Eigen::Vector3f kGround(0.738F, 0.768F, 0.807F);
const Eigen::Vector3f kSky(0.62F, 0.66F, 0.72F);
const Eigen::Vector3f kEarth(0.30F, 0.29F, 0.28F);
const Eigen::Vector3f kSunLight(0.62F, 0.58F, 0.50F);
constexpr float kOffFloor = 0.8F;
constexpr float kShadow = 0.62F;  // remaining fraction of the ground's light
constexpr float kClipPlane_m = 0.05F;
constexpr float kGridLine_m = 0.02F;
/// Pixels per side: the samples of a tile fit into the second-level cache.
constexpr int kTile = 64;
constexpr size_t kTilePixels = size_t{kTile} * kTile;

/// The four samples of a pixel, one per lane.
using Lanes = float __attribute__((vector_size(16)));
using Mask = int32_t __attribute__((vector_size(16)));
constexpr int kSamples = 4;
/// A rotated grid: edges along an axis have four steps, with as many samples as a square of two.
constexpr Lanes kSampleX = {0.375F, 0.875F, 0.125F, 0.625F};
constexpr Lanes kSampleY = {0.125F, 0.375F, 0.625F, 0.875F};
constexpr Lanes kAllLight = {1, 1, 1, 1};
constexpr float kFirstSample = 0.125F, kLastSample = 0.875F;

bool any(const Mask& mask) { return (mask[0] | mask[1] | mask[2] | mask[3]) != 0; }
float sum(const Lanes& lanes) { return (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]); }

/// Converts linear light to sRGB bytes, by a table: the curve is costly.
class Srgb {
 public:
  Srgb() {
    for (size_t i = 0; i < bytes_.size(); ++i) {
      const double c = static_cast<double>(i) / kSteps;
      const double curved = c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
      bytes_[i] = static_cast<uint8_t>(std::lround(255 * curved));
    }
  }
  uint8_t operator()(float linear) const {
    return bytes_[static_cast<size_t>(std::clamp(linear, 0.0F, 1.0F) * kSteps)];
  }

 private:
  static constexpr int kSteps = 8191;  // the curve rises by less than half a byte per step
  std::array<uint8_t, kSteps + 1> bytes_{};
};

/// View transforms world to camera coordinates (x right, y down, z ahead) and to pixels.
struct View {
  View(const Camera& camera, int width, int height) {
    eye = camera.eye_m;
    forward = (camera.target_m - eye).normalized();
    right = forward.cross(Eigen::Vector3f::UnitZ());
    // Looking straight up or down: north (y) is up in the picture.
    right = right.norm() < 1e-6F ? Eigen::Vector3f::UnitX() : right.normalized().eval();
    down = forward.cross(right);
    rotation << right.transpose(), down.transpose(), forward.transpose();
    focal = focal_length_px(camera, height);
    centre_x = 0.5F * static_cast<float>(width);
    centre_y = 0.5F * static_cast<float>(height);
  }
  Eigen::Vector3f to_camera(const Eigen::Vector3f& world) const { return rotation * (world - eye); }
  /// Returns the position in pixels and 1/depth, which is linear in the picture.
  Eigen::Vector3f to_screen(const Eigen::Vector3f& p) const {
    const float inverse = 1 / p.z();
    return {centre_x + focal * p.x() * inverse, centre_y + focal * p.y() * inverse, inverse};
  }
  /// Returns the ray through the middle of a pixel: not normalised, 1 along `forward`.
  Eigen::Vector3f ray(int x, int y) const {
    return forward + right * ((static_cast<float>(x) + 0.5F - centre_x) / focal) +
           down * ((static_cast<float>(y) + 0.5F - centre_y) / focal);
  }
  Eigen::Vector3f eye, forward, right, down;
  Eigen::Matrix3f rotation;  ///< camera_from_world
  float focal, centre_x, centre_y;
};

/// Projects along the sun's rays onto the ground.
Eigen::Vector3f foot_of(const Eigen::Vector3f& p) {
  const Eigen::Vector3f foot = p - kSun * (std::max(0.0F, p.z()) / kSun.z());
  return {foot.x(), foot.y(), 0};
}

/// Light on a surface: from the sky, a little from the ground, and from the sun.
Eigen::Vector3f light_on(const Eigen::Vector3f& normal, const Eigen::Vector3f& up,
                         const Eigen::Vector3f& sun) {
  const float share = 0.5F + 0.5F * normal.dot(up);
  return kEarth + share * (kSky - kEarth) + std::max(0.0F, normal.dot(sun)) * kSunLight;
}

/// A rectangle of pixels or tiles; the ends are excluded.
struct Range {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

/// A corner of a triangle in camera coordinates, with its lit colour.
struct Corner {
  Eigen::Vector3f camera;
  Eigen::Vector3f rgb;
};

/// Clips a triangle at the near plane and returns the number of corners, 0 to 4.
int clip(const std::array<Corner, 3>& in, std::array<Corner, 4>& out) {
  int count = 0;
  for (size_t i = 0; i < 3; ++i) {
    const Corner& a = in[i];
    const Corner& b = in[(i + 1) % 3];
    const bool a_in = a.camera.z() > kClipPlane_m;
    if (a_in) out[static_cast<size_t>(count++)] = a;
    if (a_in != (b.camera.z() > kClipPlane_m)) {
      const float t = (kClipPlane_m - a.camera.z()) / (b.camera.z() - a.camera.z());
      Corner cut{a.camera + t * (b.camera - a.camera), a.rgb + t * (b.rgb - a.rgb)};
      cut.camera.z() = kClipPlane_m;
      out[static_cast<size_t>(count++)] = cut;
    }
  }
  return count;
}

/// A corner in the picture: pixels, 1/depth, lit colour.
struct ScreenCorner {
  Eigen::Vector3f at;
  Eigen::Vector3f rgb;
};
using ScreenTriangle = std::array<ScreenCorner, 3>;

/// Returns the visible part of a triangle: up to two triangles.
int project(const View& view, const std::array<Corner, 3>& triangle,
            std::array<ScreenTriangle, 2>& out) {
  std::array<Corner, 4> corners;
  const int count = clip(triangle, corners);
  std::array<ScreenCorner, 4> screen;
  for (size_t i = 0; i < static_cast<size_t>(count); ++i)
    screen[i] = {view.to_screen(corners[i].camera), corners[i].rgb};
  for (size_t i = 2; i < static_cast<size_t>(count); ++i)
    out[i - 2] = {screen[0], screen[i - 1], screen[i]};
  return std::max(0, count - 2);
}

/// Twice the area in the picture; negative: faces the eye, because y points down.
float area_of(const ScreenTriangle& t) {
  return (t[1].at.x() - t[0].at.x()) * (t[2].at.y() - t[0].at.y()) -
         (t[1].at.y() - t[0].at.y()) * (t[2].at.x() - t[0].at.x());
}

/// Barycentric weights of the samples of a pixel.
struct Weights {
  Lanes a, b, c;
  /// Interpolates a value of the corners.
  Lanes mix(float at_a, float at_b, float at_c) const { return a * at_a + b * at_b + c * at_c; }
};

/// Linear colours of the samples of a pixel.
struct Colours {
  Lanes red = {}, green = {}, blue = {};

  void put(const Mask& samples, const Colours& other) {
    red = samples ? other.red : red;
    green = samples ? other.green : green;
    blue = samples ? other.blue : blue;
  }
};

/// Returns rgb * light for each sample.
Colours lit(const Eigen::Vector3f& rgb, const Lanes& light) {
  return {rgb[0] * light, rgb[1] * light, rgb[2] * light};
}

/// One pixel of a tile: nearest surfaces of its samples, and their lit colours.
struct Pixel {
  Lanes inverse_depth = {};  ///< 0: nothing drawn
  Colours colours;
};

/// Accumulated translucent surfaces before a pixel's samples: their light and their opacity.
struct TranslucentLayer {
  Colours colours;
  Lanes cover = {};
};

/// Samples of a square of the picture. A thread has one and reuses it.
struct Tile {
  Range area;  ///< pixels of the picture
  std::vector<Pixel> pixels;
  std::vector<TranslucentLayer> layers;  ///< empty if no item is translucent
  std::vector<Mask> shadow, floor;

  void reset(const Range& new_area) {
    area = new_area;
    pixels.assign(kTilePixels, Pixel{});
    shadow.assign(kTilePixels, Mask{});
    floor.assign(kTilePixels, Mask{});
    layers.clear();
  }

  /// Returns the pixels of the tile with samples in the box around the triangle.
  Range box_around(const ScreenTriangle& t) const {
    const auto low = [](float a, float b, float c, int begin, int end) {
      return static_cast<int>(std::clamp(std::ceil(std::min({a, b, c}) - kLastSample),
                                         static_cast<float>(begin), static_cast<float>(end)));
    };
    const auto high = [](float a, float b, float c, int begin, int end) {
      return static_cast<int>(std::clamp(std::floor(std::max({a, b, c}) - kFirstSample) + 1,
                                         static_cast<float>(begin), static_cast<float>(end)));
    };
    return {low(t[0].at.x(), t[1].at.x(), t[2].at.x(), area.x0, area.x1),
            low(t[0].at.y(), t[1].at.y(), t[2].at.y(), area.y0, area.y1),
            high(t[0].at.x(), t[1].at.x(), t[2].at.x(), area.x0, area.x1),
            high(t[0].at.y(), t[1].at.y(), t[2].at.y(), area.y0, area.y1)};
  }

  /// Calls body(index of the pixel, samples inside, weights) for the pixels of a triangle that
  /// faces the eye.
  template <typename Body>
  void fill(const ScreenTriangle& t, const Body& body) {
    const float area_px2 = area_of(t);
    if (!(area_px2 < 0) || !std::isfinite(area_px2)) return;
    const Range box = box_around(t);
    const float scale = 1 / area_px2;
    const float ax = (t[1].at.y() - t[2].at.y()) * scale, ay = (t[2].at.x() - t[1].at.x()) * scale;
    const float bx = (t[2].at.y() - t[0].at.y()) * scale, by = (t[0].at.x() - t[2].at.x()) * scale;
    for (int y = box.y0; y < box.y1; ++y) {
      const Lanes dy = kSampleY + (static_cast<float>(y) - t[2].at.y());
      for (int x = box.x0; x < box.x1; ++x) {
        const Lanes dx = kSampleX + (static_cast<float>(x) - t[2].at.x());
        Weights weights{ax * dx + ay * dy, bx * dx + by * dy, {}};
        weights.c = 1 - weights.a - weights.b;
        // Both triangles draw samples exactly on a shared edge, which leaves no hole.
        const Mask inside = (weights.a >= -kEdge) & (weights.b >= -kEdge) & (weights.c >= -kEdge);
        if (any(inside)) body(index(x, y), inside, weights);
      }
    }
  }
  static constexpr float kEdge = 1e-5F;  // rounding of the weights: rather twice than never

  static size_t index(int x, int y) {
    return static_cast<size_t>(y % kTile) * kTile + static_cast<size_t>(x % kTile);
  }

  void draw_opaque(const ScreenTriangle& t) {
    fill(t, [&](size_t at, Mask inside, const Weights& weights) {
      Pixel& pixel = pixels[at];
      const Lanes depth = weights.mix(t[0].at.z(), t[1].at.z(), t[2].at.z());
      inside &= depth > pixel.inverse_depth;
      if (!any(inside)) return;
      pixel.inverse_depth = inside ? depth : pixel.inverse_depth;
      pixel.colours.put(inside, colours_in(t, weights));
    });
  }

  /// Blends a surface over the layer. Items come from far to near.
  void draw_translucent(const ScreenTriangle& t, float opacity) {
    layers.resize(pixels.size());
    fill(t, [&](size_t at, Mask inside, const Weights& weights) {
      inside &= weights.mix(t[0].at.z(), t[1].at.z(), t[2].at.z()) > pixels[at].inverse_depth;
      TranslucentLayer& layer = layers[at];
      const float lets = 1 - opacity;
      const Colours before = layer.colours, veil = colours_in(t, weights);
      layer.colours.put(inside, {lets * before.red + opacity * veil.red,
                                 lets * before.green + opacity * veil.green,
                                 lets * before.blue + opacity * veil.blue});
      layer.cover = inside ? lets * layer.cover + opacity : layer.cover;
    });
  }

  static Colours colours_in(const ScreenTriangle& t, const Weights& weights) {
    return {weights.mix(t[0].rgb[0], t[1].rgb[0], t[2].rgb[0]),
            weights.mix(t[0].rgb[1], t[1].rgb[1], t[2].rgb[1]),
            weights.mix(t[0].rgb[2], t[1].rgb[2], t[2].rgb[2])};
  }

  void mark(const ScreenTriangle& t, std::vector<Mask>& marks) {
    fill(t, [&](size_t at, const Mask& inside, const Weights&) { marks[at] |= inside; });
  }
};

/// Lists of item numbers per tile, in the order of the items.
class TileLists {
 public:
  TileLists(int width, int height)
      : columns_((width + kTile - 1) / kTile),
        rows_((height + kTile - 1) / kTile),
        lists_(static_cast<size_t>(columns_) * static_cast<size_t>(rows_)) {}

  void add(const Range& pixels, uint32_t item) {
    if (pixels.x0 >= pixels.x1 || pixels.y0 >= pixels.y1) return;
    for (int y = pixels.y0 / kTile; y <= (pixels.y1 - 1) / kTile; ++y)
      for (int x = pixels.x0 / kTile; x <= (pixels.x1 - 1) / kTile; ++x)
        lists_[static_cast<size_t>(y) * static_cast<size_t>(columns_) + static_cast<size_t>(x)]
            .push_back(item);
  }
  int tiles() const { return columns_ * rows_; }
  Range area(int tile, int width, int height) const {
    const int x0 = tile % columns_ * kTile, y0 = tile / columns_ * kTile;
    return {x0, y0, std::min(x0 + kTile, width), std::min(y0 + kTile, height)};
  }
  const std::vector<uint32_t>& operator[](int tile) const {
    return lists_[static_cast<size_t>(tile)];
  }

 private:
  int columns_, rows_;
  std::vector<std::vector<uint32_t>> lists_;
};

class Painter {
 public:
  Painter(std::span<const RenderItem> items, const Camera& camera, const RenderOptions& options)
      : items_(items),
        options_(options),
        view_(camera, options.width, options.height),
        surfaces_(options.width, options.height),
        shadows_(options.width, options.height),
        image_{options.width, options.height, {}} {
    if (view_.eye.z() == 0) options_.ground = false;  // it is a line
    image_.rgb.resize(3 * static_cast<size_t>(options.width) * static_cast<size_t>(options.height));
    if (options_.ground && options.floor != nullptr) project_floor(*options.floor);
    list_items();
  }

  Image paint(Workers& workers) {
    std::vector<Brush> brushes(static_cast<size_t>(workers.threads()));
    workers.for_blocks(surfaces_.tiles(), [&](int tile, int worker) {
      paint(tile, brushes[static_cast<size_t>(worker)]);
    });
    return std::move(image_);
  }

 private:
  /// Memory of a thread.
  struct Brush {
    Tile tile;
    std::vector<Corner> corners;
    std::vector<ScreenCorner> screen;  ///< valid before the near plane
  };

  void list_items() {
    std::vector<uint32_t> translucent;
    const bool has_shadows = options_.ground && view_.eye.z() > 0;
    for (size_t i = 0; i < items_.size(); ++i) {
      const RenderItem& item = items_[i];
      const auto number = static_cast<uint32_t>(i);
      if (item.opacity < 1)
        translucent.push_back(number);
      else
        surfaces_.add(pixels_of(item), number);
      if (has_shadows && item.shadow != nullptr) shadows_.add(shadow_pixels_of(item), number);
    }
    const auto depth = [&](uint32_t number) {
      return view_.to_camera(centre_of(items_[number], *items_[number].shape)).z();
    };
    std::stable_sort(translucent.begin(), translucent.end(),
                     [&](uint32_t a, uint32_t b) { return depth(a) > depth(b); });
    for (const uint32_t number : translucent) surfaces_.add(pixels_of(items_[number]), number);
  }

  static Eigen::Vector3f centre_of(const RenderItem& item, const Shape& shape) {
    return item.world_from_shape * (item.scale * shape.centre);
  }
  Range pixels_of(const RenderItem& item) const {
    return pixels_around(centre_of(item, *item.shape), item.scale * item.shape->radius);
  }
  Range shadow_pixels_of(const RenderItem& item) const {
    // The sun's rays are this much longer than their height, and so are shadows.
    const float longer = 1 / kSun.z();
    const Eigen::Vector3f centre = centre_of(item, *item.shadow);
    const float radius = item.scale * item.shadow->radius;
    if (centre.z() + radius < 0) return {};
    return pixels_around(foot_of(centre), longer * radius + std::max(0.0F, radius - centre.z()));
  }

  /// Returns the pixels in which a sphere may be visible.
  Range pixels_around(const Eigen::Vector3f& centre, float radius) const {
    const Eigen::Vector3f c = view_.to_camera(centre);
    const float near = c.z() - radius, far = c.z() + radius;
    if (far <= kClipPlane_m) return {};
    if (near <= kClipPlane_m) return {0, 0, options_.width, options_.height};
    const auto low = [&](float middle, float at, int end) {
      const float edge = at - radius;
      const float pixel = middle + view_.focal * edge / (edge < 0 ? near : far);
      return static_cast<int>(std::clamp(std::floor(pixel), 0.0F, static_cast<float>(end)));
    };
    const auto high = [&](float middle, float at, int end) {
      const float edge = at + radius;
      const float pixel = middle + view_.focal * edge / (edge > 0 ? near : far);
      return static_cast<int>(std::clamp(std::ceil(pixel), 0.0F, static_cast<float>(end)));
    };
    return {low(view_.centre_x, c.x(), options_.width), low(view_.centre_y, c.y(), options_.height),
            high(view_.centre_x, c.x(), options_.width),
            high(view_.centre_y, c.y(), options_.height)};
  }

  void project_floor(const Mesh& floor) {
    const auto corner = [&](int vertex) {
      return Corner{view_.to_camera(floor.vertices[static_cast<size_t>(vertex)]), {0, 0, 0}};
    };
    std::array<ScreenTriangle, 2> parts;
    for (const Eigen::Vector3i& t : floor.triangles) {
      const int count = project(view_, {corner(t[0]), corner(t[1]), corner(t[2])}, parts);
      for (size_t i = 0; i < static_cast<size_t>(count); ++i) {
        if (area_of(parts[i]) > 0) std::swap(parts[i][1], parts[i][2]);
        floor_.push_back(parts[i]);
      }
    }
  }

  void paint(int number, Brush& brush) {
    Tile& tile = brush.tile;
    tile.reset(surfaces_.area(number, options_.width, options_.height));
    for (const ScreenTriangle& t : floor_) tile.mark(t, tile.floor);
    for (const uint32_t item : shadows_[number]) draw_shadow(items_[item], brush);
    for (const uint32_t item : surfaces_[number]) draw_surface(items_[item], brush);
    for (int y = tile.area.y0; y < tile.area.y1; ++y)
      for (int x = tile.area.x0; x < tile.area.x1; ++x) finish(tile, x, y);
  }

  void draw_surface(const RenderItem& item, Brush& brush) const {
    const Shape& shape = *item.shape;
    const Eigen::Matrix3f turn = item.world_from_shape.linear();
    const Eigen::Matrix3f camera_from_shape = view_.rotation * turn * item.scale;
    const Eigen::Vector3f offset = view_.to_camera(item.world_from_shape.translation());
    const Eigen::Vector3f up = turn.transpose() * Eigen::Vector3f::UnitZ();
    const Eigen::Vector3f sun = turn.transpose() * kSun;
    brush.corners.clear();
    for (size_t i = 0; i < shape.vertices.size(); ++i) {
      const bool is_second = !shape.is_second.empty() && shape.is_second[i] != 0;
      brush.corners.push_back({camera_from_shape * shape.vertices[i] + offset,
                               light_on(shape.normals[i], up, sun)
                                   .cwiseProduct(is_second ? item.second_rgb : item.rgb)});
    }
    draw(shape, brush, [&](const ScreenTriangle& t) {
      if (item.opacity < 1)
        brush.tile.draw_translucent(t, item.opacity);
      else
        brush.tile.draw_opaque(t);
    });
  }

  void draw_shadow(const RenderItem& item, Brush& brush) const {
    brush.corners.clear();
    for (const Eigen::Vector3f& p : item.shadow->vertices)
      brush.corners.push_back(
          {view_.to_camera(foot_of(item.world_from_shape * (item.scale * p))), {0, 0, 0}});
    // From above, the shadow of a triangle that faces the sun faces the eye.
    draw(*item.shadow, brush,
         [&](const ScreenTriangle& t) { brush.tile.mark(t, brush.tile.shadow); });
  }

  /// Calls body(triangle) for the triangles of a shape whose corners are prepared.
  template <typename Body>
  void draw(const Shape& shape, Brush& brush, const Body& body) const {
    brush.screen.clear();
    for (const Corner& corner : brush.corners)
      brush.screen.push_back({view_.to_screen(corner.camera), corner.rgb});
    std::array<ScreenTriangle, 2> parts;
    for (const Eigen::Vector3i& t : shape.triangles) {
      const auto a = static_cast<size_t>(t[0]);
      const auto b = static_cast<size_t>(t[1]);
      const auto c = static_cast<size_t>(t[2]);
      const float nearest = std::min(
          {brush.corners[a].camera.z(), brush.corners[b].camera.z(), brush.corners[c].camera.z()});
      if (nearest > kClipPlane_m) {
        body({brush.screen[a], brush.screen[b], brush.screen[c]});
        continue;
      }
      const int count =
          project(view_, {brush.corners[a], brush.corners[b], brush.corners[c]}, parts);
      for (size_t i = 0; i < static_cast<size_t>(count); ++i) body(parts[i]);
    }
  }

  /// Averages the samples of a pixel.
  void finish(const Tile& tile, int x, int y) {
    const size_t at = Tile::index(x, y);
    const Pixel& pixel = tile.pixels[at];
    const Mask on_ground = options_.ground ? sees_ground(pixel, x, y) : Mask{};
    Colours colours = pixel.colours;
    colours.put(pixel.inverse_depth == 0, lit(kBackground, kAllLight));
    if (any(on_ground)) colours.put(on_ground, ground_colours(tile, x, y));
    if (!tile.layers.empty()) {
      const TranslucentLayer& layer = tile.layers[at];
      const Lanes lets = 1 - layer.cover;
      colours = {layer.colours.red + lets * colours.red, layer.colours.green + lets * colours.green,
                 layer.colours.blue + lets * colours.blue};
    }
    uint8_t* out = &image_.rgb[3 * (static_cast<size_t>(y) * static_cast<size_t>(image_.width) +
                                    static_cast<size_t>(x))];
    out[0] = srgb_(sum(colours.red) / kSamples);
    out[1] = srgb_(sum(colours.green) / kSamples);
    out[2] = srgb_(sum(colours.blue) / kSamples);
  }

  /// Returns the samples in which the ground is nearer than any item.
  Mask sees_ground(const Pixel& pixel, int x, int y) const {
    // 1/depth of the plane z = 0 is linear in the picture.
    const Lanes px = kSampleX + (static_cast<float>(x) - view_.centre_x);
    const Lanes py = kSampleY + (static_cast<float>(y) - view_.centre_y);
    const Lanes ray_z =
        view_.forward.z() + (view_.right.z() * px + view_.down.z() * py) / view_.focal;
    const Lanes inverse_depth = -ray_z / view_.eye.z();
    return (inverse_depth > 0) & (inverse_depth > pixel.inverse_depth);
  }

  /// Returns the ground's colours: one for the pixel, with the shadow and the floor of its samples.
  Colours ground_colours(const Tile& tile, int x, int y) const {
    const Eigen::Vector3f ray = view_.ray(x, y);
    const float depth = -view_.eye.z() / ray.z();  // where the ray meets z = 0
    const float fog = std::clamp((depth - options_.fog_start_m) / options_.fog_start_m, 0.0F, 1.0F);
    // At the horizon the middle of the pixel may lie in the sky.
    if (!(depth > 0) || fog == 1) return lit(kBackground, kAllLight);
    const size_t at = Tile::index(x, y);
    Lanes light = tile.shadow[at] ? kShadow * kAllLight : kAllLight;
    if (options_.floor != nullptr) light *= tile.floor[at] ? kAllLight : kOffFloor * kAllLight;
    light *= (1 - fog) * grid_light(view_.eye + ray * depth, depth);
    const Colours bare = lit(kGround, light), haze = lit(kBackground, fog * kAllLight);
    return {bare.red + haze.red, bare.green + haze.green, bare.blue + haze.blue};
  }

  /// Lines at whole metres, softened to the width of a pixel: they do not flicker far away.
  float grid_light(const Eigen::Vector3f& p, float depth) const {
    const float wide = std::max(kGridLine_m, depth / view_.focal);
    const auto line = [&](float s) {
      const float off = std::abs(s - std::floor(s + 0.5F));
      return std::clamp(1 - off / wide, 0.0F, 1.0F) * (kGridLine_m / wide);
    };
    return 1 - 0.22F * std::max(line(p.x()), line(p.y()));
  }

  std::span<const RenderItem> items_;
  RenderOptions options_;
  View view_;
  TileLists surfaces_, shadows_;
  std::vector<ScreenTriangle> floor_;
  Srgb srgb_;
  Image image_;
};

}  // namespace

float focal_length_px(const Camera& camera, int height) {
  return 0.5F * static_cast<float>(height) / std::tan(0.5F * camera.vertical_fov_rad);
}

Image render(std::span<const RenderItem> items, const Camera& camera, const RenderOptions& options,
             Workers& workers) {
  assert(options.width > 0 && options.height > 0);
  assert(camera.eye_m != camera.target_m);
  return Painter(items, camera, options).paint(workers);
}

namespace {

/// Returns false if memory runs out. One filter and a low level take a third of the default's time,
/// for 15 % more bytes.
bool encode_png(std::FILE* out, const Image& image) {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  if (png == nullptr) return false;
  png_infop info = png_create_info_struct(png);
  if (info == nullptr || setjmp(png_jmpbuf(png)) != 0) {
    png_destroy_write_struct(&png, &info);
    return false;
  }
  png_init_io(png, out);
  png_set_IHDR(png, info, static_cast<png_uint_32>(image.width),
               static_cast<png_uint_32>(image.height), 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
  png_set_compression_level(png, 3);
  png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_UP);
  png_write_info(png, info);
  const size_t row = 3 * static_cast<size_t>(image.width);
  for (size_t at = 0; at < image.rgb.size(); at += row) png_write_row(png, &image.rgb[at]);
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return true;
}

}  // namespace

void write_png(const std::filesystem::path& file, const Image& image) {
  char* bytes = nullptr;
  size_t size = 0;
  std::FILE* out = open_memstream(&bytes, &size);
  const bool encoded = out != nullptr && encode_png(out, image);
  const bool closed = out != nullptr && std::fclose(out) == 0;
  const std::unique_ptr<char, void (*)(void*)> owned(bytes, std::free);
  if (!encoded || !closed)
    throw EnvironmentError(
        fmt::format("cannot write {}: {}", file.string(), std::strerror(ENOMEM)));
  write_file_atomically(file, std::string_view(bytes, size));
}

}  // namespace throng
