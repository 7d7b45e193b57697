// Tests the distances of one body for the page: from a log in pieces, and from a live run.
#include "viewer/server/proximity_message.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>

#include "lcm_io/codec/encoder.h"
#include "tests/lcm_io/synthetic_run.h"
#include "viewer/server/log_view.h"

namespace throng::proximity_message_test {
namespace {

using namespace std::chrono_literals;

constexpr int kFrames = 60;
constexpr SyntheticRun::Options kOptions{.avatars = 12, .seed = 5, .pairs = 60, .proximity = true};

struct Message {
  ProximityHead head;
  std::vector<ProximityRecord> records;
  std::vector<double> points;
};

Message decoded(const Bytes& bytes) {
  Message message;
  std::memcpy(&message.head, bytes.data(), sizeof message.head);
  EXPECT_EQ(message.head.kind, kProximityMessage);
  size_t at = sizeof message.head;
  size_t points = 0;
  message.records.resize(message.head.count);
  for (ProximityRecord& record : message.records) {
    std::memcpy(&record, bytes.data() + at, sizeof record);
    at += sizeof record;
    points += 6 * record.has_points;
  }
  at = (at + 7) / 8 * 8;
  EXPECT_EQ(bytes.size(), at + points * sizeof(double));
  message.points.resize(points);
  if (points > 0) std::memcpy(message.points.data(), bytes.data() + at, points * sizeof(double));
  return message;
}

/// Returns the rows of a body in a frame: the least bounds for each other body.
std::map<uint32_t, std::pair<float, float>> nearest_of(uint32_t body, const Frame& frame) {
  std::map<uint32_t, std::pair<float, float>> nearest;
  for (const ProximityRows& rows : {frame.proximity_pairs, frame.closest_parts})
    for (const ProximityPair& row : rows) {
      if (row.pair.a() != body && row.pair.b() != body) continue;
      const uint32_t other = row.pair.a() == body ? row.pair.b() : row.pair.a();
      const auto [at, is_new] = nearest.try_emplace(other, row.lo_m, row.hi_m);
      if (!is_new) at->second = std::min(at->second, std::pair(row.lo_m, row.hi_m));
    }
  return nearest;
}

void expect_equal(const std::map<uint32_t, std::pair<float, float>>& expected,
                  std::span<const ProximityRecord> records, int64_t frame) {
  ASSERT_EQ(records.size(), expected.size()) << "frame " << frame;
  auto row = expected.begin();
  for (const ProximityRecord& record : records) {
    EXPECT_EQ(record.frame, frame);
    EXPECT_EQ(record.other, row->first);
    EXPECT_EQ(record.lo_m, row->second.first);
    EXPECT_EQ(record.hi_m, row->second.second);
    ++row;
  }
}

class RecordedProximity : public testing::Test {
 protected:
  RecordedProximity() {
    SyntheticRun run(kOptions);
    LogSink sink(log_.path());
    run.play(sink, kFrames);
  }
  ScratchFile log_;
};

TEST_F(RecordedProximity, ListsTheNearestPartsOfEachOtherBody) {
  LogIndex index(log_.path());
  index.wait();
  LogSampler sampler(index);
  for (const uint32_t body : {0u, 7u}) {
    const Message message = decoded(sampler.proximity(body, 0, 1h));
    EXPECT_EQ(message.head.from, 0);
    EXPECT_EQ(message.head.to, kFrames);
    EXPECT_EQ(message.head.body, body);
    EXPECT_EQ(message.head.is_recorded, 1u);
    ASSERT_GT(message.records.size(), 100u);
    ASSERT_FALSE(message.points.empty());
    SyntheticRun again(kOptions);
    size_t at = 0;
    for (int64_t frame = 0; frame < kFrames; ++frame) {
      const size_t first = at;
      while (at < message.records.size() && message.records[at].frame == frame) ++at;
      expect_equal(nearest_of(body, again.step()),
                   std::span(message.records).subspan(first, at - first), frame);
    }
    EXPECT_EQ(at, message.records.size());
  }
}

TEST_F(RecordedProximity, ArrivesInPiecesThatContinueEachOther) {
  LogIndex index(log_.path());
  index.wait();
  LogSampler whole(index), pieces(index);
  const Message expected = decoded(whole.proximity(3, 0, 1h));
  std::vector<ProximityRecord> records;
  std::vector<double> points;
  int answers = 0;
  for (int64_t from = 0; from < kFrames; ++answers) {
    const Message piece = decoded(pieces.proximity(3, from, 0ms));  // one frame per answer
    ASSERT_EQ(piece.head.from, static_cast<double>(from));
    ASSERT_GT(piece.head.to, piece.head.from);
    records.insert(records.end(), piece.records.begin(), piece.records.end());
    points.insert(points.end(), piece.points.begin(), piece.points.end());
    from = static_cast<int64_t>(piece.head.to);
  }
  EXPECT_EQ(answers, kFrames);
  ASSERT_EQ(records.size(), expected.records.size());
  EXPECT_EQ(std::memcmp(records.data(), expected.records.data(),
                        records.size() * sizeof(ProximityRecord)),
            0);
  EXPECT_EQ(points, expected.points);
}

TEST_F(RecordedProximity, EndsWithTheKnownLog) {
  LogIndex index(log_.path());
  index.wait();
  LogSampler sampler(index);
  const Message message = decoded(sampler.proximity(3, 10 * kFrames, 1h));
  EXPECT_TRUE(message.records.empty());
  EXPECT_EQ(message.head.to, 10 * kFrames);
  EXPECT_TRUE(decoded(sampler.proximity(4'000'000, 0, 1h)).records.empty());
}

TEST(ProximityMessage, StatesThatARunHasNoProximityRows) {
  const ScratchFile log;
  SyntheticRun run({.avatars = 12});
  LogSink sink(log.path());
  run.play(sink, 20);
  LogIndex index(log.path());
  index.wait();
  const Message message = decoded(LogSampler(index).proximity(3, 0, 1h));
  EXPECT_EQ(message.head.is_recorded, 0u);
  EXPECT_EQ(message.head.to, 20);
}

TEST(ProximityMessage, GivesThePointOfTheBodyFirst) {
  ProximityPair row;
  row.pair = PairKey(2, 5, 7, 8);
  row.point_a_m = {1, 2, 3};
  row.point_b_m = {4, 5, 6};
  for (const uint32_t body : {2u, 5u}) {
    ProximityMessage message(body, 0);
    message.add(0, std::span(&row, 1));
    const Message read = decoded(message.finish(1, true));
    ASSERT_EQ(read.records.size(), 1u);
    EXPECT_EQ(read.records[0].other, body == 2 ? 5u : 2u);
    EXPECT_EQ(read.records[0].part, body == 2 ? 7 : 8);
    EXPECT_EQ(read.points.front(), body == 2 ? 1 : 4);
  }
  row.point_a_m[1] = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(has_points(row));
}

TEST(ProximityHistory, KeepsTheNewestFramesOfALiveRun) {
  MessageList list;
  RunEncoder encoder({}, list);
  SyntheticRun run(kOptions);
  encoder.begin(run.info());
  RunReader reader;
  ProximityHistory all, some(300);
  size_t read = 0;
  for (int frame = 0; frame < kFrames; ++frame) {
    encoder.frame(run.info(), run.step());
    for (; read < list.messages.size(); ++read) {
      const auto& message = list.messages[read];
      if (reader.take(name_of(message.channel), message.bytes) != RunReader::Update::kProximity)
        continue;
      all.add(reader);
      some.add(reader);
    }
  }
  const Message whole = decoded(all.of(3, 0));
  EXPECT_EQ(whole.head.to, kFrames);
  EXPECT_EQ(whole.records.front().frame, 0);
  const Message late = decoded(all.of(3, 50));
  EXPECT_EQ(late.head.from, 50);
  EXPECT_EQ(late.records.front().frame, 50);
  EXPECT_GT(decoded(some.of(3, 0)).records.front().frame, 30);
  EXPECT_EQ(decoded(some.of(3, 0)).head.to, kFrames);
  all.clear();
  EXPECT_EQ(decoded(all.of(3, 0)).head.is_recorded, 0u);
}

}  // namespace
}  // namespace throng::proximity_message_test
