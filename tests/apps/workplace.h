// Workplace is a folder with all inputs of the commands; it shows what a rejected command changes.
#pragma once

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <functional>
#include <map>
#include <regex>
#include <string>

#include "tests/apps/cli.h"

namespace throng {

inline constexpr const char* kScene = R"(
name: my
duration_s: 1
ground: {min_m: [-10, -10], max_m: [10, 10]}
groups:
  - {name: them, model: body.urdf, count: 4, spawn: {min_m: [-8, -8], max_m: [0, 0]}, goals: [{min_m: [2, 2], max_m: [5, 5]}]}
  - {name: visitor, count: 1, spawn: {min_m: [-8, -8], max_m: [0, 0]}, goals: [{min_m: [2, 2], max_m: [5, 5]}]}
proximity_m: 0.1
separation: {human_speed_mps: 0, robot_speed_mps: 0, reaction_s: 0, stopping_s: 0}
obstacles:
  - {name: rock, kind: mesh, file: rock.tri, position_m: [0, 8]}
)";

inline constexpr const char* kTri = "4 4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n0 2 1\n0 1 3\n0 3 2\n1 2 3\n";

inline constexpr const char* kUrdf = R"(<robot name="body"><link name="base"><collision><geometry>
<mesh filename="body.tri"/></geometry></collision></link></robot>)";

class Workplace {
 public:
  Workplace() {
    static const std::string log = [] {
      const ScratchFolder folder;
      shell("throng run corridor --avatars 4 --seconds 0.1 --lcm off --log a.lcmlog", folder);
      return read_file(folder / "a.lcmlog");
    }();
    write_file(folder_ / "a.lcmlog", log);
    write_file(folder_ / "my.yaml", kScene);
    write_file(folder_ / "body.urdf", kUrdf);
    write_file(folder_ / "body.tri", kTri);
    write_file(folder_ / "rock.tri", kTri);
    write_file(folder_ / "room.wkt", "POLYGON ((0 0, 10 0, 10 6, 0 6))\n");
  }

  const ScratchFolder& folder() const { return folder_; }
  std::filesystem::path operator/(const std::string& name) const { return folder_ / name; }

  /// Records names, contents and times of all files.
  void look() { seen_ = state(); }
  void expect_untouched() const { EXPECT_EQ(state(), seen_); }

 private:
  std::map<std::string, std::string> state() const {
    std::map<std::string, std::string> all;
    for (const std::filesystem::directory_entry& entry :
         std::filesystem::recursive_directory_iterator(folder_.path())) {
      struct stat status {};
      ::lstat(entry.path().c_str(), &status);
      std::string text = fmt::format("inode {} mode {:o}", status.st_ino, status.st_mode);
      // Reading changes neither; trying out a file may change the time of its folder.
      if (entry.is_regular_file())
        text += fmt::format(" {}.{:09} {}", status.st_mtim.tv_sec, status.st_mtim.tv_nsec,
                            std::hash<std::string>()(read_file(entry.path())));
      all[entry.path().lexically_relative(folder_.path()).string()] = text;
    }
    return all;
  }

  ScratchFolder folder_;
  std::map<std::string, std::string> seen_;
};

/// Text of an error about two outputs that are one file.
inline constexpr const char* kTwice = "expected a separate ";

/// Removes notes about the scene, which may precede an error.
inline std::string without_notes(const std::string& text) {
  return std::regex_replace(text, std::regex("note: [^\\n]*\\n"), "");
}

/// Expects one line with `said`, the exit code, and an unchanged folder.
inline void expect_rejected(Workplace& place, const std::string& line, const std::string& said,
                            int exit_code = 2) {
  SCOPED_TRACE(line);
  place.look();
  const Outcome outcome = shell(line, place.folder());
  EXPECT_EQ(outcome.exit_code, exit_code) << outcome.err;
  EXPECT_THAT(outcome.out, testing::IsEmpty());
  EXPECT_EQ(line_count(without_notes(outcome.err)), 1) << outcome.err;
  EXPECT_THAT(outcome.err, testing::HasSubstr(said));
  place.expect_untouched();
}

}  // namespace throng
