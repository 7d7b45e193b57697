#include "avatars/mesh/mesh_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string_view>
#include <utility>

#include "avatars/mesh/assimp_mesh.h"
#include "avatars/mesh/tri.h"
#include "base/errors.h"
#include "base/text.h"

namespace throng {
namespace {

constexpr size_t kMaxVertices = 20'000'000;
constexpr size_t kMaxTriangles = 40'000'000;
/// Beyond 10 km a float does not resolve millimetres.
constexpr float kMaxCoordinate_m = 1e4f;

/// Merges vertices at equal positions; drops unused vertices, and triangles that become lines.
Mesh welded(const Mesh& soup) {
  std::vector<int> order;
  for (const Eigen::Vector3i& triangle : soup.triangles)
    order.insert(order.end(), triangle.begin(), triangle.end());
  std::sort(order.begin(), order.end());
  order.erase(std::unique(order.begin(), order.end()), order.end());
  const auto key = [&](int i) {
    const Eigen::Vector3f& v = soup.vertices[static_cast<size_t>(i)];
    return std::array{v.x(), v.y(), v.z()};
  };
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return std::pair(key(a), a) < std::pair(key(b), b); });
  std::vector<int> first_like(soup.vertices.size());
  for (size_t i = 0; i < order.size(); ++i)
    first_like[static_cast<size_t>(order[i])] = i > 0 && key(order[i]) == key(order[i - 1])
                                                    ? first_like[static_cast<size_t>(order[i - 1])]
                                                    : order[i];
  Mesh mesh;
  std::vector<int> renumbered(soup.vertices.size(), -1);
  for (const Eigen::Vector3i& triangle : soup.triangles) {
    Eigen::Vector3i corners;
    for (int k = 0; k < 3; ++k) corners[k] = first_like[static_cast<size_t>(triangle[k])];
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
    for (int& corner : corners) {
      int& number = renumbered[static_cast<size_t>(corner)];
      if (number < 0) {
        number = static_cast<int>(mesh.vertices.size());
        mesh.vertices.push_back(soup.vertices[static_cast<size_t>(corner)]);
      }
      corner = number;
    }
    mesh.triangles.push_back(corners);
  }
  return mesh;
}

/// Header of the child's reply; then come the vertices and the triangles.
struct Counts {
  uint64_t vertices = 0;
  uint64_t triangles = 0;
  uint64_t up_axis = 0;  ///< see ignored_up_axis()
  size_t bytes() const {
    return sizeof(Counts) + vertices * sizeof(Eigen::Vector3f) +
           triangles * sizeof(Eigen::Vector3i);
  }
};
static_assert(sizeof(Eigen::Vector3f) == 12 && sizeof(Eigen::Vector3i) == 12);

template <typename T>
void put(const T* from, size_t count, uint8_t*& to) {
  // NOLINTNEXTLINE(bugprone-undefined-memory-manipulation): plain numbers, as asserted above
  if (count > 0) std::memcpy(to, from, count * sizeof(T));
  to += count * sizeof(T);
}

template <typename T>
void take(const uint8_t*& from, size_t count, T* to) {
  if (count > 0) std::memcpy(static_cast<void*>(to), from, count * sizeof(T));
  from += count * sizeof(T);
}

std::vector<uint8_t> packed(const Mesh& mesh, char up_axis) {
  const Counts counts{mesh.vertices.size(), mesh.triangles.size(), static_cast<uint64_t>(up_axis)};
  std::vector<uint8_t> out(counts.bytes());
  uint8_t* to = out.data();
  put(&counts, 1, to);
  put(mesh.vertices.data(), mesh.vertices.size(), to);
  put(mesh.triangles.data(), mesh.triangles.size(), to);
  return out;
}

Mesh unpacked(const std::vector<uint8_t>& bytes, const std::string& name, char& up_axis) {
  const auto reject = [&] {
    throw InputError(
        name, "a mesh",
        "data that assimp imports inconsistently; export it again, for example as .stl");
  };
  Counts counts;
  if (bytes.size() < sizeof counts) reject();
  const uint8_t* from = bytes.data();
  take(from, 1, &counts);
  if (counts.vertices > kMaxVertices || counts.triangles > kMaxTriangles ||
      counts.bytes() != bytes.size() || counts.up_axis > 'Y')
    reject();
  up_axis = static_cast<char>(counts.up_axis);
  Mesh mesh;
  mesh.vertices.resize(counts.vertices);
  mesh.triangles.resize(counts.triangles);
  take(from, counts.vertices, mesh.vertices.data());
  take(from, counts.triangles, mesh.triangles.data());
  return mesh;
}

/// Checks the child's output like a file: a malicious file may control that process.
Mesh checked(Mesh soup, const std::string& name, float scale, const char* remedy) {
  const auto count = static_cast<int>(soup.vertices.size());
  for (const Eigen::Vector3i& triangle : soup.triangles) {
    for (const int corner : triangle) {
      if (corner < 0 || corner >= count)
        throw InputError(name, fmt::format("vertex indices below {}", count),
                         fmt::format("{}", corner));
      const Eigen::Vector3f& v = soup.vertices[static_cast<size_t>(corner)];
      if (!v.allFinite() || !(scale * v.cwiseAbs().maxCoeff() <= kMaxCoordinate_m))
        throw InputError(name, fmt::format("coordinates within {:g} m", kMaxCoordinate_m),
                         fmt::format("({:g}, {:g}, {:g}){}", v.x() * scale, v.y() * scale,
                                     v.z() * scale, remedy));
    }
  }
  return soup;
}

std::string lower_case(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c + ('a' - 'A'));
  return text;
}

/// Up axis of meshes that assimp returns; `stated` is that of a Collada file.
UpAxis up_of(const std::string& extension, char stated) {
  // glTF, VRML and X3D define y; assimp turns the z of CAD formats to y.
  constexpr std::string_view kY[] = {".gltf", ".glb",  ".wrl", ".x3d",
                                     ".x3db", ".x3dv", ".3ds", ".dxf"};
  if (stated == 'X') return UpAxis::kX;
  const bool is_y =
      stated == 'Y' || std::find(std::begin(kY), std::end(kY), extension) != std::end(kY);
  return is_y ? UpAxis::kY : UpAxis::kZ;
}

struct AssimpMesh {
  Mesh mesh;
  char stated_up = 0;  ///< see ignored_up_axis()
};

/// `scale` and `remedy` belong to the check of coordinates.
AssimpMesh read_by_assimp(const std::filesystem::path& file, const std::string& extension,
                          const SandboxLimits& limits, float scale, const char* remedy) {
  const SandboxedParser assimp = {
      .library = "assimp",
      .expected = extension.empty() ? "a mesh file" : fmt::format("a {} mesh", extension.substr(1)),
      .remedy = "export it again, for example as .stl or .tri"};
  const auto parse = [&](const RegularFile& opened) {
    return packed(triangles_by_assimp(opened, limits.max_file_bytes, kMaxVertices, kMaxTriangles),
                  extension == ".dae" ? ignored_up_axis(opened) : 0);
  };
  AssimpMesh out;
  const std::string name = file.string();
  out.mesh =
      welded(checked(unpacked(parse_sandboxed(file, assimp, limits, parse), name, out.stated_up),
                     name, scale, remedy));
  if (out.mesh.triangles.empty()) throw InputError(name, "at least one triangle", "none");
  return out;
}

}  // namespace

Mesh read_mesh(const std::filesystem::path& file, const SandboxLimits& limits,
               std::vector<std::string>* notes) {
  const std::string extension = lower_case(file.extension().string());
  if (extension == ".tri") return read_tri(file).mesh;
  AssimpMesh read = read_by_assimp(file, extension, limits, 1, "");
  if (notes != nullptr && (read.stated_up == 'X' || read.stated_up == 'Y'))
    notes->push_back(
        fmt::format("mesh '{}' states {}_UP, which is ignored as in URDF viewers: z of its "
                    "coordinates is z of its frame",
                    escaped(file.filename().string()), read.stated_up));
  return std::move(read.mesh);
}

Mesh read_upright_mesh(const std::filesystem::path& file, float scale, std::optional<UpAxis> up) {
  const std::string extension = lower_case(file.extension().string());
  AssimpMesh read;
  if (extension == ".tri")
    read.mesh = read_tri(file).mesh;
  else
    read = read_by_assimp(
        file, extension, {}, scale,
        "; set 'scale' to the metres per unit of the file, as 0.001 for millimetres");
  const UpAxis axis = up.value_or(up_of(extension, read.stated_up));
  for (Eigen::Vector3f& v : read.mesh.vertices) {
    v *= scale;
    if (axis == UpAxis::kX) v = Eigen::Vector3f(-v.y(), -v.z(), v.x());
    if (axis == UpAxis::kY) v = Eigen::Vector3f(v.x(), -v.z(), v.y());
  }
  return std::move(read.mesh);
}

}  // namespace throng
