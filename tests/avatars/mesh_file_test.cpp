// Mesh files: every format gives the same shape; crashes and stalls of assimp become errors.
#include "avatars/mesh/mesh_file.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pthread.h>
#include <sys/stat.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <atomic>
#include <filesystem>
#include <fstream>

#include "avatars/avatars.h"
#include "base/errors.h"
#include "tests/avatars/mesh_seeds.h"

namespace throng::mesh_file_test {
namespace {

namespace fs = std::filesystem;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

std::atomic<int> forks = 0;

class ReadMesh : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / fmt::format("throng_mesh_files_{}", ::getpid());
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  fs::path file(const std::string& name) const { return folder_ / name; }
  template <typename Bytes>
  fs::path write(const std::string& name, const Bytes& bytes) const {
    std::ofstream out(file(name), std::ios::binary);
    for (const auto byte : bytes) out.put(static_cast<char>(byte));
    return file(name);
  }
  static std::string complaint(const fs::path& path, const SandboxLimits& limits = {}) {
    try {
      read_mesh(path, limits);
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), StartsWith(path.string() + ": expected "));
      EXPECT_THAT(error.what(), testing::Not(HasSubstr("\n")));
      return error.what();
    }
    return "accepted";
  }
  static MeshSeed seed(const std::string& name) {
    for (MeshSeed& each : mesh_seeds())
      if (each.name == name) return each;
    throw std::runtime_error("no seed " + name);
  }

 private:
  fs::path folder_;
};

/// Sum of the tetrahedra under the triangles: checks the surface's place and orientation.
float volume_of(const Mesh& mesh) {
  float out = 0;
  for (const Eigen::Vector3i& t : mesh.triangles)
    out += mesh.vertices[static_cast<size_t>(t[0])]
               .cross(mesh.vertices[static_cast<size_t>(t[1])])
               .dot(mesh.vertices[static_cast<size_t>(t[2])]) /
           6;
  return out;
}

TEST_F(ReadMesh, NotesAnIgnoredUpAxis) {
  std::ifstream in(THRONG_SOURCE_DIR
                   "/tests/kinematics/fixtures/humanoid_description/meshes/torso.dae");
  const std::string z_up((std::istreambuf_iterator<char>(in)), {});
  const size_t at = z_up.find("Z_UP");
  ASSERT_NE(at, std::string::npos);
  const Mesh expected = read_mesh(write("z.dae", z_up));
  for (const char axis : {'X', 'Y', 'Z'}) {
    std::string text = z_up;
    text[at] = axis;
    std::vector<std::string> notes;
    const Mesh mesh = read_mesh(write("a.DAE", text), {}, &notes);
    EXPECT_EQ(mesh.vertices, expected.vertices);
    if (axis == 'Z')
      EXPECT_THAT(notes, testing::IsEmpty());
    else
      EXPECT_THAT(notes, testing::ElementsAre(HasSubstr(
                             fmt::format("mesh 'a.DAE' states {}_UP, which is ignored", axis))));
  }
}

TEST_F(ReadMesh, ReadsTheSameShapeFromEveryFormat) {
  int compared = 0;
  for (const MeshSeed& each : mesh_seeds()) {
    if (each.name == "md5mesh") continue;
    SCOPED_TRACE(each.name);
    Mesh mesh = read_mesh(write("a" + each.extension, each.bytes));
    EXPECT_EQ(mesh.vertices.size(), 9u);
    EXPECT_EQ(mesh.triangles.size(), 10u);
    // CAD formats swap y and z; .nff inverts the orientation.
    const bool swaps_axes = each.name == "3ds" || each.name == "dxf";
    if (swaps_axes)
      for (Eigen::Vector3f& v : mesh.vertices) v = Eigen::Vector3f(v.x(), -v.z(), v.y());
    EXPECT_NEAR(volume_of(mesh), each.name == "nff" ? -1.5f : 1.5f, 1e-5f);
    for (const Eigen::Vector3f& corner :
         {Eigen::Vector3f(0, 0, 0), Eigen::Vector3f(1, 0, 0), Eigen::Vector3f(0, 2, 0),
          Eigen::Vector3f(0, 0, 3), Eigen::Vector3f(2, 0, 0), Eigen::Vector3f(3, 0, 0),
          Eigen::Vector3f(3, 1, 0), Eigen::Vector3f(2, 1, 0), Eigen::Vector3f(2.5f, 0.5f, 1.5f)}) {
      float nearest = 1e9f;
      for (const Eigen::Vector3f& v : mesh.vertices)
        nearest = std::min(nearest, (v - corner).norm());
      EXPECT_LT(nearest, 1e-5f) << "nothing at " << corner.transpose();
    }
    ++compared;
  }
  EXPECT_GE(compared, 20);
  EXPECT_EQ(read_mesh(write("a.md5mesh", seed("md5mesh").bytes)).triangles.size(), 1u);
}

TEST_F(ReadMesh, AcceptsExtensionsInCapitals) {
  EXPECT_EQ(read_mesh(write("A.STL", seed("stl_binary").bytes)).triangles.size(), 10u);
}

TEST_F(ReadMesh, ReadsOrRejectsTruncatedPlyFiles) {
  const MeshSeed whole = seed("ply_binary");
  const SandboxLimits quick = {.cpu_s = 1};
  int rejected = 0;
  for (const size_t length : {50u, 400u, 900u, 1090u}) {
    const std::vector<uint8_t> cut(whole.bytes.begin(),
                                   whole.bytes.begin() + static_cast<ptrdiff_t>(length));
    rejected += complaint(write("cut.ply", cut), quick) == "accepted" ? 0 : 1;
  }
  EXPECT_GE(rejected, 2);
}

TEST_F(ReadMesh, RejectsAnEndlessHeaderInTime) {
  const SandboxLimits quick = {.cpu_s = 1, .wall_s = 60};
  EXPECT_THAT(complaint(write("a.ply", std::string("ply\nformat ascii 1.0\n")), quick),
              EndsWith("expected a ply mesh, found one that keeps assimp busy for more than 1 s of "
                       "processor time; export it again, for example as .stl or .tri"));
}

TEST_F(ReadMesh, AcceptsRegularFilesOnly) {
  ASSERT_EQ(::mkfifo(file("pipe.stl").c_str(), 0600), 0);
  EXPECT_THAT(complaint(file("pipe.stl")),
              EndsWith("expected a stl mesh, found a named pipe, not a regular file"));
  fs::create_symlink("/dev/zero", file("device.obj"));
  EXPECT_THAT(complaint(file("device.obj")), HasSubstr("found a device"));
  fs::create_directory(file("folder.dae"));
  EXPECT_THAT(complaint(file("folder.dae")), EndsWith("found a directory"));
  EXPECT_THAT(complaint(file("none.glb")), EndsWith("found no such file"));
  for (const char* extension : {".stl", ".obj", ".ply", ".dae", ".gltf", ".glb", ".3mf", ".off"})
    EXPECT_NE(complaint(write(fmt::format("empty{}", extension), std::string())), "accepted");
}

std::string gltf_with_buffer(const std::string& uri) {
  return fmt::format(
      R"({{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [0]}}],
"nodes": [{{"mesh": 0}}], "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}]}}],
"accessors": [{{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}}],
"bufferViews": [{{"buffer": 0, "byteLength": 36}}],
"buffers": [{{"byteLength": 36, "uri": "{}"}}]}})",
      uri);
}

TEST_F(ReadMesh, OpensOnlyRegularFilesNamedByAMesh) {
  const float corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  const auto* bytes = reinterpret_cast<const char*>(corners);
  write("three.bin", std::string(bytes, bytes + sizeof corners));
  const fs::path gltf = write("a.gltf", gltf_with_buffer("three.bin"));
  EXPECT_EQ(read_mesh(gltf).triangles.size(), 1u);
  ASSERT_EQ(::mkfifo(file("pipe.bin").c_str(), 0600), 0);
  EXPECT_THAT(complaint(write("b.gltf", gltf_with_buffer("pipe.bin"))), HasSubstr("pipe.bin"));
  EXPECT_NE(complaint(write("c.gltf", gltf_with_buffer("/dev/zero"))), "accepted");
  EXPECT_NE(complaint(write("d.gltf", gltf_with_buffer("."))), "accepted");
  ASSERT_EQ(::mkfifo(file("pipe.mtl").c_str(), 0600), 0);
  const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  EXPECT_EQ(complaint(write("a.obj", "mtllib pipe.mtl\n" + triangle)), "accepted");
}

TEST_F(ReadMesh, CountsNamedFilesTowardsTheSizeLimit) {
  const float corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  const auto* bytes = reinterpret_cast<const char*>(corners);
  write("three.bin", std::string(bytes, bytes + sizeof corners));
  const std::string text = gltf_with_buffer("three.bin");
  const fs::path gltf = write("a.gltf", text);
  EXPECT_EQ(complaint(gltf, {.max_file_bytes = text.size() + 36}), "accepted");
  EXPECT_NE(complaint(gltf, {.max_file_bytes = text.size() + 35}), "accepted");
}

TEST_F(ReadMesh, RejectsManyCopiesOfAMeshInFewBytes) {
  // Each of four nodes shows a triangle four times, and so on: 4^14 triangles in 3 kB.
  const float corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  const auto* bytes = reinterpret_cast<const char*>(corners);
  write("three.bin", std::string(bytes, bytes + sizeof corners));
  std::string text = gltf_with_buffer("three.bin");
  constexpr int kLevels = 14;
  std::string nodes = "\"nodes\": [";
  for (int level = 1; level <= kLevels; ++level)
    nodes += fmt::format("{{\"children\": [{0}, {0}, {0}, {0}]}}, ", level);
  const std::string_view before = "\"nodes\": [{\"mesh\"";
  text.replace(text.find(before), before.size(), nodes + "{\"mesh\"");
  EXPECT_NE(complaint(write("copies.gltf", text), {.max_memory_bytes = 512 << 20}), "accepted");
}

TEST_F(ReadMesh, RejectsIncompleteMeshes) {
  // assimp drops the first of two groups.
  EXPECT_THAT(
      complaint(write("a.raw", std::string("a\n0 0 0 0 2 0 1 0 0\nb\n2 0 0 2 1 0 3 1 0\n"))),
      HasSubstr("expected a mesh that assimp reads completely"));
}

TEST_F(ReadMesh, RejectsBadCoordinatesOfUsedVertices) {
  const std::string triangle = "v 1e30 0 0\nv 1 0 0\nv 0 1 0\n";
  EXPECT_THAT(complaint(write("far.obj", triangle + "f 1 2 3\n")),
              HasSubstr("expected coordinates within 10000 m, found (1e+30, 0, 0)"));
  EXPECT_EQ(complaint(write("unused.obj", "v 0 0 0\n" + triangle + "f 1 3 4\n")), "accepted");
}

TEST_F(ReadMesh, ReadsTriWithoutAChildProcess) {
  ASSERT_EQ(::pthread_atfork([] { ++forks; }, nullptr, nullptr), 0);
  forks = 0;
  load_model(adult_urdf());
  EXPECT_EQ(forks, 0);
  read_mesh(write("a.obj", seed("obj").bytes));
  EXPECT_EQ(forks, 1) << "the counter does not count";
}

}  // namespace
}  // namespace throng::mesh_file_test
