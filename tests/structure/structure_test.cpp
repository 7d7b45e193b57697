// The tree is the architecture: includes point one way, only some folders use a library, and no
// file names the machine it was written on.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>

#include "tests/structure/source_tree.h"

namespace throng::structure_test {
namespace {

using Names = std::set<std::string, std::less<>>;

const std::set<std::string_view> kCode = {".cpp", ".h"};

/// `more` and the folders that all bodies need.
Names below(Names more) {
  more.insert({"kinematics", "culling", "avatars", "geometry"});
  return more;
}

/// Folders that a folder may include, in addition to itself and base.
const std::map<std::string, Names> kMayInclude = {
    {"base", {}},
    {"kinematics", {}},
    {"culling", {}},
    {"geometry", {}},
    {"avatars", {"kinematics", "culling"}},
    {"recordings", {"culling", "geometry"}},
    {"crowd", {"kinematics", "culling", "avatars", "geometry"}},
    {"scenes", below({"crowd", "recordings"})},
    {"lcm_io", below({"crowd", "recordings", "scenes"})},
    {"analysis", below({"crowd", "recordings", "scenes", "lcm_io"})},
    {"viewer", below({"crowd", "recordings", "scenes", "lcm_io", "analysis"})},
    {"python", below({"crowd", "recordings", "scenes", "lcm_io", "analysis", "viewer"})},
    {"bench", below({"crowd", "recordings", "scenes", "lcm_io", "analysis", "viewer"})},
    {"apps", below({"crowd", "recordings", "scenes", "lcm_io", "analysis", "viewer", "bench"})},
    {"examples", below({"crowd", "recordings", "scenes", "lcm_io", "bench"})},
};

/// Folders that may include a library's headers, by the first part of the header's path. Tests of a
/// folder may include what the folder may.
const std::map<std::string, Names> kLibraryOf = {
    {"kdl", {"kinematics", "bench"}},
    {"urdf_parser", {"kinematics"}},
    {"urdf_model", {"kinematics"}},
    {"urdf_exception", {"kinematics"}},
    {"console_bridge", {"kinematics"}},
    {"assimp", {"avatars"}},
    {"yaml-cpp", {"scenes"}},
    {"sqlite3.h", {"recordings", "analysis"}},
    {"mpi.h", {"analysis"}},
    {"zstd.h", {"lcm_io"}},
    {"hdf5.h", {"recordings"}},
    {"boost", {"geometry", "analysis"}},
    {"Recast.h", {"crowd"}},
    {"DetourNavMesh.h", {"crowd"}},
    {"DetourNavMeshQuery.h", {"crowd"}},
    {"DetourNavMeshBuilder.h", {"crowd"}},
    {"lcm", {"lcm_io", "examples"}},
    {"fcl", {"culling", "bench", "examples"}},
    {"tbb", {"base"}},
    {"hwy", {"base", "kinematics", "culling", "avatars", "crowd"}},
    {"png.h", {"scenes", "viewer"}},
    {"webp", {"viewer"}},
    {"CLI", {"apps"}},
    {"nlohmann", {"apps", "bench", "paper", "scenes", "viewer"}},
    {"pybind11", {"python"}},
    {"glib.h", {"viewer"}},
    {"zlib.h", {"recordings", "viewer"}},
};

std::string first_part(const std::string& path) { return path.substr(0, path.find('/')); }

class Structure : public testing::Test {
 protected:
  static const std::vector<SourceFile>& files() {
    static const std::vector<SourceFile> tree = read_source_tree();
    return tree;
  }
};

TEST_F(Structure, IncludesPointOneWay) {
  int seen = 0;
  for (const SourceFile& file : files()) {
    const auto allowed = kMayInclude.find(file.folder());
    if (!file.has_extension(kCode) || file.is_test() || allowed == kMayInclude.end()) continue;
    for (const Include& include : includes_of(file)) {
      const std::string folder = first_part(include.path);
      if (!kMayInclude.contains(folder)) continue;
      ++seen;
      EXPECT_TRUE(folder == file.folder() || folder == "base" || allowed->second.contains(folder))
          << file.path << ":" << include.line << ": " << file.folder() << " must not include "
          << folder;
    }
  }
  EXPECT_GT(seen, 100) << "the test no longer finds the sources";
}

TEST_F(Structure, LibrariesStayInTheirFolder) {
  Names seen;
  for (const SourceFile& file : files()) {
    if (!file.has_extension(kCode)) continue;
    for (const Include& include : includes_of(file)) {
      const auto library = kLibraryOf.find(first_part(include.path));
      if (library == kLibraryOf.end()) continue;
      seen.insert(library->first);
      EXPECT_TRUE(library->second.contains(file.folder()))
          << file.path << ":" << include.line << ": <" << include.path << "> may be included by "
          << *library->second.begin() << "/";
    }
  }
  EXPECT_TRUE(seen.contains("kdl") && seen.contains("lcm") && seen.contains("CLI"))
      << "the test no longer finds the sources";
}

// Only bench, which measures volumes, and four files that fit or draw one may include volumes.
TEST_F(Structure, CullingIsIncludedByItsInterface) {
  const std::set<std::string_view> door = {"culling/bodies.h",
                                           "culling/body_type.h",
                                           "culling/counters.h",
                                           "culling/culler.h",
                                           "culling/culling.h",
                                           "culling/distance/hull_depth.h",
                                           "culling/event_hash.h",
                                           "culling/proximity.h",
                                           "culling/pair.h",
                                           "culling/pair_filter.h",
                                           "culling/part_distance.h",
                                           "culling/part_tally.h",
                                           "culling/strategies/paper_culler.h",
                                           "culling/strategies/strategy.h",
                                           "culling/volumes/volume_kind.h"};
  const std::set<std::string_view> behind = {
      "avatars/gait/gait_sphere.cpp", "scenes/motion/box_motion.cpp",
      "viewer/picture/volume_outline.cpp", "viewer/server/run_message.cpp"};
  std::set<std::string> seen;
  for (const SourceFile& file : files()) {
    if (!file.has_extension(kCode) || file.is_test() || file.folder() == "culling" ||
        file.folder() == "bench")
      continue;
    for (const Include& include : includes_of(file)) {
      if (first_part(include.path) != "culling" || door.contains(include.path)) continue;
      seen.insert(file.path);
      EXPECT_TRUE(behind.contains(file.path))
          << file.path << ":" << include.line << ": " << include.path << " is internal to culling";
    }
  }
  EXPECT_EQ(seen.size(), behind.size()) << "an exception is no longer needed";
}

// A program that includes only the header of a library can catch what its functions throw.
TEST_F(Structure, PublicHeadersBringTheErrors) {
  const std::set<std::string_view> doors = {"avatars/avatars.h", "bench/workbench/workbench.h",
                                            "culling/culling.h", "kinematics/kinematics.h",
                                            "lcm_io/lcm_io.h",   "scenes/scenes.h"};
  size_t seen = 0;
  for (const SourceFile& file : files()) {
    if (!doors.contains(file.path)) continue;
    ++seen;
    bool brings_errors = false;
    for (const Include& include : includes_of(file))
      brings_errors |= include.path == "base/errors.h";
    EXPECT_TRUE(brings_errors) << file.path;
  }
  EXPECT_EQ(seen, doors.size()) << "the test no longer finds the headers";
}

TEST_F(Structure, HeadersAreIncludedByFullPath) {
  for (const SourceFile& file : files()) {
    if (!file.has_extension(kCode) || file.is_test()) continue;
    for (const Include& include : includes_of(file))
      EXPECT_TRUE(include.angled || include.path.find('/') != std::string::npos)
          << file.path << ":" << include.line << ": \"" << include.path << "\"";
  }
}

TEST_F(Structure, HeadersBeginWithAComment) {
  for (const SourceFile& file : files()) {
    if (!file.has_extension({".h"})) continue;
    EXPECT_TRUE(file.text.starts_with("// ")) << file.path;
    const bool repeats = file.path.ends_with("-inl.h");  // compiled per target, with its own guard
    EXPECT_TRUE(repeats || file.text.find("\n#pragma once\n") != std::string::npos) << file.path;
  }
}

TEST_F(Structure, OnlyConsoleWritesToStandardError) {
  // Other functions may throw or end the process if stderr fails.
  const std::vector<std::string_view> ways = {"stderr", "std::cerr", "std::clog", "perror(",
                                              "STDERR_FILENO,"};
  bool is_found = false;
  for (const SourceFile& file : files()) {
    if (!file.has_extension(kCode) || file.is_test()) continue;
    for (const Line& line : lines_of(file)) {
      const std::string_view code = line.text.substr(0, line.text.find("//"));
      // The report path of a sanitizer is no message of Throng.
      if (code.find("__sanitizer_set_report_path") != std::string_view::npos) continue;
      for (const std::string_view way : ways) {
        if (code.find(way) == std::string_view::npos) continue;
        is_found |= file.path == "base/console.cpp";
        EXPECT_EQ(file.path, "base/console.cpp")
            << file.path << ":" << line.number
            << ": messages go through print_message() of base/console.h: " << line.text;
      }
    }
  }
  EXPECT_TRUE(is_found) << "the test no longer finds the sources";
}

TEST_F(Structure, NoFileNamesTheMachine) {
  // Concatenated, because this file must not match itself.
  std::vector<std::string> places;
  for (const char* folder : {"home", "root", "work", "Users", "mnt"})
    places.push_back(fmt::format("/{}/", folder));
  for (const SourceFile& file : files()) {
    for (const Line& line : lines_of(file)) {
      for (const std::string& place : places) {
        const size_t at = line.text.find(place);
        // An absolute path follows a blank, a quote or similar; "a/work/b" is relative.
        const bool absolute = at != std::string::npos &&
                              (at == 0 || std::string_view(" \t\"'`=:(<").find(line.text[at - 1]) !=
                                              std::string::npos);
        EXPECT_FALSE(absolute) << file.path << ":" << line.number << ": " << line.text;
      }
    }
  }
}

}  // namespace
}  // namespace throng::structure_test
