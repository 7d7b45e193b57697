// The version of a result: the build asks git about these sources only.
#include "base/version.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace throng::version_test {
namespace {

namespace fs = std::filesystem;

/// The version source that a build writes for the sources in this folder.
std::string written_for(const fs::path& sources) {
  const fs::path out = sources / "version.cpp";
  const std::string command = "cmake '-DOUT=" + out.string() + "' '-DSOURCE=" + sources.string() +
                              "' -DTHRONG_VERSION=1.2.3 -P '" THRONG_SOURCE_DIR
                              "/cmake/Version.cmake'";
  EXPECT_EQ(std::system(command.c_str()), 0) << command;
  std::ifstream in(out);
  return {std::istreambuf_iterator<char>(in), {}};
}

class Version : public testing::Test {
 protected:
  Version() { fs::create_directories(folder_); }
  ~Version() override { fs::remove_all(folder_); }

  const fs::path folder_ =
      fs::temp_directory_path() / ("throng version " + std::to_string(getpid()));
};

TEST_F(Version, NamesReleaseAndCommit) {
  EXPECT_THAT(std::string(version()), testing::MatchesRegex("[0-9]+\\.[0-9]+\\.[0-9]+"));
  EXPECT_THAT(std::string(commit()), testing::MatchesRegex("[0-9a-f]+(-dirty)?|unknown"));
}

TEST_F(Version, EqualsTheCitation) {
  std::ifstream in(THRONG_SOURCE_DIR "/CITATION.cff");
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  EXPECT_THAT(text, testing::HasSubstr("\nversion: " + std::string(version()) + "\n"));
}

TEST_F(Version, IsUnknownWithoutGit) {
  const std::string text = written_for(folder_);
  EXPECT_THAT(text, testing::HasSubstr("return \"1.2.3\";"));
  EXPECT_THAT(text, testing::HasSubstr("return \"unknown\";"));
}

TEST_F(Version, IgnoresAnOuterCheckout) {
  const std::string git = "git -C '" + folder_.string() + "' ";
  ASSERT_EQ(std::system((git + "init -q && " + git +
                         "-c user.name=a -c user.email=a@b commit -q --allow-empty -m a")
                            .c_str()),
            0);
  EXPECT_THAT(written_for(folder_), testing::Not(testing::HasSubstr("unknown")));
  fs::create_directories(folder_ / "archive");
  EXPECT_THAT(written_for(folder_ / "archive"), testing::HasSubstr("return \"unknown\";"));
}

TEST_F(Version, KeepsTheFileIfNothingChanged) {
  written_for(folder_);
  const auto long_ago = fs::file_time_type::clock::now() - std::chrono::hours(1);
  fs::last_write_time(folder_ / "version.cpp", long_ago);
  const auto before = fs::last_write_time(folder_ / "version.cpp");
  written_for(folder_);
  EXPECT_EQ(fs::last_write_time(folder_ / "version.cpp"), before);
}

}  // namespace
}  // namespace throng::version_test
