// Tallies are exact for any order of arrival.
#include "lcm_io/codec/tally.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "base/random.h"

namespace throng::tally_test {
namespace {

MessageHeader numbered(int64_t seq, int64_t frame = 5) {
  MessageHeader header;
  header.seq = seq;
  header.frame = frame;
  header.chunk_count = 1;
  return header;
}

TEST(Tally, IsExactForAnyOrderOfArrival) {
  constexpr uint64_t kSeed = 9;
  for (uint64_t round = 0; round < 300; ++round) {
    SCOPED_TRACE(testing::Message() << "seed " << kSeed << " round " << round);
    const auto random = [&](uint32_t k, uint64_t below) {
      return static_cast<int64_t>(random_bits({kSeed, round, k, Purpose::kStyle}, 0) % below);
    };
    const int64_t first = random(0, 4), sent = first + 1 + random(1, 200);
    std::vector<int64_t> arrivals;
    for (int64_t seq = first; seq < sent; ++seq)
      for (int64_t copies = random(static_cast<uint32_t>(10 + seq), 4); copies > 1; --copies)
        arrivals.push_back(seq);  // zero, one or two copies
    // Each is moved by up to 8 places.
    for (size_t i = 0; i < arrivals.size(); ++i)
      std::swap(
          arrivals[i],
          arrivals[std::min(arrivals.size() - 1,
                            i + static_cast<size_t>(random(static_cast<uint32_t>(500 + i), 8)))]);
    ChannelTally tally;
    std::set<int64_t> received;
    for (const int64_t seq : arrivals) {
      tally.count(numbered(seq), 10);
      received.insert(seq);
      const auto count = static_cast<int64_t>(received.size());
      ASSERT_EQ(tally.messages, count);
      ASSERT_EQ(tally.bytes, 10 * count);
      ASSERT_EQ(tally.before, *received.begin());
      ASSERT_EQ(tally.missing, *received.rbegin() + 1 - *received.begin() - count);
      ASSERT_EQ(tally.next_seq, *received.rbegin() + 1);
    }
    EXPECT_EQ(tally.messages + tally.repeated, static_cast<int64_t>(arrivals.size()));
    tally.close(sent);
    EXPECT_EQ(tally.messages + tally.missing + tally.before, sent);
    tally.count_from_start();
    EXPECT_EQ(tally.missing, sent - static_cast<int64_t>(received.size()))
        << "all count as missing";
  }
}

TEST(Tally, CountsALateMessageAsReceived) {
  ChannelTally tally;
  for (const int64_t seq : {0, 1, 5}) tally.count(numbered(seq), 1);
  EXPECT_EQ(tally.missing, 3);
  tally.count(numbered(3), 1);
  EXPECT_EQ(tally.missing, 2);
  EXPECT_EQ(tally.late, 1);
  tally.count(numbered(3), 1);
  EXPECT_EQ(tally.missing, 2);
  EXPECT_EQ(tally.repeated, 1);
}

TEST(Tally, CountsAllMissingMessagesAfterACompleteStart) {
  RunTally run;
  run.count(Channel::kStates, numbered(7, 2), 1);
  EXPECT_EQ(run[Channel::kStates].before, 7);
  EXPECT_EQ(run[Channel::kStates].missing, 0);
  run.count(Channel::kFrameStats, numbered(0, 0), 1);  // frame 0, which arrives late
  EXPECT_EQ(run[Channel::kStates].before, 0);
  EXPECT_EQ(run[Channel::kStates].missing, 7);
  run.count(Channel::kEvents, numbered(2, 2), 1);
  EXPECT_EQ(run[Channel::kEvents].missing, 2);
}

TEST(Tally, KeepsOldGapsAsMissing) {
  ChannelTally tally;
  for (int64_t seq = 0; seq < 20'000; seq += 2) tally.count(numbered(seq), 1);
  EXPECT_EQ(tally.missing, 9'999);
  tally.count(numbered(19'001), 1);
  EXPECT_EQ(tally.missing, 9'998);
  tally.count(numbered(1), 1);
  EXPECT_EQ(tally.missing, 9'998) << "gaps too old to be filled";
}

}  // namespace
}  // namespace throng::tally_test
