// The example custom_bodies prints its documented output.
#include <gtest/gtest.h>
#include <stdio.h>

#include <cstdlib>
#include <string>

namespace throng::custom_bodies_test {
namespace {

TEST(CustomBodies, PrintsWhichPartsTouch) {
  const char* installed = std::getenv("THRONG_TESTED");  // as in tests/apps/cli.cpp
  const std::string folder = installed == nullptr ? THRONG_BINARY_DIR : installed;
  FILE* const pipe = ::popen(("'" + folder + "/custom_bodies'").c_str(), "r");
  ASSERT_NE(pipe, nullptr);
  std::string printed;
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) printed += static_cast<char>(c);
  EXPECT_EQ(::pclose(pipe), 0);
  EXPECT_EQ(printed,
            "frame 30: part 1 of 0 touches part 0 of 1\n"
            "frame 38: part 1 of 0 leaves part 0 of 1\n");
}

}  // namespace
}  // namespace throng::custom_bodies_test
