#include "viewer/picture/raster.h"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <memory>

#include "base/errors.h"
#include "base/files/atomic_file.h"

namespace throng {
namespace {

const Eigen::Vector3f kSun = Eigen::Vector3f(-0.45F, -0.55F, 1.0F).normalized();  // towards the sun
const Eigen::Vector3f kBackground(0.93F, 0.95F, 0.97F);
const Eigen::Vector3f kGround(0.86F, 0.86F, 0.84F);
constexpr float kOffFloor = 0.8F;
constexpr float kShadow = 0.62F;  // remaining fraction of the ground's light
constexpr float kClipPlane_m = 0.05F;
constexpr float kGridLine_m = 0.02F;
/// Gamma 2: the square root of linear light, close enough to sRGB for flat colours.
uint8_t to_byte(float linear) {
  // NOLINTNEXTLINE(bugprone-incorrect-roundings): never negative, and called for every pixel
  return static_cast<uint8_t>(std::sqrt(std::clamp(linear, 0.0F, 1.0F)) * 255.0F + 0.5F);
}

/// View transforms world to camera coordinates (x right, y down, z ahead) and to sample positions.
struct View {
  View(const Camera& camera, int width, int height) {
    eye = camera.eye_m;
    forward = (camera.target_m - eye).normalized();
    right = forward.cross(Eigen::Vector3f::UnitZ());
    // Looking straight up or down: north (y) is up in the picture.
    right = right.norm() < 1e-6F ? Eigen::Vector3f::UnitX() : right.normalized().eval();
    down = forward.cross(right);
    focal = 0.5F * static_cast<float>(height) / std::tan(0.5F * camera.vertical_fov_rad);
    centre_x = 0.5F * static_cast<float>(width);
    centre_y = 0.5F * static_cast<float>(height);
  }
  Eigen::Vector3f to_camera(const Eigen::Vector3f& world) const {
    const Eigen::Vector3f d = world - eye;
    return {d.dot(right), d.dot(down), d.dot(forward)};
  }
  /// Returns the position in samples and 1/depth, which is linear in the picture.
  Eigen::Vector3f to_screen(const Eigen::Vector3f& p) const {
    const float inverse = 1 / p.z();
    return {centre_x + focal * p.x() * inverse, centre_y + focal * p.y() * inverse, inverse};
  }
  /// Returns the ray through the middle of a sample: not normalised, 1 along `forward`.
  Eigen::Vector3f ray(int x, int y) const {
    return forward + right * ((static_cast<float>(x) + 0.5F - centre_x) / focal) +
           down * ((static_cast<float>(y) + 0.5F - centre_y) / focal);
  }
  Eigen::Vector3f eye, forward, right, down;
  float focal, centre_x, centre_y;
};

/// One sample of the picture: 16 bytes, to touch one line of memory per pixel.
struct Sample {
  float inverse_depth = 0;  // 0: nothing drawn
  float red = 0, green = 0, blue = 0;
};

/// Accumulated translucent surfaces before a sample: their light and their opacity.
struct TranslucentLayer {
  float red = 0, green = 0, blue = 0;
  float cover = 0;
};

struct Canvas {
  int width, height;
  std::vector<Sample> samples;
  std::vector<TranslucentLayer> layers;  // empty if no item is translucent
  std::vector<uint8_t> shadow;
  std::vector<uint8_t> floor;  ///< empty: everywhere

  /// Calls body(index, a, b, c) for the samples inside a triangle, with barycentric weights.
  template <typename Body>
  void fill(const std::array<Eigen::Vector3f, 3>& p, const Body& body) const {
    const float area = (p[1].x() - p[0].x()) * (p[2].y() - p[0].y()) -
                       (p[1].y() - p[0].y()) * (p[2].x() - p[0].x());
    if (area == 0 || !std::isfinite(area)) return;
    const auto low = [](float a, float b, float c, int end) {
      return static_cast<int>(
          std::clamp(std::ceil(std::min({a, b, c}) - 0.5F), 0.0F, static_cast<float>(end)));
    };
    const auto high = [](float a, float b, float c, int end) {
      return static_cast<int>(
          std::clamp(std::floor(std::max({a, b, c}) - 0.5F), -1.0F, static_cast<float>(end - 1)));
    };
    const int x0 = low(p[0].x(), p[1].x(), p[2].x(), width);
    const int x1 = high(p[0].x(), p[1].x(), p[2].x(), width);
    const int y0 = low(p[0].y(), p[1].y(), p[2].y(), height);
    const int y1 = high(p[0].y(), p[1].y(), p[2].y(), height);
    const float scale = 1 / area;
    for (int y = y0; y <= y1; ++y) {
      const float py = static_cast<float>(y) + 0.5F;
      for (int x = x0; x <= x1; ++x) {
        const float px = static_cast<float>(x) + 0.5F;
        // Both triangles draw samples exactly on a shared edge, which leaves no hole.
        const float a =
            ((p[1].x() - px) * (p[2].y() - py) - (p[1].y() - py) * (p[2].x() - px)) * scale;
        const float b =
            ((p[2].x() - px) * (p[0].y() - py) - (p[2].y() - py) * (p[0].x() - px)) * scale;
        const float c = 1 - a - b;
        if (a >= -kEdge && b >= -kEdge && c >= -kEdge)
          body(static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x), a, b,
               c);
      }
    }
  }
  static constexpr float kEdge = 1e-5F;  // rounding of the weights: rather twice than never
};

/// A corner of a triangle in camera coordinates.
struct Corner {
  Eigen::Vector3f camera;
  float light;
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
      Corner cut;
      cut.camera = a.camera + t * (b.camera - a.camera);
      cut.camera.z() = kClipPlane_m;
      cut.light = a.light + t * (b.light - a.light);
      out[static_cast<size_t>(count++)] = cut;
    }
  }
  return count;
}

template <typename Body>
void fill_clipped(const Canvas& canvas, const View& view, const std::array<Corner, 3>& triangle,
                  const Body& body) {
  std::array<Corner, 4> corners;
  const int count = clip(triangle, corners);
  for (size_t i = 2; i < static_cast<size_t>(count); ++i) {
    const std::array<Corner, 3> part = {corners[0], corners[i - 1], corners[i]};
    std::array<Eigen::Vector3f, 3> screen;
    for (size_t k = 0; k < 3; ++k) screen[k] = view.to_screen(part[k].camera);
    canvas.fill(screen, [&](size_t at, float a, float b, float c) {
      body(at, a * screen[0].z() + b * screen[1].z() + c * screen[2].z(),
           a * part[0].light + b * part[1].light + c * part[2].light);
    });
  }
}

/// An edge is sharp from this angle between a face and the smooth surface at its corner (cosine).
constexpr float kSharpEdge = 0.77F;  // 40 degrees

/// Computes vertex normals, weighted by the area of the adjacent triangles.
void vertex_normals(const std::vector<Eigen::Vector3f>& points, const Mesh& mesh,
                    std::vector<Eigen::Vector3f>& normals) {
  normals.assign(points.size(), Eigen::Vector3f::Zero());
  for (const Eigen::Vector3i& t : mesh.triangles) {
    const auto at = [&](int i) -> const Eigen::Vector3f& {
      return points[static_cast<size_t>(t[i])];
    };
    const Eigen::Vector3f normal = (at(1) - at(0)).cross(at(2) - at(0));
    for (int i = 0; i < 3; ++i) normals[static_cast<size_t>(t[i])] += normal;
  }
}

/// Light on a surface: from the sky, a little from the ground, and from the sun.
float light_on(const Eigen::Vector3f& normal) {
  const float length = normal.norm();
  if (length == 0) return 0.5F;
  const float up = normal.z() / length;
  return 0.30F + 0.14F * up + 0.62F * std::max(0.0F, normal.dot(kSun) / length);
}

class Painter {
 public:
  Painter(const Camera& camera, const RenderOptions& options)
      : options_(options),
        canvas_{options.width * options.samples, options.height * options.samples, {}, {}, {}, {}},
        view_(camera, canvas_.width, canvas_.height) {
    const size_t count = static_cast<size_t>(canvas_.width) * static_cast<size_t>(canvas_.height);
    canvas_.samples.resize(count);
    if (options.ground) canvas_.shadow.resize(count);
    if (options.ground && options.floor != nullptr) mark_floor(*options.floor);
  }

  void draw(const RenderItem& item) {
    const Mesh& mesh = *item.mesh;
    if (item.opacity < 1) canvas_.layers.resize(canvas_.samples.size());
    world_.clear();
    for (const Eigen::Vector3f& v : mesh.vertices)
      world_.push_back(item.world_from_mesh * (item.scale * v));
    vertex_normals(world_, mesh, normals_);
    camera_.clear();
    shadow_.clear();
    for (size_t i = 0; i < world_.size(); ++i) {
      const Eigen::Vector3f& p = world_[i];
      camera_.push_back({view_.to_camera(p), light_on(normals_[i])});
      const Eigen::Vector3f foot = p - kSun * (std::max(0.0F, p.z()) / kSun.z());
      shadow_.push_back({view_.to_camera({foot.x(), foot.y(), 0}), 0});
    }
    for (const Eigen::Vector3i& t : mesh.triangles) {
      const auto a = static_cast<size_t>(t[0]);
      const auto b = static_cast<size_t>(t[1]);
      const auto c = static_cast<size_t>(t[2]);
      // Faces turned away are not drawn: a closed surface hides its own back.
      const Eigen::Vector3f normal = (world_[b] - world_[a]).cross(world_[c] - world_[a]);
      if (normal.dot(world_[a] - view_.eye) < 0)
        fill_clipped(canvas_, view_, {lit(a, normal), lit(b, normal), lit(c, normal)},
                     [&](size_t at, float inverse_depth, float light) {
                       Sample& sample = canvas_.samples[at];
                       if (inverse_depth <= sample.inverse_depth) return;
                       if (item.opacity < 1) return cover(at, item, light);
                       sample = {inverse_depth, item.rgb.x() * light, item.rgb.y() * light,
                                 item.rgb.z() * light};
                     });
      if (options_.ground && item.casts_shadow && normal.dot(kSun) > 0 && view_.eye.z() > 0)
        fill_clipped(canvas_, view_, {shadow_[a], shadow_[b], shadow_[c]},
                     [&](size_t at, float, float) { canvas_.shadow[at] = 1; });
    }
  }

  /// Depth of the mean of the item's vertices along the view.
  float depth_of(const RenderItem& item) const {
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    for (const Eigen::Vector3f& v : item.mesh->vertices) sum += v;
    const auto count = static_cast<float>(std::max<size_t>(1, item.mesh->vertices.size()));
    return view_.to_camera(item.world_from_mesh * (item.scale / count * sum)).z();
  }

  Image finish() const {
    Image image{options_.width, options_.height, {}};
    image.rgb.reserve(static_cast<size_t>(image.width) * static_cast<size_t>(image.height) * 3);
    const float share = 1 / static_cast<float>(options_.samples * options_.samples);
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        Eigen::Vector3f sum = Eigen::Vector3f::Zero();
        for (int sy = 0; sy < options_.samples; ++sy)
          for (int sx = 0; sx < options_.samples; ++sx)
            sum += behind_layer(x * options_.samples + sx, y * options_.samples + sy);
        for (int c = 0; c < 3; ++c) image.rgb.push_back(to_byte(sum[c] * share));
      }
    }
    return image;
  }

 private:
  void mark_floor(const Mesh& floor) {
    canvas_.floor.resize(canvas_.samples.size());
    const auto corner = [&](int vertex) {
      return Corner{view_.to_camera(floor.vertices[static_cast<size_t>(vertex)]), 0};
    };
    for (const Eigen::Vector3i& t : floor.triangles)
      fill_clipped(canvas_, view_, {corner(t[0]), corner(t[1]), corner(t[2])},
                   [&](size_t at, float, float) { canvas_.floor[at] = 1; });
  }

  /// A corner with its light. At a sharp edge the adjacent faces do not share their light.
  Corner lit(size_t vertex, const Eigen::Vector3f& face) const {
    Corner corner = camera_[vertex];
    const Eigen::Vector3f& smooth = normals_[vertex];
    if (face.dot(smooth) < kSharpEdge * face.norm() * smooth.norm()) corner.light = light_on(face);
    return corner;
  }

  /// Blends a surface over the layer. Items come from far to near.
  void cover(size_t at, const RenderItem& item, float light) {
    TranslucentLayer& layer = canvas_.layers[at];
    const float lets = 1 - item.opacity;
    layer = {layer.red * lets + item.opacity * item.rgb.x() * light,
             layer.green * lets + item.opacity * item.rgb.y() * light,
             layer.blue * lets + item.opacity * item.rgb.z() * light,
             layer.cover * lets + item.opacity};
  }

  Eigen::Vector3f behind_layer(int x, int y) const {
    Eigen::Vector3f bare = colour(x, y);
    if (canvas_.layers.empty()) return bare;
    const TranslucentLayer& layer =
        canvas_.layers[static_cast<size_t>(y) * static_cast<size_t>(canvas_.width) +
                       static_cast<size_t>(x)];
    return Eigen::Vector3f(layer.red, layer.green, layer.blue) + (1 - layer.cover) * bare;
  }

  Eigen::Vector3f colour(int x, int y) const {
    const size_t at =
        static_cast<size_t>(y) * static_cast<size_t>(canvas_.width) + static_cast<size_t>(x);
    const Sample& sample = canvas_.samples[at];
    if (options_.ground) {
      const Eigen::Vector3f ray = view_.ray(x, y);
      const float depth = -view_.eye.z() / ray.z();  // where the ray meets z = 0
      if (std::isfinite(depth) && depth > 0 && sample.inverse_depth * depth < 1)
        return ground_colour(view_.eye + ray * depth, depth, at);
    }
    if (sample.inverse_depth > 0) return {sample.red, sample.green, sample.blue};
    return kBackground;
  }

  Eigen::Vector3f ground_colour(const Eigen::Vector3f& p, float depth, size_t at) const {
    // Lines at whole metres, softened to the width of a sample: they do not flicker far away.
    const float sample_m = depth / view_.focal;
    const auto line = [&](float s) {
      const float off = std::abs(s - std::floor(s + 0.5F));
      const float wide = std::max(kGridLine_m, sample_m);
      return std::clamp(1 - off / wide, 0.0F, 1.0F) * (kGridLine_m / wide);
    };
    float light = 1 - 0.22F * std::max(line(p.x()), line(p.y()));
    if (canvas_.shadow[at] != 0) light *= kShadow;
    if (!canvas_.floor.empty() && canvas_.floor[at] == 0) light *= kOffFloor;
    const float fog = std::clamp((depth - options_.fog_start_m) / options_.fog_start_m, 0.0F, 1.0F);
    return kGround * light * (1 - fog) + kBackground * fog;
  }

  RenderOptions options_;
  Canvas canvas_;
  View view_;
  std::vector<Eigen::Vector3f> world_, normals_;
  std::vector<Corner> camera_, shadow_;
};

}  // namespace

Image render(std::span<const RenderItem> items, const Camera& camera,
             const RenderOptions& options) {
  assert(options.width > 0 && options.height > 0 && options.samples >= 1 && options.samples <= 4);
  assert(camera.eye_m != camera.target_m);
  Painter painter(camera, options);
  std::vector<const RenderItem*> translucent;
  for (const RenderItem& item : items)
    if (item.opacity < 1)
      translucent.push_back(&item);
    else
      painter.draw(item);
  const auto depth = [&](const RenderItem* item) { return painter.depth_of(*item); };
  std::stable_sort(translucent.begin(), translucent.end(),
                   [&](const RenderItem* a, const RenderItem* b) { return depth(a) > depth(b); });
  for (const RenderItem* item : translucent) painter.draw(*item);
  return painter.finish();
}

void write_png(const std::filesystem::path& file, const Image& image) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width);
  header.height = static_cast<png_uint_32>(image.height);
  header.format = PNG_FORMAT_RGB;
  const auto fail = [&](const std::string& why) {
    throw EnvironmentError(fmt::format("cannot write {}: {}", file.string(), why));
  };
  char* bytes = nullptr;
  size_t size = 0;
  std::FILE* out = open_memstream(&bytes, &size);
  if (out == nullptr) fail(std::strerror(errno));
  const bool written =
      png_image_write_to_stdio(&header, out, 0, image.rgb.data(), image.width * 3, nullptr) != 0;
  const bool closed = std::fclose(out) == 0;
  const std::unique_ptr<char, void (*)(void*)> owned(bytes, std::free);
  if (!written) fail(header.message);
  if (!closed) fail(std::strerror(ENOMEM));
  write_file_atomically(file, std::string_view(bytes, size));
}

}  // namespace throng
