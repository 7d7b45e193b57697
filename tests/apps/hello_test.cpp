// The smallest program on the library runs, and the README contains it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/apps/cli.h"

namespace throng::hello_test {
namespace {

const std::string kTop = THRONG_SOURCE_DIR "/";

TEST(Hello, PrintsContacts) {
  const ScratchFolder folder;
  const Outcome outcome = shell("hello", folder);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, testing::HasSubstr(" touches part "));
}

TEST(Hello, EqualsTheProgramInTheReadme) {
  EXPECT_THAT(read_file(kTop + "README.md"),
              testing::HasSubstr("```cpp\n" + read_file(kTop + "examples/hello.cpp") + "```\n"));
}

TEST(Hello, IsShort) { EXPECT_LE(line_count(read_file(kTop + "examples/hello.cpp")), 18); }

}  // namespace
}  // namespace throng::hello_test
