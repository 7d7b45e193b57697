// `throng info` on recordings: facts, and the options that a file needs.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/apps/cli.h"

namespace throng::info_recording_test {
namespace {

using testing::HasSubstr;

/// Ten people in a row, a metre apart, that walk side by side at 1.25 m/s for eight seconds.
std::string row_of_ten() {
  std::string out;
  for (int id = 1; id <= 10; ++id)
    for (int frame = 100; frame < 228; ++frame)
      out += fmt::format("{} {} {} {} {}\n", id, frame, 100 * 1.25 * (frame - 100) / 16, 100 * id,
                         160 + 2 * id);
  return out;
}

TEST(InfoRecording, PrintsTheFacts) {
  const ScratchFolder folder;
  write_file(folder / "row.txt", row_of_ten());
  const Outcome outcome = shell("throng info row.txt --fps 16 --unit cm", folder);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const char* words :
       {"row.txt: a recording, archive text", "heads", "10, ids 1 to 10; 10 at once",
        "7.9375 s, 128 frames at 16 per second, numbered 100 to 227", "1280, 128 per person",
        "(0.00, 1.00) to (9.92, 10.00) m", "1.72 m, 90 % from 1.62 to 1.80; 10 of 10 people",
        "1.25 m/s over a second, 90 % from 1.25 to 1.25", "per m2 within 1 m", "none"})
    EXPECT_THAT(outcome.out, HasSubstr(words));
  EXPECT_LT(line_count(outcome.out), 24);
}

TEST(InfoRecording, RequestsMissingOptions) {
  const ScratchFolder folder;
  write_file(folder / "row.txt", row_of_ten());
  const struct {
    const char *options, *words;
  } cases[] = {
      {"", "row.txt: expected a frame rate and a unit of length, as in --fps 16 --unit cm, found"},
      {"--fps 16", "as in --unit cm"},
      {"--fps 0 --unit cm", "a number of frames per second above 0"},
      {"--fps 16 --unit miles", "'miles'"},
      {"--fps 16 --unit cm --heading-unit turns", "'turns'"},
      {"--fps 16 --unit cm --heading-unit deg", "--heading-unit: expected a table"},
      {"--fps 16 --unit cm --tracked-point hips", "'hips'"},
      {"--fps 16 --unit cm --separator '::'", "one character"},
      {"--fps 160000", "--fps"},
      {"--columns who=1", "--columns: expected"},
  };
  for (const auto& [options, words] : cases) {
    const Outcome outcome = shell(std::string("throng info row.txt ") + options, folder);
    EXPECT_EQ(outcome.exit_code, 2) << options;
    EXPECT_THAT(outcome.err, HasSubstr(words)) << options;
    EXPECT_EQ(line_count(outcome.err), 1) << outcome.err;
  }
  EXPECT_THAT(shell("throng info plaza --fps 25", folder).err,
              HasSubstr("--fps: expected a recording"));
}

TEST(InfoRecording, CountsMissingPositions) {
  const ScratchFolder folder;
  write_file(folder / "gaps.csv", "id,t,x [cm],y [cm]\n1,0,0,0\n1,1,,\n1,2,50,NaN\n1,3,150,0\n");
  const Outcome outcome = shell("throng info gaps.csv", folder);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("2 missing positions (gaps in tracks)\n           "
                                     "first id 1 at 1 s"));
  EXPECT_THAT(outcome.out, HasSubstr("(0.00, 0.00) to (1.50, 0.00) m"));
  const Outcome run = shell("throng run gaps.csv --lcm off --log off --json a.json", folder);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(shell("cat a.json", folder).out, HasSubstr("missing positions (gaps in"));
}

TEST(InfoRecording, RejectsAnomaliesIfStrict) {
  const ScratchFolder folder;
  write_file(folder / "jump.txt",
             "# framerate: 25\n# id frame x/m y/m\n3 1 0 0\n3 2 5 0\n3 3 5.1 0\n3 3 5.2 0\n");
  const Outcome fine = shell("throng info jump.txt", folder);
  EXPECT_EQ(fine.exit_code, 0) << fine.err;
  EXPECT_THAT(fine.out,
              HasSubstr("1 jumps of more than 3 m\n           first id 3 at frame 2: 5 m"));
  EXPECT_THAT(fine.out, HasSubstr("1 duplicate positions"));
  const Outcome strict = shell("throng info jump.txt --strict", folder);
  EXPECT_EQ(strict.exit_code, 2);
  EXPECT_THAT(strict.err, HasSubstr("first id 3 at frame 2: 5 m in 0.04 s; 1 more kinds"));
}

TEST(InfoRecording, ReadsTrajectoriesOfARun) {
  const ScratchFolder folder;
  ASSERT_EQ(shell("throng run corridor --seconds 2 --lcm off --log off --trajectory a.sqlite "
                  "--trajectory a.csv",
                  folder)
                .exit_code,
            0);
  const Outcome sqlite = shell("throng info a.sqlite --strict", folder);
  EXPECT_EQ(sqlite.exit_code, 0) << sqlite.err;
  EXPECT_THAT(sqlite.out, HasSubstr("JuPedSim SQLite 2"));
  EXPECT_THAT(sqlite.out, HasSubstr("from the file"));
  EXPECT_THAT(sqlite.out, HasSubstr("walkable area"));
  const Outcome csv = shell("gzip a.csv && throng info a.csv.gz --strict", folder);
  EXPECT_EQ(csv.exit_code, 0) << csv.err;
  EXPECT_THAT(csv.out, HasSubstr("Throng CSV"));
}

}  // namespace
}  // namespace throng::info_recording_test
