// Damaged logs: every cut and every flipped byte gets a report; none crashes the check.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "base/errors.h"
#include "base/random.h"
#include "lcm_io/codec/message_validation.h"
#include "lcm_io/log/log_check.h"
#include "lcm_io/log/log_reader.h"
#include "synthetic_run.h"

namespace throng::damage_test {
namespace {

/// A log without adults, small enough for a cut at every byte.
class DamagedLog : public testing::Test {
 protected:
  DamagedLog() {
    SyntheticRun run({.avatars = 2, .seed = 6, .pairs = 5, .crowd = SyntheticRun::Crowd::kRovers});
    LogSink sink(file_.path());
    run.play(sink, 4);
    bytes_ = bytes_of(file_.path());
    LogReader log(file_.path());
    LogEvent event;
    while (log.next(event) == LogReader::Status::kEvent) offsets_.push_back(event.offset);
    offsets_.push_back(bytes_.size());
  }
  LogReport report_of(std::span<const uint8_t> bytes) {
    write_bytes(damaged_.path(), bytes);
    return check_log(damaged_.path());
  }

  ScratchFile file_, damaged_;
  std::vector<uint8_t> bytes_;
  std::vector<uint64_t> offsets_;
};

TEST_F(DamagedLog, IsReportedForEveryCut) {
  ASSERT_LT(bytes_.size(), 20'000u);
  for (size_t size = 4; size < bytes_.size(); ++size) {
    const LogReport report = report_of(std::span(bytes_).first(size));
    const auto next = std::upper_bound(offsets_.begin(), offsets_.end(), size);
    const auto whole = next - offsets_.begin() - 1;
    const bool is_clean_cut = offsets_[static_cast<size_t>(whole)] == size;
    ASSERT_EQ(report.log_events, whole) << "cut at byte " << size;
    ASSERT_EQ(report.torn, !is_clean_cut) << "cut at byte " << size;
    ASSERT_FALSE(report.damaged || report.finished) << "cut at byte " << size;
  }
}

TEST_F(DamagedLog, IsReportedForEveryFlippedByte) {
  int unnoticed = 0;
  for (size_t i = 0; i < bytes_.size(); ++i) {
    auto bytes = bytes_;
    bytes[i] ^= 0xff;
    try {
      unnoticed += report_of(bytes).is_sound() ? 1 : 0;
    } catch (const InputError&) {
      EXPECT_LT(i, 4u) << "only damage of the first magic number makes the file no log";
    }
  }
  EXPECT_EQ(unnoticed, 0) << "of " << bytes_.size();
}

TEST_F(DamagedLog, NeverCrashesTheCheck) {
  constexpr uint64_t kSeed = 20;
  for (uint64_t round = 0; round < 3000; ++round) {
    SCOPED_TRACE(testing::Message() << "seed " << kSeed << " round " << round);
    auto bytes = bytes_;
    const RandomKey key{kSeed, round, 0, Purpose::kStyle};
    const auto hits = 1 + random_bits(key, 0) % 8;
    for (uint32_t hit = 0; hit < hits; ++hit)
      bytes[4 + random_bits(key, 3 * hit + 1) % (bytes.size() - 4)] =
          static_cast<uint8_t>(random_bits(key, 3 * hit + 2));
    if (random_bits(key, 100) % 4 == 0)
      bytes.resize(4 + random_bits(key, 101) % (bytes.size() - 4));
    const LogReport report = report_of(bytes);
    ASSERT_LE(report.sound_bytes, bytes.size());
    ASSERT_LE(report.log_events, static_cast<int64_t>(offsets_.size()) - 1);
  }
}

TEST_F(DamagedLog, MayContainAnyLengths) {
  for (const int32_t length : {0x7fffffff, -1, INT32_MIN, kMaxDataBytes + 1}) {
    for (const size_t field : {size_t{20}, size_t{24}}) {
      auto bytes = bytes_;
      put_big_endian(bytes.data() + offsets_[1] + field, length);
      const LogReport report = report_of(bytes);
      EXPECT_TRUE(report.damaged) << "length " << length;
      EXPECT_EQ(report.log_events, static_cast<int64_t>(offsets_.size()) - 2)
          << "all but the damaged one";
    }
  }
}

TEST_F(DamagedLog, IsReadAfterALostMagicNumber) {
  auto bytes = bytes_;
  bytes[offsets_[3]] = 0;
  const LogReport report = report_of(bytes);
  EXPECT_TRUE(report.damaged);
  EXPECT_FALSE(report.torn);
  EXPECT_EQ(report.log_events, static_cast<int64_t>(offsets_.size()) - 2);
  EXPECT_THAT(report.problems.front(), testing::HasSubstr("byte " + std::to_string(offsets_[3])));
  int64_t missing = 0;
  for (const auto& channel : report.channels) missing += channel.missing;
  EXPECT_EQ(missing, 1);
}

TEST_F(DamagedLog, NamesMessagesOfAnotherRun) {
  for (size_t i = 1; i + 1 < offsets_.size(); ++i) {
    auto bytes = bytes_;
    const uint64_t channel_bytes = get_big_endian<uint32_t>(bytes.data() + offsets_[i] + 20);
    bytes[offsets_[i] + kLogHeadBytes + channel_bytes + 16] ^= 1;  // the first byte of run_id
    const LogReport report = report_of(bytes);
    const std::string_view channel(
        reinterpret_cast<const char*>(bytes.data()) + offsets_[i] + kLogHeadBytes, channel_bytes);
    const char* words =
        channel == "THRONG_CHECKSUMS" ? "checksums that are damaged themselves" : "of another run";
    EXPECT_THAT(report.problems, testing::Contains(testing::HasSubstr(words))) << "event " << i;
  }
}

TEST_F(DamagedLog, IsRepairedToItsSoundPart) {
  const ScratchFile repaired;
  const size_t size = offsets_[offsets_.size() - 3] + 17;
  report_of(std::span(bytes_).first(size));
  EXPECT_EQ(repair_log(damaged_.path(), repaired.path()),
            static_cast<int64_t>(offsets_.size()) - 3);
  const auto sound = bytes_of(repaired.path());
  EXPECT_EQ(sound.size(), offsets_[offsets_.size() - 3]);
  EXPECT_TRUE(std::equal(sound.begin(), sound.end(), bytes_.begin()));
  EXPECT_TRUE(check_log(repaired.path()).is_sound());
}

TEST_F(DamagedLog, IsUnchangedByRepairIfSound) {
  const ScratchFile repaired;
  repair_log(file_.path(), repaired.path());
  EXPECT_EQ(bytes_of(repaired.path()), bytes_);
}

TEST_F(DamagedLog, IsNotRepairedInPlace) {
  EXPECT_THROW(repair_log(file_.path(), file_.path()), EnvironmentError);
  EXPECT_EQ(bytes_of(file_.path()), bytes_);
}

TEST_F(DamagedLog, NamesUnpairedEvents) {
  // The same THRONG_EVENTS message twice, renumbered so that only the pairing is wrong.
  LogReader log(file_.path());
  LogFile out(damaged_.path());
  LogEvent event;
  bool is_first = true;
  while (log.next(event) == LogReader::Status::kEvent) {
    out.write(event.channel, event.stamp_us, event.data);
    if (event.channel != "THRONG_EVENTS" || !is_first) continue;
    is_first = false;
    std::vector<uint8_t> again(event.data.begin(), event.data.end());
    put_big_endian(again.data() + size_t{5} * 8,  // after the fingerprint and four numbers
                   int64_t{1});
    out.write(event.channel, event.stamp_us, again);
  }
  out.close();
  const LogReport report = check_log(damaged_.path());
  EXPECT_THAT(report.problems, testing::Contains(testing::HasSubstr("begins twice")));
  EXPECT_FALSE(report.finished);
}

}  // namespace
}  // namespace throng::damage_test
