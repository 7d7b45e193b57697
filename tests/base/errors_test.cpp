// Errors state place, expectation and finding, and suggest a name.
#include "base/errors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace throng::errors_test {
namespace {

using testing::IsEmpty;
using testing::StrEq;

const std::vector<std::string> kNames = {"plaza", "corridor", "station"};

TEST(InputError, ReadsAsOneLine) {
  const InputError error(at_line("head.tri", 17), "3 vertex indices", "2");
  EXPECT_THAT(error.what(), StrEq("head.tri:17: expected 3 vertex indices, found 2"));
}

TEST(InputError, KeepsItsPlace) {
  EXPECT_EQ(InputError(at_line("head.tri", 17), "3 vertex indices", "2").where(), "head.tri:17");
  EXPECT_EQ(InputError("--seed", "a number", "'x'").where(), "--seed");
}

TEST(InputError, StaysOnOneLineForAnyInput) {
  const InputError error("a.yaml:2", "a number", "'1\n2\x1b[2J'");
  EXPECT_THAT(error.what(), StrEq("a.yaml:2: expected a number, found '1 2 [2J'"));
}

TEST(DidYouMean, CorrectsTypingErrors) {
  EXPECT_EQ(did_you_mean("plazza", kNames), " (did you mean 'plaza'?)");
  EXPECT_EQ(did_you_mean("coridor", kNames), " (did you mean 'corridor'?)");
  EXPECT_EQ(did_you_mean("sttaion", kNames), " (did you mean 'station'?)");
}

TEST(DidYouMean, IgnoresDifferentWords) {
  EXPECT_THAT(did_you_mean("airport", kNames), IsEmpty());
  EXPECT_THAT(did_you_mean("", kNames), IsEmpty());
  EXPECT_THAT(did_you_mean("plaza", {}), IsEmpty());
}

TEST(DidYouMean, PrefersTheNearestThenTheFirst) {
  EXPECT_EQ(did_you_mean("ordop15", std::vector<std::string>{"kdop14", "ordop14", "ordop18"}),
            " (did you mean 'ordop14'?)");
}

TEST(DidYouMean, KnowsWordsOfOtherTools) {
  const std::vector<std::string> scene = {"premovement_s", "proximity_m", "yaw_deg"};
  EXPECT_EQ(did_you_mean("near", scene), " (did you mean 'proximity_m'?)");
  EXPECT_EQ(did_you_mean("delay_s", scene), " (did you mean 'premovement_s'?)");
  EXPECT_THAT(did_you_mean("companions", scene), IsEmpty()) << "social_groups is no candidate";
  EXPECT_EQ(did_you_mean("--parts", std::vector<std::string>{"--filter-parts", "--part-pairs"}),
            " (did you mean '--filter-parts'?)");
}

}  // namespace
}  // namespace throng::errors_test
