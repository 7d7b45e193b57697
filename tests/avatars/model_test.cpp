// Models: a URDF and the meshes of its links, merged by part in the link's frame.
#include "avatars/model/model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cstdlib>
#include <fstream>

#include "avatars/mesh/mesh_file.h"
#include "avatars/model/describe.h"
#include "base/errors.h"

namespace throng::model_test {
namespace {

using testing::HasSubstr;

std::filesystem::path fixtures() {
  return std::filesystem::path(THRONG_SOURCE_DIR) / "tests/kinematics/fixtures";
}

const Part& part_named(const Model& model, const std::string& name) {
  for (const Part& part : model.parts)
    if (part.name == name) return part;
  throw std::logic_error("no part " + name);
}

Eigen::AlignedBox3f bounds_of(const Mesh& mesh) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& v : mesh.vertices) box.extend(v);
  return box;
}

void expect_box(const Mesh& mesh, const Eigen::Vector3f& min, const Eigen::Vector3f& max) {
  const Eigen::AlignedBox3f box = bounds_of(mesh);
  EXPECT_LT((box.min() - min).norm(), 1e-6f) << "lowest corner " << box.min().transpose();
  EXPECT_LT((box.max() - max).norm(), 1e-6f) << "highest corner " << box.max().transpose();
}

/// A separate folder for each test, removed afterwards.
class LoadModel : public testing::Test {
 protected:
  LoadModel() : folder_(std::filesystem::path(testing::TempDir()) / make_name()) {
    std::filesystem::create_directories(folder_);
  }
  ~LoadModel() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path write(const std::string& name, const std::string& text) const {
    auto path = folder_ / name;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary) << text;
    return path;
  }

  const std::filesystem::path& folder() const { return folder_; }

 private:
  static std::string make_name() {
    return std::string("throng_") + testing::UnitTest::GetInstance()->current_test_info()->name();
  }
  std::filesystem::path folder_;
};

std::string one_link(const std::string& inner) {
  return std::string("<robot name='r'><link name='a'>").append(inner).append("</link></robot>");
}

/// A closed tetrahedron with outward faces and edges 1, 2 and 3 along x, y, z.
constexpr const char* kTetrahedron =
    "4\n0 0 0\n1 0 0\n0 2 0\n0 0 3\n4\n0 2 1\n0 1 3\n0 3 2\n1 2 3\n";

TEST(Model, LoadsThe15PartsOfTheAdult) {
  const auto adult = load_model(adult_urdf());
  EXPECT_EQ(adult->name, "adult");
  EXPECT_EQ(adult->part_count(), 15);
  EXPECT_EQ(adult->kinematics.output_count(), 15);
  for (const Part& part : adult->parts) {
    EXPECT_EQ(part.source, part.name + ".tri");
    EXPECT_TRUE(is_closed(part.mesh)) << part.name;
    EXPECT_GT(signed_volume_m3(part.mesh), 0) << part.name;
  }
  EXPECT_NEAR(adult->height_m, 1.75f, 0.01f);
}

TEST(Model, LoadsDaeStlObjAndTriMeshes) {
  const auto model = load_model(fixtures() / "humanoid_description/urdf/humanoid.urdf");
  EXPECT_EQ(model->part_count(), 19);
  // Collada: centimetres, the node raised by 22 cm and rotated by 90 degrees.
  expect_box(part_named(*model, "torso").mesh, {-0.13f, -0.10f, 0.04f}, {0.13f, 0.10f, 0.40f});
  // Binary STL in millimetres; the right one mirrored by a negative scale.
  expect_box(part_named(*model, "left_thigh").mesh, {-0.045f, -0.05f, -0.33f},
             {0.045f, 0.05f, -0.03f});
  expect_box(part_named(*model, "right_thigh").mesh, {-0.045f, -0.05f, -0.33f},
             {0.045f, 0.05f, -0.03f});
  // OBJ with quads.
  expect_box(part_named(*model, "left_shank").mesh, {-0.04f, -0.04f, -0.34f},
             {0.04f, 0.04f, -0.02f});
  EXPECT_EQ(part_named(*model, "head").source, "head.tri");
  // The foot has collision geometry, which takes precedence over its ASCII STL.
  EXPECT_EQ(part_named(*model, "left_foot").source, "box");
  for (const Part& part : model->parts) {
    EXPECT_TRUE(is_closed(part.mesh)) << part.name;
    EXPECT_GT(signed_volume_m3(part.mesh), 0) << part.name << " is inside out";
  }
}

TEST(Model, SkipsLinksWithoutGeometry) {
  const auto model = load_model(fixtures() / "wheels.urdf");
  std::vector<std::string> names;
  for (const Part& part : model->parts) {
    names.push_back(part.name);
    EXPECT_EQ(model->robot.links[static_cast<size_t>(part.link)].name, part.name);
  }
  EXPECT_THAT(names,
              testing::ElementsAre("base_link", "left_wheel", "right_wheel", "caster_wheel"));
  // The ball of its caster reaches 0.9 mm below the root.
  EXPECT_NEAR(model->height_m, 0.1f + 0.25f + 0.2f, 1e-3f);
}

TEST(Model, IsAPersonIfItHasHumanLegs) {
  const auto adult = load_model(adult_urdf());
  EXPECT_TRUE(adult->is_person);
  EXPECT_EQ(adult->root_height_m(), 0) << "the root of people lies on the ground";
  const auto rover =
      load_model(std::filesystem::path(THRONG_SOURCE_DIR) / "tests/lcm_io/fixtures/rover.urdf");
  EXPECT_FALSE(rover->is_person);
  EXPECT_NEAR(rover->root_height_m(), 0.1f, 1e-6f) << "half the height of its base";
  EXPECT_FALSE(load_model(fixtures() / "humanoid_description/urdf/humanoid.urdf")->is_person)
      << "other names than the gait knows";
}

TEST_F(LoadModel, StartsRobotsNearZeroWithinTheirLimits) {
  const auto model = load_model(write(
      "crane.urdf",
      "<robot name='crane'><link name='a'><collision><geometry><box size='2 1 1'/></geometry>"
      "</collision></link><link name='b'><collision><geometry><box size='0.2 0.2 0.2'/></geometry>"
      "</collision></link><joint name='hoist' type='prismatic'><parent link='a'/><child link='b'/>"
      "<axis xyz='0 0 -1'/><limit lower='3' upper='5' effort='1' velocity='1'/></joint></robot>"));
  EXPECT_FALSE(model->is_person);
  EXPECT_NEAR(model->root_height_m(), 3.1f, 1e-6f) << "the hook is the lowest";
  EXPECT_NEAR(model->height_m, 3.6f, 1e-6f);
  EXPECT_NEAR(model->footprint_radius_m(), std::hypot(1.0f, 0.5f), 1e-6f);
  const std::string text = describe_model(*model);
  EXPECT_THAT(text, HasSubstr("size: 2.000 x 1.000 x 3.600 m with every joint at zero"));
  EXPECT_THAT(text, HasSubstr("height: 3.600 m; a robot: "));
  EXPECT_THAT(text, HasSubstr("its root 'a' 3.100 m above the ground"));
}

TEST_F(LoadModel, RejectsMeshesScaledBeyondTheLimit) {
  write("a.tri", kTetrahedron);
  const auto scaled = [&](const char* scale) {
    return load_model(
        write("r.urdf", one_link(std::string("<visual><geometry><mesh filename='a.tri' scale='")
                                     .append(scale)
                                     .append("'/></geometry></visual>"))));
  };
  EXPECT_NO_THROW(scaled("1e5 1e5 1e5"));
  try {
    scaled("1e6 1e6 1e6");
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(),
                HasSubstr("r.urdf: expected every vertex of 'a.tri' within 1e+06 m of "
                          "link 'a', found one at (0, 2e+06, 0) m"));
  }
}

TEST_F(LoadModel, AppliesOriginAndScaleOfMeshes) {
  write("a.tri", kTetrahedron);
  const auto model = load_model(write(
      "r.urdf", one_link("<visual><origin xyz='10 0 0' rpy='0 0 1.5707963267948966'/><geometry>"
                         "<mesh filename='a.tri' scale='2 1 -1'/></geometry></visual>")));
  // Scaled: x 0..2, y 0..2, z -3..0; rotated about z: x -> y, y -> -x; translated.
  expect_box(model->parts[0].mesh, {8, 0, -3}, {10, 2, 0});
  EXPECT_NEAR(signed_volume_m3(model->parts[0].mesh), 2.0, 1e-5)
      << "a mirrored mesh stays oriented outwards";
}

TEST_F(LoadModel, MergesShapesOfALink) {
  const auto model = load_model(
      write("r.urdf", one_link("<collision><geometry><box size='1 1 1'/></geometry></collision>"
                               "<collision><origin xyz='5 0 0'/><geometry><sphere "
                               "radius='0.5'/></geometry></collision>")));
  ASSERT_EQ(model->part_count(), 1);
  EXPECT_EQ(model->parts[0].source, "box + sphere");
  EXPECT_EQ(model->parts[0].mesh.vertices.size(), 8u + 162u);
  EXPECT_EQ(model->parts[0].mesh.triangles.size(), 12u + 320u);
  EXPECT_TRUE(is_closed(model->parts[0].mesh));
}

TEST_F(LoadModel, ReadsCapsulesAsClosedParts) {
  const auto model = load_model(
      write("r.urdf", one_link("<collision><origin xyz='0 0 2'/><geometry><capsule radius='0.5' "
                               "length='2'/></geometry></collision>")));
  EXPECT_EQ(model->parts[0].source, "capsule");
  EXPECT_TRUE(is_closed(model->parts[0].mesh));
  EXPECT_NEAR(model->start_box_m.min().z(), 0.5, 1e-4);
  EXPECT_NEAR(model->start_box_m.max().z(), 3.5, 1e-4);
}

TEST_F(LoadModel, SearchesPackagesUpwardsThenInTheRosPackagePath) {
  const auto urdf = [](const char* uri) {
    return one_link(std::string("<visual><geometry><mesh filename='")
                        .append(uri)
                        .append("'/></geometry></visual>"));
  };
  write("ws/some_robot/meshes/a.tri", kTetrahedron);
  write("ws/renamed/package.xml", "<package><name> by_manifest </name></package>");
  write("ws/renamed/meshes/b.tri", kTetrahedron);
  write("elsewhere/far/c.tri", kTetrahedron);
  EXPECT_NO_THROW(
      load_model(write("ws/some_robot/urdf/own.urdf", urdf("package://some_robot/meshes/a.tri"))));
  EXPECT_NO_THROW(
      load_model(write("ws/renamed/urdf/m.urdf", urdf("package://by_manifest/meshes/b.tri"))));
  EXPECT_NO_THROW(
      load_model(write("ws/other/urdf/sibling.urdf", urdf("package://some_robot/meshes/a.tri"))));
  EXPECT_NO_THROW(load_model(write("ws/other/urdf/rel.urdf", urdf("../../renamed/meshes/b.tri"))));
  EXPECT_NO_THROW(load_model(write(
      "ws/file.urdf", urdf(("file://" + (folder() / "elsewhere/far/c.tri").string()).c_str()))));
  const auto far = write("ws/far.urdf", urdf("package://far/c.tri"));
  try {
    load_model(far);
    FAIL() << "found a package that is nowhere above";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("found none for 'package://far/c.tri'"));
  }
  setenv("ROS_PACKAGE_PATH", (std::string("/nowhere:") + (folder() / "elsewhere").string()).c_str(),
         1);
  EXPECT_NO_THROW(load_model(far));
  unsetenv("ROS_PACKAGE_PATH");
}

TEST_F(LoadModel, HashesContentIndependentOfPlace) {
  const std::string urdf =
      one_link("<visual><geometry><mesh filename='a.tri'/></geometry></visual>");
  write("one/a.tri", kTetrahedron);
  write("two/a.tri", kTetrahedron);
  std::string other = kTetrahedron;
  other.replace(other.find("0 0 3"), 5, "0 0 4");
  write("three/a.tri", other);
  const uint64_t one = load_model(write("one/r.urdf", urdf))->content_hash;
  EXPECT_EQ(one, load_model(write("two/renamed.urdf", urdf))->content_hash);
  EXPECT_NE(one, load_model(write("three/r.urdf", urdf))->content_hash) << "another mesh";
  EXPECT_NE(one, load_model(write("one/s.urdf", urdf + " "))->content_hash) << "another URDF text";
}

TEST_F(LoadModel, RejectsBadMeshesByName) {
  const auto complaint = [&](const std::string& mesh, const std::string& text) -> std::string {
    const auto path = write(mesh, text);
    try {
      read_mesh(path);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_THAT(complaint("a.stl", "solid a\nendsolid a\n"), HasSubstr("a.stl: expected"));
  EXPECT_THAT(complaint("cut.stl", std::string(84, '\x01')), HasSubstr("cut.stl: expected"));
  EXPECT_THAT(complaint("a.obj", "v 0 0 0\nv 1 0 0\n"), HasSubstr("a.obj: expected"));
  EXPECT_THAT(complaint("nan.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
              HasSubstr("nan.obj: expected"));
  EXPECT_THAT(complaint("range.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"),
              HasSubstr("range.obj: expected"));
  EXPECT_THAT(complaint("a.dae", "<COLLADA>"), HasSubstr("a.dae: expected"));
  EXPECT_THAT(complaint("a.xyzzy", "?"), HasSubstr("expected a mesh in .tri, .stl"));
  EXPECT_THROW(read_mesh(folder()), InputError);
  EXPECT_THROW(read_mesh(folder() / "none.stl"), InputError);
}

TEST_F(LoadModel, RejectsLinksWithSurfaceAndPointCloud) {
  write("cloud.tri", "3\n0 0 0\n1 0 0\n0 1 0\n");
  const std::string cloud = "<visual><geometry><mesh filename='cloud.tri'/></geometry></visual>";
  EXPECT_TRUE(load_model(write("c.urdf", one_link(cloud)))->parts[0].mesh.is_point_cloud());
  const std::string box = "<visual><geometry><box size='1 1 1'/></geometry></visual>";
  EXPECT_THROW(load_model(write("d.urdf", one_link(cloud + box))), InputError);
}

TEST_F(LoadModel, RejectsModelsWithoutGeometry) {
  EXPECT_THROW(load_model(write("r.urdf", one_link(""))), InputError);
}

TEST_F(LoadModel, TakesTheDataDirectoryFromTheEnvironment) {
  std::filesystem::create_directories(folder() / "avatars/models");
  setenv("THRONG_DATA", folder().c_str(), 1);
  EXPECT_EQ(data_directory(), folder());
  setenv("THRONG_DATA", "/nowhere", 1);
  EXPECT_THROW(data_directory(), EnvironmentError);
  unsetenv("THRONG_DATA");
  EXPECT_TRUE(std::filesystem::exists(adult_urdf()));
}

TEST(Describe, PrintsTreePartsAndIgnoredTags) {
  const auto model = load_model(fixtures() / "humanoid_description/urdf/humanoid.urdf");
  const std::string text = describe_model(*model);
  EXPECT_THAT(text, HasSubstr("model 'humanoid': 31 links, 30 joints, 19 parts"));
  EXPECT_THAT(text, HasSubstr("degrees of freedom: 25 (3 fixed joints, 2 mimic joints)"));
  EXPECT_THAT(text, HasSubstr("left_knee: revolute, axis y, 0.000 to 2.300 rad"));
  EXPECT_THAT(text, HasSubstr("mimics left_finger1_joint x 1 + 0"));
  EXPECT_THAT(text, HasSubstr("<transmission> x25: drives are not simulated"));
  EXPECT_THAT(text, HasSubstr("<self_collision_checking> x1: not understood"));
  EXPECT_EQ(text.find(fixtures().string()), std::string::npos) << "an absolute path";
}

TEST_F(LoadModel, DescribesUrdfsWithMissingMeshes) {
  const auto urdf = write(
      "r.urdf",
      "<robot name='r'><link name='a'><visual><geometry><mesh filename='package://gone/a.stl'/>"
      "</geometry></visual></link><link name='b'><visual><geometry><box size='1 1 1'/></geometry>"
      "</visual></link><joint name='j' type='continuous'><parent link='a'/><child "
      "link='b'/></joint>"
      "</robot>");
  EXPECT_THROW(load_model(urdf), InputError);
  bool complete = true;
  const std::string text = describe_urdf(urdf, complete);
  EXPECT_FALSE(complete);
  EXPECT_THAT(text, HasSubstr("b *  (j: continuous, axis x)"));
  EXPECT_THAT(text, HasSubstr("link 'a': "));
  EXPECT_THAT(text, HasSubstr("found none for 'package://gone/a.stl'"));
  describe_urdf(fixtures() / "wheels.urdf", complete);
  EXPECT_TRUE(complete);
}

TEST(Describe, PrintsDialectSizeAndVolumeOfTriFiles) {
  const std::string text = describe_tri(parse_tri(kTetrahedron, "t.tri"), "t.tri");
  EXPECT_THAT(text, HasSubstr("t.tri: 4 vertices, 4 triangles"));
  EXPECT_THAT(text, HasSubstr("0-based"));
  EXPECT_THAT(text, HasSubstr("(0.0000, 0.0000, 0.0000) to (1.0000, 2.0000, 3.0000) m"));
  EXPECT_THAT(text, HasSubstr("surface: closed"));
  EXPECT_THAT(text, HasSubstr("volume: 1.000000 m3"));
}

}  // namespace
}  // namespace throng::model_test
