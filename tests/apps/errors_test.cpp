// Errors are one line on stderr with a suggestion, and set the right exit code.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/apps/cli.h"

namespace throng::errors_test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

struct Mistake {
  std::string name;
  std::string line;
  std::string said;  ///< text that the message must contain
  int exit_code = 2;
};

// NOLINTNEXTLINE(readability-identifier-naming): GoogleTest's name
void PrintTo(const Mistake& mistake, std::ostream* out) { *out << mistake.line; }

class Mistakes : public testing::TestWithParam<Mistake> {};

TEST_P(Mistakes, PrintOneHelpfulLine) {
  const ScratchFolder folder;
  const Outcome outcome = shell(GetParam().line, folder);
  EXPECT_EQ(outcome.exit_code, GetParam().exit_code) << outcome.err;
  EXPECT_THAT(outcome.out, IsEmpty());
  EXPECT_EQ(line_count(outcome.err), 1) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr(GetParam().said));
}

INSTANTIATE_TEST_SUITE_P(
    CommandLine, Mistakes,
    testing::Values(
        Mistake{"Command", "throng rum plaza", "unknown command 'rum' (did you mean 'run'?)"},
        Mistake{"Option", "throng run plaza --avatar 10",
                "unknown option '--avatar' (did you mean '--avatars'?)"},
        Mistake{"OptionWithEquals", "throng run plaza --secnds=1", "(did you mean '--seconds'?)"},
        Mistake{"OptionBeforeScene", "throng run --thread 2", "(did you mean '--threads'?)"},
        Mistake{"GlobalOption", "throng --versoin", "(did you mean '--version'?)"},
        Mistake{"NoScene", "throng run", "FILE"},
        Mistake{"TwoScenes", "throng run plaza corridor", "found 'corridor'"},
        Mistake{"NoFile", "throng info", "FILE"},
        Mistake{"Volume", "throng run plaza --part-volume ordop15",
                "found 'ordop15' (did you mean 'ordop14'?)"},
        Mistake{"ContactPoints", "throng run plaza --contact-points --lcm off --log off",
                "contact points: expected exact contacts (--exact, or culling: {exact: true})"},
        Mistake{
            "ContactPointsOfAScene",
            "printf 'name: s\\ncontact_points: true\\nground: {min_m: [-3, -3], max_m: [3, 3]}\\n"
            "groups: [{name: p, count: 1, spawn: {min_m: [-1, -1], max_m: [1, 1]}, "
            "goals: [{min_m: [-1, -1], max_m: [1, 1]}]}]\\n' >s.yaml; throng run s.yaml --lcm off",
            "contact points: expected exact contacts"},
        Mistake{"ContactPointsOfAPapers",
                "throng run paper_350 --exact --contact-points --strategy two-pass --log off",
                "contact points: expected the pipeline"},
        Mistake{"Simd", "throng run plaza --simd avx", "expected one of best, scalar"},
        Mistake{"PairSearch", "throng run plaza --pair-search gird", "(did you mean 'grid'?)"},
        Mistake{"SecondsText", "throng run plaza --seconds soon", "found 'soon'"},
        Mistake{"SecondsZero", "throng run plaza --seconds 0", "found '0'"},
        Mistake{"SecondsNan", "throng run plaza --seconds nan", "found 'nan'"},
        Mistake{"ThreadsZero", "throng run plaza --threads 0", "--threads: expected"},
        Mistake{"SeedNegative", "throng run plaza --seed -1", "--seed: expected"},
        Mistake{"AvatarsFraction", "throng run plaza --avatars 1.5", "--avatars: expected"},
        Mistake{"AvatarsTooMany", "throng run plaza --avatars 99999999", "--avatars: expected"},
        Mistake{"ValueMissing", "throng run plaza --seconds", "--seconds"}),
    [](const auto& each) { return each.param.name; });

INSTANTIATE_TEST_SUITE_P(
    Input, Mistakes,
    testing::Values(
        Mistake{"SceneName", "throng run plazza --log off", "(did you mean 'plaza'?)"},
        Mistake{"SceneFile", "throng run no/such.yaml --log off", "no/such.yaml"},
        Mistake{"SceneFolder", "mkdir d.yaml; throng run d.yaml --log off", "d.yaml"},
        Mistake{"SceneKey", "echo 'grond: 1' >s.yaml; throng run s.yaml --log off",
                "(did you mean 'ground'?)"},
        Mistake{"SceneBroken", "echo 'a: [' >s.yaml; throng run s.yaml --log off", "s.yaml:"},
        Mistake{"InfoMissing", "throng info no.tri", "no.tri"},
        Mistake{"InfoMissingUrdf", "throng info no.urdf", "no.urdf"},
        Mistake{"InfoMissingLog", "throng info no.lcmlog", "no.lcmlog"},
        Mistake{"InfoExtension", "echo x >x.doc; throng info x.doc", "expected a recording"},
        Mistake{"InfoSceneName", "throng info coridor", "(did you mean 'corridor'?)"},
        Mistake{"CheckMissing", "throng check no.lcmlog", "no.lcmlog"},
        Mistake{"CheckNoLog", "echo hello >x.lcmlog; throng check x.lcmlog", "x.lcmlog"},
        Mistake{"RenderMissing", "throng render no.lcmlog --frame 1 --out x.png", "no.lcmlog"}),
    [](const auto& each) { return each.param.name; });

// A path below a regular file fails for root as well.
INSTANTIATE_TEST_SUITE_P(
    Environment, Mistakes,
    testing::Values(
        Mistake{"LogFolder", "echo >f; throng run plaza --seconds 1 --lcm off --log f/x.lcmlog",
                "f", 3},
        Mistake{"DefaultLogFolder", "echo >out; throng run plaza --seconds 1 --lcm off", "out", 3},
        Mistake{"JsonFolder",
                "echo >f; throng run plaza --seconds 1 --lcm off --log off --json f/x.json",
                "f/x.json", 3},
        Mistake{"FullStandardOutput", "throng scenes >/dev/full", "standard output", 3}),
    [](const auto& each) { return each.param.name; });

TEST(Help, IsPrintedWithExamples) {
  const ScratchFolder folder;
  for (const char* line : {"throng --help", "throng run --help", "throng info --help",
                           "throng check --help", "throng render --help"}) {
    const Outcome outcome = shell(line, folder);
    EXPECT_EQ(outcome.exit_code, 0) << line;
    EXPECT_THAT(outcome.err, IsEmpty()) << line;
    EXPECT_THAT(outcome.out, HasSubstr("Examples:")) << line;
  }
}

TEST(Help, ReportsAMissingCommand) {
  const ScratchFolder folder;
  const Outcome outcome = shell("throng", folder);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.out, IsEmpty());
  EXPECT_THAT(outcome.err, HasSubstr("run"));
}

TEST(Errors, EndARunWithItsResultsOnAFullDisk) {
  const ScratchFolder folder;
  const Outcome outcome =
      shell("throng run plaza --seconds 3 --lcm off --log /dev/full --json r.json", folder);
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.err, HasSubstr("/dev/full"));
  EXPECT_THAT(outcome.out, HasSubstr("ordop26")) << "the table of the results is lost";
  EXPECT_THAT(read_file(folder / "r.json"), HasSubstr("\"hash\""));
}

}  // namespace
}  // namespace throng::errors_test
