#include "avatars/mesh/assimp_mesh.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <cstdint>
#include <cstring>
#include <exception>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/errors.h"
#include "base/files/regular_file.h"
#include "base/files/sandboxed_parser.h"

namespace throng {

// AssimpFiles opens the files that assimp reads: the mesh, and those it names (buffers of a glTF,
// materials of an .obj).
// Invariant: regular files only, read-only, and within one size limit for all of them.

class AssimpFiles : public Assimp::IOSystem {
 public:
  /// `mesh` keeps the name name() even if its path changes, and counts towards `max_bytes`.
  AssimpFiles(const RegularFile& mesh, uint64_t max_bytes);

  const std::string& name() const { return name_; }

  bool Exists(const char* file) const override;
  char getOsSeparator() const override { return '/'; }
  /// Returns null for a missing or irregular file, one that is too large, or a mode that writes.
  Assimp::IOStream* Open(const char* file, const char* mode) override;
  void Close(Assimp::IOStream* stream) override;
  bool ComparePaths(const char* one, const char* other) const override;
  bool CreateDirectory(const std::string&) override { return false; }
  bool ChangeDirectory(const std::string&) override { return false; }
  bool DeleteFile(const std::string&) override { return false; }

 private:
  using Content = std::shared_ptr<const std::vector<uint8_t>>;

  Content content_of(const std::string& file);

  const RegularFile& mesh_;
  std::string name_;
  uint64_t bytes_left_;
  /// Importers open their file several times: to detect the format, and to read it.
  std::map<std::string, Content> read_;
};

namespace {

/// Deeper than the node trees of any modelling program.
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
      throw ParseFailure(fmt::format("at most {} levels of nested nodes", kMaxNodeDepth), "more");
    const aiMatrix4x4 file_from_node = file_from_parent * node.mTransformation;
    for (unsigned i = 0; i < node.mNumMeshes; ++i) {
      if (node.mMeshes[i] >= scene_.mNumMeshes)
        throw ParseFailure(
            fmt::format("nodes that refer to the file's {} meshes", scene_.mNumMeshes),
            fmt::format("mesh {}", node.mMeshes[i]));
      append(*scene_.mMeshes[node.mMeshes[i]], file_from_node);
    }
    for (unsigned i = 0; i < node.mNumChildren; ++i) {
      // The importer of .raw files loses groups this way. An incomplete mesh is rejected.
      if (node.mChildren[i] == nullptr)
        throw ParseFailure("a mesh that assimp reads completely",
                           "one with parts that assimp drops");
      append(*node.mChildren[i], file_from_node, depth + 1);
    }
  }

  void append(const aiMesh& mesh, const aiMatrix4x4& file_from_mesh) {
    // A few bytes may refer to one mesh many times.
    if (mesh_.vertices.size() + mesh.mNumVertices > max_vertices_)
      throw ParseFailure(fmt::format("at most {} vertices", max_vertices_), "more");
    if (mesh_.triangles.size() + mesh.mNumFaces > max_triangles_)
      throw ParseFailure(fmt::format("at most {} triangles", max_triangles_), "more");
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
      if (face.mNumIndices != 3) continue;  // skip lines and points, which triangulation keeps
      Eigen::Vector3i triangle;
      for (int k = 0; k < 3; ++k) {
        // Checked per mesh, because after merging an index beyond this mesh could be valid.
        if (face.mIndices[k] >= mesh.mNumVertices)
          throw ParseFailure(fmt::format("vertex indices below {}", mesh.mNumVertices),
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
    throw ParseFailure("a mesh in .tri, .stl, .obj, .dae, .ply or another format of assimp",
                       fmt::format("'{}'", extension));
  auto files = std::make_unique<AssimpFiles>(file, max_bytes);
  const std::string name = files->name();
  importer.SetIOHandler(files.release());  // the importer owns it from here on
  // URDF viewers use a Collada file's axes as they are; assimp would rotate z up to y up.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene = importer.ReadFile(name, aiProcess_Triangulate);
  if (!scene || !scene->mRootNode) {
    if (importer.GetException()) std::rethrow_exception(importer.GetException());
    throw ParseFailure(fmt::format("a {} mesh", extension.substr(1)), importer.GetErrorString());
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

namespace {

class Stream : public Assimp::IOStream {
 public:
  explicit Stream(std::shared_ptr<const std::vector<uint8_t>> content)
      : content_(std::move(content)) {}

  /// As fread(): whole elements only.
  size_t Read(void* out, size_t size, size_t count) override {
    if (size == 0 || count == 0) return 0;
    const size_t whole = std::min(count, (content_->size() - at_) / size);
    if (whole == 0) return 0;
    std::memcpy(out, content_->data() + at_, whole * size);
    at_ += whole * size;
    return whole;
  }
  size_t Write(const void*, size_t, size_t) override { return 0; }
  /// As fseek(), but not beyond the end. `offset` is negative, converted, for backward moves.
  aiReturn Seek(size_t offset, aiOrigin origin) override {
    const size_t from = origin == aiOrigin_SET   ? 0
                        : origin == aiOrigin_CUR ? at_
                                                 : content_->size();
    const size_t to = from + offset;
    if (to > content_->size()) return aiReturn_FAILURE;
    at_ = to;
    return aiReturn_SUCCESS;
  }
  size_t Tell() const override { return at_; }
  size_t FileSize() const override { return content_->size(); }
  void Flush() override {}

 private:
  std::shared_ptr<const std::vector<uint8_t>> content_;
  size_t at_ = 0;
};

}  // namespace

AssimpFiles::AssimpFiles(const RegularFile& mesh, uint64_t max_bytes)
    : mesh_(mesh), name_(mesh.path().string()), bytes_left_(max_bytes) {}

AssimpFiles::Content AssimpFiles::content_of(const std::string& file) {
  if (const auto found = read_.find(file); found != read_.end()) return found->second;
  std::vector<uint8_t> bytes;
  try {
    bytes = file == name_ ? mesh_.bytes() : RegularFile(file, "a file", bytes_left_).bytes();
  } catch (const InputError&) {
    return nullptr;
  }
  bytes_left_ -= std::min<uint64_t>(bytes_left_, bytes.size());
  return read_[file] = std::make_shared<const std::vector<uint8_t>>(std::move(bytes));
}

bool AssimpFiles::Exists(const char* file) const {
  std::error_code ignored;
  return file == name_ || std::filesystem::is_regular_file(file, ignored);
}

Assimp::IOStream* AssimpFiles::Open(const char* file, const char* mode) {
  if (std::string_view(mode).find_first_of("wa+") != std::string_view::npos) return nullptr;
  Content content = content_of(file);
  return content == nullptr ? nullptr : new Stream(std::move(content));
}

void AssimpFiles::Close(Assimp::IOStream* stream) { delete stream; }

bool AssimpFiles::ComparePaths(const char* one, const char* other) const {
  return std::strcmp(one, other) == 0;
}

}  // namespace throng
