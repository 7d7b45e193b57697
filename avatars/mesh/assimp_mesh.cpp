#include "avatars/mesh/assimp_mesh.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <assimp/Importer.hpp>
#include <exception>
#include <string_view>

#include "avatars/mesh/assimp_files.h"
#include "base/files/foreign.h"

namespace throng {
namespace {

/// Deeper trees of nodes than any modelling program writes.
constexpr int kMaxNodeDepth = 200;

class Collector {
 public:
  Collector(const aiScene& scene, size_t max_vertices, size_t max_triangles)
      : scene_(scene), max_vertices_(max_vertices), max_triangles_(max_triangles) {}

  Mesh collect() {
    append(*scene_.mRootNode, aiMatrix4x4(), 0);
    return std::move(mesh_);
  }

 private:
  void append(const aiNode& node, const aiMatrix4x4& file_from_parent, int depth) {
    if (depth > kMaxNodeDepth)
      throw Refusal(fmt::format("nodes nested at most {} deep", kMaxNodeDepth), "deeper ones");
    const aiMatrix4x4 file_from_node = file_from_parent * node.mTransformation;
    for (unsigned i = 0; i < node.mNumMeshes; ++i) {
      if (node.mMeshes[i] >= scene_.mNumMeshes)
        throw Refusal(
            fmt::format("nodes that show the {} meshes that there are", scene_.mNumMeshes),
            fmt::format("mesh {}", node.mMeshes[i]));
      append(*scene_.mMeshes[node.mMeshes[i]], file_from_node);
    }
    for (unsigned i = 0; i < node.mNumChildren; ++i) {
      // The importer of .raw files loses groups so; half a mesh is none.
      if (node.mChildren[i] == nullptr)
        throw Refusal("a mesh that assimp reads whole", "one of which it loses a part");
      append(*node.mChildren[i], file_from_node, depth + 1);
    }
  }

  void append(const aiMesh& mesh, const aiMatrix4x4& file_from_mesh) {
    // Few bytes may show one mesh many times over.
    if (mesh_.vertices.size() + mesh.mNumVertices > max_vertices_)
      throw Refusal(fmt::format("at most {} vertices", max_vertices_), "more");
    if (mesh_.triangles.size() + mesh.mNumFaces > max_triangles_)
      throw Refusal(fmt::format("at most {} triangles", max_triangles_), "more");
    const int first = static_cast<int>(mesh_.vertices.size());
    if (first == 0) {
      mesh_.vertices.reserve(mesh.mNumVertices);
      mesh_.triangles.reserve(mesh.mNumFaces);
    }
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      const aiVector3D v = file_from_mesh * mesh.mVertices[i];
      mesh_.vertices.emplace_back(v.x, v.y, v.z);
    }
    const bool mirrored = file_from_mesh.Determinant() < 0;
    for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
      const aiFace& face = mesh.mFaces[i];
      if (face.mNumIndices != 3) continue;  // lines and points, which triangulation leaves
      Eigen::Vector3i triangle;
      for (int k = 0; k < 3; ++k) {
        // Here, where it is known whose vertices these are: the next mesh's would be in range, too.
        if (face.mIndices[k] >= mesh.mNumVertices)
          throw Refusal(fmt::format("indices of {} vertices", mesh.mNumVertices),
                        fmt::format("{}", face.mIndices[k]));
        triangle[k] = first + static_cast<int>(face.mIndices[k]);
      }
      if (mirrored) std::swap(triangle[1], triangle[2]);
      mesh_.triangles.push_back(triangle);
    }
  }

  const aiScene& scene_;
  const size_t max_vertices_;
  const size_t max_triangles_;
  Mesh mesh_;
};

}  // namespace

Mesh triangles_by_assimp(const RegularFile& file, uint64_t max_bytes, size_t max_vertices,
                         size_t max_triangles) {
  Assimp::Importer importer;
  const std::string extension = file.path().extension().string();
  if (extension.empty() || !importer.IsExtensionSupported(extension))
    throw Refusal("a mesh in .tri, .stl, .obj, .dae, .ply or another format of assimp",
                  fmt::format("'{}'", extension));
  auto files = std::make_unique<AssimpFiles>(file, max_bytes);
  const std::string name = files->name();
  importer.SetIOHandler(files.release());  // which the importer owns from here on
  // URDF viewers take a Collada file's axes as they are; assimp would turn z up into y up.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene = importer.ReadFile(name, aiProcess_Triangulate);
  if (!scene || !scene->mRootNode) {
    if (importer.GetException()) std::rethrow_exception(importer.GetException());
    throw Refusal(fmt::format("a {} mesh", extension.substr(1)), importer.GetErrorString());
  }
  return Collector(*scene, max_vertices, max_triangles).collect();
}

char ignored_up_axis(const RegularFile& file) {
  const std::vector<uint8_t> bytes = file.bytes();
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const size_t tag = text.find("<up_axis");
  const size_t begin = tag == std::string_view::npos ? tag : text.find('>', tag);
  if (begin == std::string_view::npos) return 0;
  const std::string_view axis = text.substr(begin + 1, text.find('<', begin) - begin - 1);
  for (const char name : {'X', 'Y'})
    if (axis.find(std::string{name} + "_UP") != std::string_view::npos) return name;
  return 0;
}

}  // namespace throng
