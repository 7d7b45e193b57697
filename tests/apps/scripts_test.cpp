// The setup scripts with stand-ins for the programs that they call: nothing is installed or built.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/apps/cli.h"

namespace throng::scripts_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

/// A checkout with only the scripts, and a folder of stand-ins first in PATH.
class Scripts : public testing::Test {
 protected:
  void SetUp() override {
    fs::copy(THRONG_SOURCE_DIR "/scripts", folder_ / "scripts");
    fs::create_directory(folder_ / "bin");
    stand_in("sudo", "exec \"$@\"");
  }
  void stand_in(const std::string& name, const std::string& text) {
    write_file(folder_ / ("bin/" + name), "#!/bin/sh\n" + text + "\n");
    fs::permissions(folder_ / ("bin/" + name), fs::perms::owner_all);
  }
  Outcome run(const std::string& line) {
    return shell("PATH=\"$PWD/bin:$PATH\"; export PATH; " + line, folder_);
  }
  ScratchFolder folder_;
};

/// Output of apt-get with status lines on stdout: a line of dpkg per package and the two kinds of
/// status.
constexpr const char* kAptGet = R"sh(case "$*" in
  *print-uris*)
    echo "4 upgraded, 594 newly installed, 0 to remove and 22 not upgraded."
    echo "Need to get 240 MB of archives."
    echo "After this operation, 1158 MB of additional disk space will be used."
    ;;
  *install*)
    for percent in 0 10.5 50 99; do echo "dlstatus:1:$percent:Retrieving file 1 of 9"; done
    for percent in 0 30.25 80; do
      echo "Selecting previously unselected package libone."
      echo "pmstatus:libone:amd64:$percent:Unpacking libone (amd64)"
    done
    if [ -e fails ]; then echo "E: no space left"; exit 100; fi
    ;;
esac)sh";

TEST_F(Scripts, SetupReportsCostAndProgress) {
  stand_in("dpkg-query", "exit 1");
  stand_in("apt-get", kAptGet);
  const Outcome setup = run("bash scripts/setup.sh");
  EXPECT_EQ(setup.exit_code, 0) << setup.err;
  EXPECT_EQ(setup.out, "");
  EXPECT_THAT(setup.err, HasSubstr("594 packages, 240 MB to download, 1158 MB on disk"));
  EXPECT_THAT(setup.err, HasSubstr("downloading: 50 %\n"));
  EXPECT_THAT(setup.err, HasSubstr("unpacking and setting up: 75 %\n"));
  EXPECT_THAT(setup.err, Not(HasSubstr("Selecting")));
  EXPECT_LE(line_count(setup.err), 10) << setup.err;
}

TEST_F(Scripts, SetupShowsTheOutputOnFailure) {
  stand_in("dpkg-query", "exit 1");
  stand_in("apt-get", kAptGet);
  const Outcome setup = run("touch fails; bash scripts/setup.sh");
  EXPECT_EQ(setup.exit_code, 3);
  EXPECT_THAT(setup.err, HasSubstr("Selecting previously unselected package libone."));
  EXPECT_THAT(setup.err, HasSubstr("E: no space left"));
  EXPECT_THAT(setup.err, HasSubstr("scripts/setup.sh: apt-get could not install: "));
}

TEST_F(Scripts, DemoReplaysItsLogOnTheDefaultUrl) {
  const std::string header = read_file(THRONG_SOURCE_DIR "/lcm_io/codec/channels.h");
  const size_t constant = header.find("kDefaultLcmUrl");
  ASSERT_NE(constant, std::string::npos);
  const size_t url = header.find('"', constant) + 1;
  EXPECT_THAT(read_file(folder_ / "scripts/demo.sh"),
              HasSubstr("lcm-logplayer --lcm-url='" +
                        header.substr(url, header.find('"', url) - url) + "'"));
}

TEST_F(Scripts, BuildConfiguresAgainAfterAJdkIsInstalled) {
  stand_in("cmake", "echo \"$*\" >>calls");
  stand_in("javac", "");
  write_file(folder_ / "CMakePresets.json", "");
  const auto calls = [&](const std::string& javac) {
    fs::create_directories(folder_ / "build/release");
    write_file(folder_ / "build/release/build.ninja", "");
    write_file(folder_ / "build/release/CMakeCache.txt",
               "CMAKE_HOME_DIRECTORY:INTERNAL=" + fs::canonical(folder_.path()).string() +
                   "\nJAVAC:FILEPATH=" + javac + "\n");
    write_file(folder_ / "calls", "");
    EXPECT_EQ(run("bash scripts/build.sh release throng").exit_code, 0);
    return read_file(folder_ / "calls");
  };
  EXPECT_THAT(calls("JAVAC-NOTFOUND"), testing::StartsWith("build/release\n--build"));
  EXPECT_THAT(calls("/usr/bin/javac"), testing::StartsWith("--build"));
}

}  // namespace
}  // namespace throng::scripts_test
