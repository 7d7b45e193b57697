// `throng export`; a foreign MCAP reader checks its output in tests/viewer.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "tests/apps/cli.h"
#include "tests/apps/workplace.h"

namespace throng::export_test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr const char* kRun =
    "throng run bottleneck --avatars 40 --seconds 1 --lcm off --log a.lcmlog > run.txt; ";

/// An event of an LCM log: 28 bytes of header, then the channel, then the data.
struct LogPiece {
  size_t begin = 0, end = 0;  ///< bytes
};

std::vector<LogPiece> pieces_of_channel(const std::string& log, const std::string& channel) {
  constexpr size_t kHeadBytes = 28;
  const auto number_at = [&log](size_t at) {
    size_t value = 0;
    for (size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(log[at + i]);
    return value;
  };
  std::vector<LogPiece> pieces;
  for (size_t at = 0; at + kHeadBytes <= log.size();) {
    const size_t channel_bytes = number_at(at + 20);
    const size_t end = at + kHeadBytes + channel_bytes + number_at(at + 24);
    if (log.substr(at + kHeadBytes, channel_bytes) == channel) pieces.push_back({at, end});
    at = end;
  }
  return pieces;
}

TEST(Export, WritesTablesOfChannels) {
  const ScratchFolder folder;
  const Outcome outcome =
      shell(std::string(kRun) +
                "throng check a.lcmlog; for c in events touching frame_stats; do "
                "throng export a.lcmlog --csv $c --out $c.csv; done; "
                "throng export a.lcmlog --csv THRONG_STATES | wc -l",
            folder);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, testing::EndsWith("\n2401\n")) << "40 people, 60 frames and the names";
  EXPECT_EQ(line_count(read_file(folder / "frame_stats.csv")), 61);
  const std::string events = read_file(folder / "events.csv");
  const int begins = std::stoi(outcome.out.substr(outcome.out.find("events") + 6));
  EXPECT_EQ(line_count(events), 1 + 2 * begins);
  EXPECT_THAT(events, StartsWith("frame,time_s,kind,body_a,body_b,"));
}

TEST(Export, ExportsTheSoundPartOfATornLog) {
  const ScratchFolder folder;
  const Outcome outcome =
      shell(std::string(kRun) +
                "head -c -3000 a.lcmlog > torn.lcmlog; throng export torn.lcmlog --mcap t.mcap",
            folder);
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("The recorded part is exported."));
  EXPECT_THAT(read_file(folder / "t.mcap"), testing::EndsWith("\x89MCAP0\r\n"));
}

TEST(Export, RejectsALogWithoutADescriptionBeforeWriting) {
  Workplace place;
  write_file(place / "h.lcmlog", read_file(place / "a.lcmlog").substr(0, 1000));
  write_file(place / "keep.mcap", "precious\n");
  write_file(place / "keep.csv", "precious\n");
  for (const char* line :
       {"throng export h.lcmlog --mcap keep.mcap", "throng export h.lcmlog --mcap new.mcap",
        "throng export h.lcmlog --csv events --out keep.csv",
        "throng export h.lcmlog --csv frame_stats --out new.csv",
        "throng export h.lcmlog --csv states"})
    expect_rejected(place, line, "h.lcmlog: expected a run's description, found none");
}

TEST(Export, RejectsALogOfSeveralRunsBeforeWriting) {
  Workplace place;
  const Outcome other = shell(
      "throng run corridor --avatars 3 --seconds 0.1 --seed 7 --lcm off --log b.lcmlog && "
      "cat a.lcmlog b.lcmlog > both.lcmlog",
      place.folder());
  ASSERT_EQ(other.exit_code, 0) << other.err;
  write_file(place / "keep.mcap", "precious\n");
  expect_rejected(place, "throng export both.lcmlog --mcap keep.mcap",
                  "both.lcmlog: expected one run, found several");
}

TEST(Export, ReportsDamageAndContinuesBehindIt) {
  const ScratchFolder folder;
  ASSERT_EQ(shell(kRun, folder).exit_code, 0);
  const std::string whole = read_file(folder / "a.lcmlog");
  const std::vector<LogPiece> stats = pieces_of_channel(whole, "THRONG_FRAME_STATS");
  ASSERT_EQ(stats.size(), 60u);
  const LogPiece middle = stats[30];
  std::string lacking = whole, unreadable = whole, altered = whole;
  lacking.erase(middle.begin, middle.end - middle.begin);
  unreadable[middle.begin] = 'X';
  altered[middle.end - 1] = static_cast<char>(altered[middle.end - 1] ^ 1);
  write_file(folder / "lacking.lcmlog", lacking);
  write_file(folder / "unreadable.lcmlog", unreadable);
  write_file(folder / "altered.lcmlog", altered);
  struct Case {
    const char* log;
    const char* said;
    int rows;
  };
  for (const Case& each : {Case{"lacking.lcmlog", "The log lacks 1 message of its run.", 59},
                           Case{"unreadable.lcmlog", "The log is damaged: ", 59},
                           Case{"altered.lcmlog", "1 stretch of messages is altered", 60}}) {
    const std::string log = each.log;
    EXPECT_EQ(shell("throng check " + log, folder).exit_code, 1) << log;
    for (const char* options : {"--csv frame_stats --out t.csv", "--mcap t.mcap"}) {
      const Outcome outcome = shell("throng export " + log + " " + options, folder);
      EXPECT_EQ(outcome.exit_code, 1) << log << " " << options;
      EXPECT_EQ(line_count(outcome.err), 1) << outcome.err;
      EXPECT_THAT(outcome.err, StartsWith("note: " + log + ": ")) << options;
      EXPECT_THAT(outcome.err, HasSubstr(each.said)) << options;
      EXPECT_THAT(outcome.err, testing::EndsWith(" The recorded part is exported.\n")) << options;
    }
    EXPECT_EQ(line_count(read_file(folder / "t.csv")), 1 + each.rows) << log;
    EXPECT_THAT(read_file(folder / "t.mcap"), testing::EndsWith("\x89MCAP0\r\n")) << log;
  }
  const Outcome fine = shell("throng export a.lcmlog --csv frame_stats --out t.csv", folder);
  EXPECT_EQ(fine.exit_code, 0);
  EXPECT_EQ(fine.err, "");
}

TEST(Export, CallsALogCutOffAsCheckDoes) {
  const ScratchFolder folder;
  ASSERT_EQ(shell(kRun, folder).exit_code, 0);
  const std::string whole = read_file(folder / "a.lcmlog");
  struct Cut {
    size_t bytes;
    const char* where;
  };
  for (const Cut& cut :
       {Cut{pieces_of_channel(whole, "THRONG_STATES").at(0).begin, "before its first frame"},
        Cut{pieces_of_channel(whole, "THRONG_FRAME_STATS").at(30).end, "after frame 30 (0.50 s)"},
        Cut{pieces_of_channel(whole, "THRONG_CHECKSUMS").at(59).end, "after frame 59 (0.98 s)"},
        Cut{pieces_of_channel(whole, "THRONG_END").at(0).begin, "after frame 59 (0.98 s)"}}) {
    write_file(folder / "cut.lcmlog", whole.substr(0, cut.bytes));
    const std::string sentence = std::string("The log is cut off: it ends ") + cut.where +
                                 " without the end of its run, and what came later is missing.";
    const Outcome check = shell("throng check cut.lcmlog", folder);
    EXPECT_EQ(check.exit_code, 1) << check.out;
    EXPECT_THAT(check.out, StartsWith("cut.lcmlog: sound, but cut off\n"));
    EXPECT_THAT(check.out, HasSubstr("  end        " + sentence + "\n"));
    const Outcome exported = shell("throng export cut.lcmlog --csv frame_stats", folder);
    EXPECT_EQ(exported.exit_code, 1);
    EXPECT_THAT(exported.err, HasSubstr(sentence));
  }
  // The end of the run is present, the checksums after it are missing.
  write_file(folder / "cut.lcmlog",
             whole.substr(0, pieces_of_channel(whole, "THRONG_END").at(0).end));
  const Outcome check = shell("throng check cut.lcmlog", folder);
  EXPECT_EQ(check.exit_code, 1);
  EXPECT_THAT(check.out, HasSubstr("not covered: "));
}

TEST(Export, RejectsInvalidOptions) {
  const ScratchFolder folder;
  const std::pair<const char*, const char*> cases[] = {
      {"throng export a.lcmlog", "expected --mcap FILE or --csv CHANNEL, found neither"},
      {"throng export a.lcmlog --csv evnts",
       "expected a channel: events, states, touching, proximity, contact_points, separation, "
       "changes or "
       "frame_stats"},
      {"throng export run.txt --mcap t.mcap", "run.txt: expected a log of a run"},
      {"throng export none --mcap t.mcap", "none: expected a log of a run"},
      {"throng export a.lcmlog --mcap a.lcmlog", "a.lcmlog"},
      {"throng export a.lcmlog --mcap t.mcap --out t.csv", "--out: expected --csv CHANNEL with it"},
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
}  // namespace throng::export_test
