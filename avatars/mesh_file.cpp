#include "avatars/mesh_file.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <cmath>
#include <numeric>
#include <system_error>

#include "avatars/tri.h"
#include "base/errors.h"

namespace throng {
namespace {

/// A detailed robot link has 10^5 triangles; beyond this somebody named the wrong file.
constexpr uintmax_t kMaxBytes = 512u << 20;
constexpr size_t kMaxVertices = 20'000'000;
/// Beyond 10 km a float no longer tells millimetres apart.
constexpr float kMaxCoordinate_m = 1e4f;
/// Deeper trees of nodes than any modelling program writes.
constexpr int kMaxNodeDepth = 200;

void append(const aiMesh& from, const aiMatrix4x4& file_from_mesh, Mesh& to) {
  const int first = static_cast<int>(to.vertices.size());
  for (unsigned i = 0; i < from.mNumVertices; ++i) {
    const aiVector3D v = file_from_mesh * from.mVertices[i];
    to.vertices.emplace_back(v.x, v.y, v.z);
  }
  const bool mirrored = file_from_mesh.Determinant() < 0;
  for (unsigned i = 0; i < from.mNumFaces; ++i) {
    const aiFace& face = from.mFaces[i];
    if (face.mNumIndices != 3) continue;  // lines and points, which triangulation leaves
    Eigen::Vector3i triangle;
    for (int k = 0; k < 3; ++k) triangle[k] = first + static_cast<int>(face.mIndices[k]);
    if (mirrored) std::swap(triangle[1], triangle[2]);
    to.triangles.push_back(triangle);
  }
}

void append_nodes(const aiScene& scene, const aiNode& node, const aiMatrix4x4& file_from_parent,
                  int depth, const std::string& name, Mesh& to) {
  if (depth > kMaxNodeDepth)
    throw InputError(name, fmt::format("nodes nested at most {} deep", kMaxNodeDepth),
                     "deeper ones");
  const aiMatrix4x4 file_from_node = file_from_parent * node.mTransformation;
  for (unsigned i = 0; i < node.mNumMeshes; ++i) {
    append(*scene.mMeshes[node.mMeshes[i]], file_from_node, to);
    if (to.vertices.size() > kMaxVertices)
      throw InputError(name, fmt::format("at most {} vertices", kMaxVertices), "more");
  }
  for (unsigned i = 0; i < node.mNumChildren; ++i)
    append_nodes(scene, *node.mChildren[i], file_from_node, depth + 1, name, to);
}

/// Joins vertices at equal positions (formats like STL repeat them for each triangle) and drops
/// those without a triangle, and triangles that became lines.
Mesh welded(const Mesh& soup) {
  std::vector<int> order(soup.vertices.size());
  std::iota(order.begin(), order.end(), 0);
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

Mesh read_by_assimp(const std::filesystem::path& file) {
  Assimp::Importer importer;
  const std::string extension = file.extension().string();
  if (extension.empty() || !importer.IsExtensionSupported(extension))
    throw InputError(file.string(),
                     "a mesh in .tri, .stl, .obj, .dae, .ply or another format of assimp",
                     fmt::format("'{}'", extension));
  // URDF viewers take a Collada file's axes as they are; assimp would turn z up into y up.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene = importer.ReadFile(file.string(), aiProcess_Triangulate);
  if (!scene || !scene->mRootNode)
    throw InputError(file.string(), fmt::format("a {} mesh", extension.substr(1)),
                     importer.GetErrorString());
  Mesh soup;
  append_nodes(*scene, *scene->mRootNode, aiMatrix4x4(), 0, file.string(), soup);
  return welded(soup);
}

}  // namespace

Mesh read_mesh(const std::filesystem::path& file) {
  std::error_code error;
  if (std::filesystem::is_directory(file, error))
    throw InputError(file.string(), "a mesh file", "a directory");
  const auto size = std::filesystem::file_size(file, error);
  if (error) throw InputError(file.string(), "a mesh file", error.message());
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  if (extension == ".tri") return read_tri(file).mesh;
  if (size > kMaxBytes)
    throw InputError(file.string(), fmt::format("at most {} bytes", kMaxBytes),
                     fmt::format("{}", size));
  Mesh mesh = read_by_assimp(file);
  if (mesh.triangles.empty()) throw InputError(file.string(), "at least one triangle", "none");
  for (const Eigen::Vector3f& v : mesh.vertices)
    if (!v.allFinite() || v.cwiseAbs().maxCoeff() > kMaxCoordinate_m)
      throw InputError(file.string(), fmt::format("coordinates within {:g} m", kMaxCoordinate_m),
                       fmt::format("({:g}, {:g}, {:g})", v.x(), v.y(), v.z()));
  return mesh;
}

}  // namespace throng
