// Logs of the Throng before THRONG_CHECKS (8 rovers, 3 s; the second with --deadline-tests 3):
// read, judged and checked by the hash of their time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lcm_io/codec/guard.h"
#include "lcm_io/log/log_check.h"
#include "lcm_io/log/log_reader.h"
#include "synthetic_run.h"

namespace throng {
namespace {

using testing::HasSubstr;

std::filesystem::path fixture(const char* name) {
  return std::filesystem::path(THRONG_SOURCE_DIR) / "tests/lcm_io/fixtures" / name;
}

TEST(OldLog, IsSoundAndItsHashIsRight) {
  for (const char* name : {"old_log.lcmlog", "old_log_deadline.lcmlog"}) {
    const LogReport report = check_log(fixture(name));
    EXPECT_THAT(report.problems, testing::IsEmpty()) << name;
    EXPECT_TRUE(report.finished && report.hash_agrees) << name;
    EXPECT_FALSE(report.has_checks) << name;
    EXPECT_EQ(report.last_frame, 29) << name;
    EXPECT_THAT(describe_coverage(report), testing::ElementsAre(HasSubstr("an older Throng")));
  }
  EXPECT_EQ(check_log(fixture("old_log.lcmlog")).begins, 67);
  const LogReport hurried = check_log(fixture("old_log_deadline.lcmlog"));
  EXPECT_EQ(hurried.begins, 20);
  EXPECT_GT(hurried.begins_by_level[0], 0) << "the hash of its time held the levels";
}

/// The log with a bit turned over in the last event of its first THRONG_EVENTS message, in one of
/// the four columns of bytes behind the bodies: part a, part b, kind, level.
std::vector<uint8_t> with_other_event(const char* name, size_t column) {
  auto bytes = bytes_of(fixture(name));
  LogReader log(fixture(name));
  for (LogEvent event; log.next(event) == LogReader::Status::kEvent;) {
    if (event.channel != "THRONG_EVENTS") continue;
    const size_t count = get_big_endian<uint32_t>(event.data.data() + kMessageHeaderBytes);
    bytes[event.offset + event.bytes - (3 - column) * count - 1] ^= 1;
    break;
  }
  return bytes;
}

TEST(OldLog, AWrongEventIsFound) {
  const ScratchFile file;
  // An event that could be: nothing but the hash knows better.
  write_bytes(file.path(), with_other_event("old_log_deadline.lcmlog", 3));
  LogReport report = check_log(file.path());
  ASSERT_EQ(report.problem_count, 1) << testing::PrintToString(report.problems);
  EXPECT_THAT(report.problems[0], HasSubstr("the events in the log have another"));
  // One that ends what never began.
  write_bytes(file.path(), with_other_event("old_log.lcmlog", 2));
  report = check_log(file.path());
  EXPECT_THAT(report.problems, testing::Contains(HasSubstr("ends without a begin")));
  EXPECT_THAT(report.problems, testing::Contains(HasSubstr("the events in the log have another")));
}

TEST(OldLog, IsMendedAsBefore) {
  const ScratchFile torn, mended;
  auto bytes = bytes_of(fixture("old_log.lcmlog"));
  bytes.resize(bytes.size() - 100);
  write_bytes(torn.path(), bytes);
  EXPECT_GT(repair_log(torn.path(), mended.path()), 80);
  const LogReport report = check_log(mended.path());
  EXPECT_TRUE(report.is_sound() && !report.finished) << testing::PrintToString(report.problems);
  const auto sound = bytes_of(mended.path());
  ASSERT_LT(sound.size(), bytes.size());
  EXPECT_TRUE(std::equal(sound.begin(), sound.end(), bytes.begin()));
}

}  // namespace
}  // namespace throng
