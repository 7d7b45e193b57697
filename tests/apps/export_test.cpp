// `throng export` from outside; what it writes is read by others' reader in tests/viewer.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/apps/cli.h"

namespace throng {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr const char* kRun =
    "throng run bottleneck --avatars 40 --seconds 1 --lcm off --log a.lcmlog > run.txt; ";

TEST(Export, WritesTablesOfChannels) {
  const ScratchFolder folder;
  const Outcome outcome = shell(std::string(kRun) +
                                    "throng check a.lcmlog; for c in events touching counters; do "
                                    "throng export a.lcmlog --csv $c --out $c.csv; done; "
                                    "throng export a.lcmlog --csv THRONG_STATES | wc -l",
                                folder);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, testing::EndsWith("\n2401\n")) << "40 people, 60 frames and the names";
  EXPECT_EQ(line_count(read_file(folder / "counters.csv")), 61);
  const std::string events = read_file(folder / "events.csv");
  const int begins = std::stoi(outcome.out.substr(outcome.out.find("events") + 6));
  EXPECT_EQ(line_count(events), 1 + 2 * begins);
  EXPECT_THAT(events, StartsWith("frame,time_s,kind,a,b,"));
}

TEST(Export, ExportsATornLogAsFarAsItIsSound) {
  const ScratchFolder folder;
  const Outcome outcome =
      shell(std::string(kRun) +
                "head -c -3000 a.lcmlog > torn.lcmlog; throng export torn.lcmlog --mcap t.mcap",
            folder);
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("what is before is exported"));
  EXPECT_THAT(read_file(folder / "t.mcap"), testing::EndsWith("\x89MCAP0\r\n"));
}

TEST(Export, SaysWhatItDoesNotUnderstand) {
  const ScratchFolder folder;
  const std::pair<const char*, const char*> cases[] = {
      {"throng export a.lcmlog", "expected --mcap FILE or --csv CHANNEL, found neither"},
      {"throng export a.lcmlog --csv evnts",
       "expected a channel: events, states, touching, near, contacts, separation or counters"},
      {"throng export run.txt --mcap t.mcap", "run.txt: expected a log of a run"},
      {"throng export none --mcap t.mcap", "none: expected a log of a run"},
      {"throng export a.lcmlog --mcap a.lcmlog", "a.lcmlog"},
      {"throng export a.lcmlog --mcap t.mcap --out t.csv",
       "--out: expected --csv CHANNEL beside it"},
  };
  shell(kRun, folder);
  for (const auto& [line, expected] : cases) {
    const Outcome outcome = shell(line, folder);
    EXPECT_EQ(outcome.exit_code, 2) << line;
    EXPECT_THAT(outcome.err, HasSubstr(expected)) << line;
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "t.mcap"));
}

}  // namespace
}  // namespace throng
