// Channels of their own: what they say is what the run says, of those who asked alone.
#include "lcm_io/wire/filtered_channels.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <lcm/lcm-cpp.hpp>
#include <set>

#include "base/errors.h"
#include "lcm_io/codec/message_validation.h"
#include "lcm_io/codec/rows.h"
#include "synthetic_run.h"

namespace throng::own_channels_test {
namespace {

/// What came on the channels of somebody.
struct Heard {
  std::vector<PairEvent> events;
  std::vector<ProximityPair> near;
  std::vector<stamp_t> stamps;
  int64_t next_seq[3] = {0, 0, 0};
};

template <class Message>
void number(Heard& heard, int of, const Message& m) {
  EXPECT_EQ(m.seq, heard.next_seq[of]++);
  EXPECT_EQ(m.schema, kSchema);
  EXPECT_LT(m.chunk, m.chunk_count);
}

/// A run that was made up, listened to on one channel.
struct Listened {
  explicit Listened(const std::string& who, SyntheticRun::Options options = {})
      : lcm(std::make_shared<lcm::LCM>("memq://")),
        sink({}, lcm),
        run(with_near(options)),
        own(run.info(), std::vector<FilteredChannel>{{who, "MINE"}}) {
    own.publish_by(sink);
    lcm->subscribeFunction(
        "MINE_EVENTS",
        +[](const lcm::ReceiveBuffer* b, const std::string&, Heard* to) {
          events_t m;
          ASSERT_EQ(decode({static_cast<const uint8_t*>(b->data), b->data_size}, m), "");
          number(*to, 0, m);
          for (size_t i = 0; i < m.a.size(); ++i)
            to->events.push_back({pair_at(m, i), static_cast<EventKind>(m.kind[i]),
                                  static_cast<PairLevel>(m.level[i])});
        },
        &heard);
    lcm->subscribeFunction(
        "MINE_NEAR",
        +[](const lcm::ReceiveBuffer* b, const std::string&, Heard* to) {
          proximity_t m;
          ASSERT_EQ(decode({static_cast<const uint8_t*>(b->data), b->data_size}, m), "");
          number(*to, 1, m);
          for (size_t i = 0; i < m.a.size(); ++i) to->near.push_back(proximity_at(m, i));
        },
        &heard);
    lcm->subscribeFunction(
        "MINE_STAMP",
        +[](const lcm::ReceiveBuffer*, const std::string&, const stamp_t* m, Heard* to) {
          number(*to, 2, *m);
          to->stamps.push_back(*m);
        },
        &heard);
  }
  static SyntheticRun::Options with_near(SyntheticRun::Options options) {
    options.near = true;
    return options;
  }
  void take_in() {
    while (lcm->handleTimeout(0) > 0) {
    }
  }

  std::shared_ptr<lcm::LCM> lcm;
  LcmSink sink;
  SyntheticRun run;
  FilteredChannels own;
  Heard heard;
};

/// The slow way: row by row, by a set of bodies.
template <class Rows>
std::vector<PairKey> of_bodies(const Rows& rows, const std::set<uint32_t>& bodies) {
  std::vector<PairKey> own;
  for (const auto& row : rows)
    if (bodies.contains(row.pair.a()) || bodies.contains(row.pair.b())) own.push_back(row.pair);
  return own;
}

/// Of the parts, then of two people.
std::vector<PairKey> near_of(const Frame& frame, const std::set<uint32_t>& bodies) {
  std::vector<PairKey> own = of_bodies(frame.proximity_pairs, bodies);
  const std::vector<PairKey> people = of_bodies(frame.closest_parts, bodies);
  own.insert(own.end(), people.begin(), people.end());
  return own;
}

std::vector<PairKey> pairs_of(const auto& rows) {
  std::vector<PairKey> pairs;
  for (const auto& row : rows) pairs.push_back(row.pair);
  return pairs;
}

TEST(FilteredChannels, SayWhatTheRunSaysOfThoseWhoAskedAlone) {
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    const SyntheticRun::Options options{.avatars = 20, .seed = seed, .pairs = 60};
    const SyntheticRun names(options);
    std::set<uint32_t> group, everybody;
    for (uint32_t i = 0; i < 20; ++i) {
      everybody.insert(i);
      if (names.info().group_of_avatar[i] == 0) group.insert(i);
    }
    for (const auto& [who, bodies] :
         {std::pair(std::string("7"), std::set<uint32_t>{7}),
          std::pair(std::string("all"), everybody), std::pair(names.info().groups[0], group)}) {
      Listened listened(who, options);
      Heard& heard = listened.heard;
      listened.own.begin(listened.run.info());
      int64_t events = 0, rows = 0;
      for (int i = 0; i < 30; ++i) {
        const Frame& frame = listened.run.step();
        const auto expected_events = of_bodies(frame.events, bodies);
        const auto expected_near = near_of(frame, bodies);
        listened.own.frame(listened.run.info(), frame);
        listened.take_in();
        ASSERT_EQ(pairs_of(heard.events), expected_events)
            << who << ", seed " << seed << ", frame " << i;
        ASSERT_EQ(pairs_of(heard.near), expected_near)
            << who << ", seed " << seed << ", frame " << i;
        ASSERT_EQ(heard.stamps.size(), 1U);
        EXPECT_EQ(heard.stamps[0].frame, frame.number);
        EXPECT_EQ(heard.stamps[0].events, static_cast<int32_t>(expected_events.size()));
        EXPECT_EQ(heard.stamps[0].proximity_rows, static_cast<int32_t>(expected_near.size()));
        EXPECT_GE(heard.stamps[0].sent_ns, heard.stamps[0].culling_ns);
        events += static_cast<int64_t>(expected_events.size());
        rows += static_cast<int64_t>(expected_near.size());
        heard.events.clear();
        heard.near.clear();
        heard.stamps.clear();
      }
      const RunEnd end = listened.run.finish();
      listened.own.end(listened.run.info(), end);
      listened.take_in();
      EXPECT_EQ(pairs_of(heard.events), of_bodies(end.events, bodies)) << "the last ends";
      EXPECT_GT(rows, 0) << who << ", seed " << seed;
      const FilteredChannels::PublishedTotals& told = listened.own.totals().front();
      EXPECT_EQ(told.proximity_rows, rows);
      EXPECT_EQ(told.events, events + static_cast<int64_t>(heard.events.size()));
      EXPECT_EQ(told.messages, listened.sink.messages());
    }
  }
}

TEST(FilteredChannels, ManyRowsComeInChunks) {
  Listened listened("all", {.avatars = 300, .pairs = 20'000});
  listened.own.begin(listened.run.info());
  const Frame& frame = listened.run.step();
  ASSERT_GT(frame.proximity_pairs.size(), kRowsPerMessage<proximity_t>);
  listened.own.frame(listened.run.info(), frame);
  listened.take_in();
  std::set<uint32_t> everybody;
  for (uint32_t i = 0; i < 300; ++i) everybody.insert(i);
  EXPECT_EQ(pairs_of(listened.heard.near), near_of(frame, everybody));
  EXPECT_EQ(pairs_of(listened.heard.events), pairs_of(frame.events));
  EXPECT_GT(listened.heard.next_seq[0], 1);
  EXPECT_GT(listened.heard.next_seq[1], 1);
}

TEST(FilteredChannels, AWordForAKindMeansAllOfItAndANumberABody) {
  const SyntheticRun run({.avatars = 20});
  RunInfo info = run.info();
  const auto told = [&info](const std::string& who) {
    const FilteredChannels own(info, std::vector<FilteredChannel>{{who, "MINE"}});
    return std::pair(own.totals().front().bodies, own.notes());
  };
  const int64_t of_group = told(info.groups[0]).first;
  ASSERT_LT(of_group, 20);
  const auto [bodies, notes] = told("all");
  EXPECT_TRUE(notes.empty());
  EXPECT_EQ(told("group:" + info.groups[0]).first, of_group);
  info.groups[0] = "all";
  EXPECT_EQ(told("all").first, bodies);
  EXPECT_THAT(told("all").second, testing::ElementsAre(testing::HasSubstr("'group:all'")));
  EXPECT_EQ(told("group:all"), std::pair(of_group, std::vector<std::string>()));
  info.groups[0] = "7";
  EXPECT_EQ(told("7").first, 1);
  EXPECT_THAT(told("7").second, testing::ElementsAre(testing::HasSubstr("'group:7'")));
  EXPECT_EQ(told("group:7").first, of_group);
}

TEST(FilteredChannels, WhoIsNotThereAndWhatIsNoChannelIsRefused) {
  const SyntheticRun run({.avatars = 20});
  const auto refusal = [&run](const std::string& text) {
    try {
      const FilteredChannels own(run.info(),
                                 std::vector<FilteredChannel>{parse_filtered_channel(text)});
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  for (const char* wrong : {"", "7", "7:", ":MINE", "7:THRONG_PROXIMITY", "7:A CHANNEL"})
    EXPECT_THAT(refusal(wrong),
                testing::StartsWith("--publish-for: expected WHO:CHANNEL, WHO a group, "))
        << wrong;
  EXPECT_NE(refusal("7:" + std::string(57, 'x')), "");
  EXPECT_EQ(refusal("7:" + std::string(56, 'x')), "");
  EXPECT_EQ(refusal("all:MINE"), "");
  EXPECT_EQ(refusal(run.info().groups[0] + ":MINE"), "");
  for (const char* nobody : {"nobody:MINE", "99999:MINE", "-1:MINE", "7x:MINE"})
    EXPECT_THAT(refusal(nobody), testing::HasSubstr("a body from 0 to ")) << nobody;
}

}  // namespace
}  // namespace throng::own_channels_test
