// Explicit places at the start, and meshes of obstacles as arrays.
#include <gmock/gmock.h>

#include "scenes/run/simulation.h"
#include "tests/scenes/scene_file.h"

namespace throng::start_keys_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

class StartKeys : public SceneFile {
 protected:
  static std::string with_starts(const std::string& keys) {
    return kGround +
           "obstacles: [{kind: box, position_m: [10, 5], size_m: [1, 1, 2]}]\n"
           "groups:\n"
           "  - goals: [{min_m: [15, 1], max_m: [19, 9]}]\n" +
           keys;
  }
  /// Error of the first frame, without the folder.
  std::string complaint_of_run(const std::string& text) const {
    try {
      Simulation(load(text), {}).step();
    } catch (const InputError& error) {
      return std::string(error.what()).substr(folder_.string().size() + 1);
    }
    return "no complaint";
  }
};

TEST_F(StartKeys, ReadListsAndFilesAlike) {
  const Scene listed =
      load(with_starts("    positions_m: [[1.25, 2], [3, 4.5]]\n"
                       "    headings_rad: [0, 1.5]\n"
                       "    speeds_mps: [0.5, 1]\n"));
  write("starts.csv",
        "speed_mps, y_m, x_m, heading_rad\r\n# two people\r\n0.5,2,1.25,0\r\n\r\n1,4.5,3,1.5\r\n");
  const Scene filed = load(with_starts("    positions_m: {file: starts.csv}\n"));
  for (const Scene* scene : {&listed, &filed}) {
    const Group& group = scene->groups[0];
    EXPECT_EQ(group.count, 2);
    EXPECT_THAT(group.starts.positions_m,
                ElementsAre(Eigen::Vector2d(1.25, 2), Eigen::Vector2d(3, 4.5)));
    EXPECT_THAT(group.starts.headings_rad, ElementsAre(0, 1.5));
    EXPECT_THAT(group.starts.speeds_mps, ElementsAre(0.5, 1));
  }
  EXPECT_EQ(listed.content_hash, filed.content_hash);
}

TEST_F(StartKeys, ChangeTheContentHash) {
  const std::string places = "    positions_m: [[1, 2], [3, 4]]\n";
  const Scene plain = load(with_starts(places));
  EXPECT_EQ(load(with_starts(places + "    count: 2\n")).content_hash, plain.content_hash);
  for (const char* other : {"    positions_m: [[1, 2], [3, 5]]\n",
                            "    positions_m: [[1, 2], [3, 4]]\n    headings_rad: [0, 0]\n",
                            "    positions_m: [[1, 2], [3, 4]]\n    speeds_mps: [0, 0]\n"})
    EXPECT_NE(load(with_starts(other)).content_hash, plain.content_hash) << other;
}

TEST_F(StartKeys, PlaceAgentsExactly) {
  Simulation simulation(load(with_starts("    positions_m: [[1.1, 2.3], [3.7, 4.9]]\n"
                                         "    headings_rad: [1, -2]\n"
                                         "    speeds_mps: [0, 0.75]\n")),
                        {});
  const Frame& frame = simulation.step();
  EXPECT_EQ(frame.roots[0].position_m.head<2>(), Eigen::Vector2d(1.1, 2.3));
  EXPECT_EQ(frame.roots[1].position_m.head<2>(), Eigen::Vector2d(3.7, 4.9));
  EXPECT_FLOAT_EQ(frame.speeds_mps[0], 0);
  EXPECT_FLOAT_EQ(frame.speeds_mps[1], 0.75f);
}

TEST_F(StartKeys, NameInvalidRows) {
  const auto of_keys = [&](const std::string& keys) { return complaint(with_starts(keys)); };
  const std::string places = "    positions_m: [[1, 2], [3, 4]]\n";
  EXPECT_EQ(of_keys(places + "    count: 3\n"),
            "s.yaml:6: expected the number of 'positions_m', 2, or no 'count', found 3");
  EXPECT_EQ(of_keys(places + "    headings_rad: [1]\n"),
            "s.yaml:6: expected a list of 2 numbers for 'headings_rad', found a list of 1");
  EXPECT_THAT(of_keys("    count: 2\n    headings_rad: [1, 2]\n    spawn: {min_m: [1, 1], max_m: "
                      "[9, 9]}\n"),
              HasSubstr("expected 'positions_m' with 'headings_rad', found none"));
  EXPECT_THAT(of_keys(places + "    density_per_m2: 1\n"),
              HasSubstr("either 'positions_m' or 'density_per_m2'"));
  const auto of_file = [&](const std::string& text) {
    write("starts.csv", text);
    return of_keys("    positions_m: {file: starts.csv}\n");
  };
  EXPECT_EQ(of_file("x_m,y_m\n1,2\n3,b\n"),
            "starts.csv:3: expected a number from -100000 to 100000 for 'y_m', found 'b'");
  EXPECT_EQ(of_file("x_m,y_m\n1,nan\n"),
            "starts.csv:2: expected a number from -100000 to 100000 for 'y_m', found 'nan'");
  EXPECT_EQ(of_file("x_m,y_m\n1,2,3\n"), "starts.csv:2: expected 2 fields, found 3");
  EXPECT_THAT(of_file("x,y\n1,2\n"), StartsWith("starts.csv:1: expected the columns x_m, y_m"));
  EXPECT_THAT(of_file("x_m\n1\n"), StartsWith("starts.csv:1: expected the columns x_m, y_m"));
  EXPECT_THAT(of_file("x_m,y_m\n"), StartsWith("starts.csv: expected the columns x_m and y_m"));
}

TEST_F(StartKeys, RejectPlacesInWallsOutsideAndOnOthers) {
  const auto of_places = [&](const std::string& places) {
    return complaint_of_run(
        with_starts("    positions_m:\n      - [1, 2]\n      - " + places + "\n"));
  };
  EXPECT_EQ(of_places("[3, 2]"), "no complaint");
  EXPECT_THAT(of_places("[10, 5.1]"),
              StartsWith("s.yaml:7: expected position 2 of group 'group 1' on the ground"));
  EXPECT_THAT(of_places("[25, 5]"), HasSubstr("found [25, 5], in a wall or outside"));
  EXPECT_THAT(of_places("[0.05, 5]"), HasSubstr("found [0.05, 5], 0.05 m from one"));
  EXPECT_THAT(of_places("[1.1, 2]"), HasSubstr("found [1.1, 2], 0.1 m from the one at [1, 2]"));
  EXPECT_EQ(of_places("[1.3, 2]"), "no complaint");
}

TEST_F(StartKeys, CannotBeScaled) {
  Scene scene = load(with_starts("    positions_m: [[1, 2]]\n"));
  std::vector<std::string> notes;
  EXPECT_THROW(scale_to(scene, 5, notes), InputError);
}

class MeshKeys : public SceneFile {
 protected:
  static std::string with_mesh(const std::string& keys) {
    return kGround +
           "groups: [{count: 1, spawn: {min_m: [1, 1], max_m: [2, 2]}, goals: [{min_m: [8, 1], "
           "max_m: [9, 2]}]}]\n"
           "obstacles:\n  - {kind: mesh, position_m: [5, 5], " +
           keys + "}\n";
  }
};

TEST_F(MeshKeys, MakeTheMeshOfAFile) {
  write("wedge.tri", "4 4\n0 0 0\n1 0 0\n0 1 0\n0 0 1.5\n0 2 1\n0 1 3\n0 3 2\n1 2 3\n");
  const Scene filed = load(with_mesh("file: wedge.tri"));
  const Scene given =
      load(with_mesh("vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.5]], "
                     "triangles: [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]"));
  EXPECT_EQ(given.obstacles[0].mesh.vertices, filed.obstacles[0].mesh.vertices);
  EXPECT_EQ(given.obstacles[0].mesh.triangles, filed.obstacles[0].mesh.triangles);
  EXPECT_EQ(given.content_hash, filed.content_hash);
}

TEST_F(MeshKeys, RejectInvalidArrays) {
  const auto of_keys = [&](const std::string& keys) { return complaint(with_mesh(keys)); };
  const std::string vertices = "vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0]]";
  EXPECT_THAT(of_keys(vertices), HasSubstr("the key 'triangles' in an obstacle, found none"));
  EXPECT_THAT(of_keys("triangles: [[0, 1, 2]]"), HasSubstr("the key 'vertices'"));
  EXPECT_THAT(of_keys(vertices + ", triangles: [[0, 1, 3]]"), HasSubstr("'triangles' from 0 to 2"));
  EXPECT_THAT(of_keys(vertices + ", triangles: [[0, 1, 1.5]]"),
              HasSubstr("expected three numbers of vertices"));
  EXPECT_THAT(of_keys(vertices + ", triangles: [[0, 1]]"),
              HasSubstr("expected three numbers in each item of 'triangles'"));
  EXPECT_THAT(of_keys(vertices + ", triangles: [[0, 1, 2]], file: a.tri"),
              HasSubstr("either 'vertices' or 'file'"));
  EXPECT_THAT(of_keys("vertices: [[0, 0, 0], [1, 0, 0], [2, 0, 0]], triangles: [[0, 1, 2]]"),
              HasSubstr("a mesh that covers some ground"));
}

}  // namespace
}  // namespace throng::start_keys_test
