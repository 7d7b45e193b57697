// Filtered channels publish exactly the rows of the run with their bodies.
#include "lcm_io/wire/filtered_channels.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <lcm/lcm-cpp.hpp>
#include <set>

#include "base/errors.h"
#include "lcm_io/codec/message_validation.h"
#include "lcm_io/codec/rows.h"
#include "synthetic_run.h"

namespace throng::filtered_channels_test {
namespace {

/// Messages received on the channels of one subscriber.
struct Received {
  std::vector<PairEvent> events;
  std::vector<ProximityPair> proximity;
  std::vector<stamp_t> stamps;
  int64_t next_seq[3] = {0, 0, 0};
};

template <class Message>
void number(Received& received, int of, const Message& m) {
  EXPECT_EQ(m.seq, received.next_seq[of]++);
  EXPECT_EQ(m.schema, kSchema);
  EXPECT_LT(m.chunk, m.chunk_count);
}

/// A synthetic run with a subscriber on one channel.
struct Subscription {
  explicit Subscription(const std::string& who, SyntheticRun::Options options = {})
      : lcm(std::make_shared<lcm::LCM>("memq://")),
        sink({}, lcm),
        run(with_proximity(options)),
        own(run.info(), std::vector<FilteredChannel>{{who, "MINE"}}) {
    own.publish_by(sink);
    lcm->subscribeFunction(
        "MINE_EVENTS",
        +[](const lcm::ReceiveBuffer* b, const std::string&, Received* to) {
          events_t m;
          ASSERT_EQ(decode({static_cast<const uint8_t*>(b->data), b->data_size}, m), "");
          number(*to, 0, m);
          for (size_t i = 0; i < m.a.size(); ++i)
            to->events.push_back({pair_at(m, i), static_cast<EventKind>(m.kind[i]),
                                  static_cast<PairLevel>(m.level[i])});
        },
        &received);
    lcm->subscribeFunction(
        "MINE_PROXIMITY",
        +[](const lcm::ReceiveBuffer* b, const std::string&, Received* to) {
          proximity_t m;
          ASSERT_EQ(decode({static_cast<const uint8_t*>(b->data), b->data_size}, m), "");
          number(*to, 1, m);
          for (size_t i = 0; i < m.a.size(); ++i) to->proximity.push_back(proximity_at(m, i));
        },
        &received);
    lcm->subscribeFunction(
        "MINE_STAMP",
        +[](const lcm::ReceiveBuffer*, const std::string&, const stamp_t* m, Received* to) {
          number(*to, 2, *m);
          to->stamps.push_back(*m);
        },
        &received);
  }
  static SyntheticRun::Options with_proximity(SyntheticRun::Options options) {
    options.proximity = true;
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
  Received received;
};

/// Selects rows by a set of bodies, row by row.
template <class Rows>
std::vector<PairKey> of_bodies(const Rows& rows, const std::set<uint32_t>& bodies) {
  std::vector<PairKey> own;
  for (const auto& row : rows)
    if (bodies.contains(row.pair.a()) || bodies.contains(row.pair.b())) own.push_back(row.pair);
  return own;
}

std::vector<PairKey> proximity_of(const Frame& frame, const std::set<uint32_t>& bodies) {
  std::vector<PairKey> own = of_bodies(frame.proximity_pairs, bodies);
  const std::vector<PairKey> closest = of_bodies(frame.closest_parts, bodies);
  own.insert(own.end(), closest.begin(), closest.end());
  return own;
}

std::vector<PairKey> pairs_of(const auto& rows) {
  std::vector<PairKey> pairs;
  for (const auto& row : rows) pairs.push_back(row.pair);
  return pairs;
}

TEST(FilteredChannels, PublishExactlyTheRowsOfTheirBodies) {
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    const SyntheticRun::Options options{.avatars = 20, .seed = seed, .pairs = 60};
    const SyntheticRun names(options);
    std::set<uint32_t> group, all_bodies;
    for (uint32_t i = 0; i < 20; ++i) {
      all_bodies.insert(i);
      if (names.info().group_of_avatar[i] == 0) group.insert(i);
    }
    for (const auto& [who, bodies] :
         {std::pair(std::string("7"), std::set<uint32_t>{7}),
          std::pair(std::string("all"), all_bodies), std::pair(names.info().groups[0], group)}) {
      Subscription subscription(who, options);
      Received& received = subscription.received;
      subscription.own.begin(subscription.run.info());
      int64_t events = 0, rows = 0;
      for (int i = 0; i < 30; ++i) {
        const Frame& frame = subscription.run.step();
        const auto expected_events = of_bodies(frame.events, bodies);
        const auto expected_proximity = proximity_of(frame, bodies);
        subscription.own.frame(subscription.run.info(), frame);
        subscription.take_in();
        ASSERT_EQ(pairs_of(received.events), expected_events)
            << who << ", seed " << seed << ", frame " << i;
        ASSERT_EQ(pairs_of(received.proximity), expected_proximity)
            << who << ", seed " << seed << ", frame " << i;
        ASSERT_EQ(received.stamps.size(), 1U);
        EXPECT_EQ(received.stamps[0].frame, frame.number);
        EXPECT_EQ(received.stamps[0].events, static_cast<int32_t>(expected_events.size()));
        EXPECT_EQ(received.stamps[0].proximity_rows,
                  static_cast<int32_t>(expected_proximity.size()));
        EXPECT_GE(received.stamps[0].sent_ns, received.stamps[0].culling_ns);
        events += static_cast<int64_t>(expected_events.size());
        rows += static_cast<int64_t>(expected_proximity.size());
        received.events.clear();
        received.proximity.clear();
        received.stamps.clear();
      }
      const RunEnd end = subscription.run.finish();
      subscription.own.end(subscription.run.info(), end);
      subscription.take_in();
      EXPECT_EQ(pairs_of(received.events), of_bodies(end.events, bodies))
          << "the ends at the end of the run";
      EXPECT_GT(rows, 0) << who << ", seed " << seed;
      const FilteredChannels::PublishedTotals& totals = subscription.own.totals().front();
      EXPECT_EQ(totals.proximity_rows, rows);
      EXPECT_EQ(totals.events, events + static_cast<int64_t>(received.events.size()));
      EXPECT_EQ(totals.messages, subscription.sink.messages());
    }
  }
}

TEST(FilteredChannels, SendManyRowsInChunks) {
  Subscription subscription("all", {.avatars = 300, .pairs = 20'000});
  subscription.own.begin(subscription.run.info());
  const Frame& frame = subscription.run.step();
  ASSERT_GT(frame.proximity_pairs.size(), kRowsPerMessage<proximity_t>);
  subscription.own.frame(subscription.run.info(), frame);
  subscription.take_in();
  std::set<uint32_t> all_bodies;
  for (uint32_t i = 0; i < 300; ++i) all_bodies.insert(i);
  EXPECT_EQ(pairs_of(subscription.received.proximity), proximity_of(frame, all_bodies));
  EXPECT_EQ(pairs_of(subscription.received.events), pairs_of(frame.events));
  EXPECT_GT(subscription.received.next_seq[0], 1);
  EXPECT_GT(subscription.received.next_seq[1], 1);
}

TEST(FilteredChannels, SelectKindsByWordAndBodiesById) {
  const SyntheticRun run({.avatars = 20});
  RunInfo info = run.info();
  const auto selected = [&info](const std::string& who) {
    const FilteredChannels own(info, std::vector<FilteredChannel>{{who, "MINE"}});
    return std::pair(own.totals().front().bodies, own.notes());
  };
  const int64_t of_group = selected(info.groups[0]).first;
  ASSERT_LT(of_group, 20);
  const auto [bodies, notes] = selected("all");
  EXPECT_TRUE(notes.empty());
  EXPECT_EQ(selected("group:" + info.groups[0]).first, of_group);
  info.groups[0] = "all";
  EXPECT_EQ(selected("all").first, bodies);
  EXPECT_THAT(selected("all").second, testing::ElementsAre(testing::HasSubstr("'group:all'")));
  EXPECT_EQ(selected("group:all"), std::pair(of_group, std::vector<std::string>()));
  info.groups[0] = "7";
  EXPECT_EQ(selected("7").first, 1);
  EXPECT_THAT(selected("7").second, testing::ElementsAre(testing::HasSubstr("'group:7'")));
  EXPECT_EQ(selected("group:7").first, of_group);
}

TEST(FilteredChannels, RejectUnknownBodiesAndInvalidChannels) {
  const SyntheticRun run({.avatars = 20});
  const auto rejection = [&run](const std::string& text) {
    try {
      const FilteredChannels own(run.info(),
                                 std::vector<FilteredChannel>{parse_filtered_channel(text)});
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  for (const char* wrong : {"", "7", "7:", ":MINE", "7:THRONG_PROXIMITY", "7:A CHANNEL"})
    EXPECT_THAT(rejection(wrong),
                testing::StartsWith("--publish-for: expected WHO:CHANNEL, WHO a group, "))
        << wrong;
  EXPECT_NE(rejection("7:" + std::string(54, 'x')), "");
  EXPECT_EQ(rejection("7:" + std::string(53, 'x')), "");
  EXPECT_EQ(rejection("all:MINE"), "");
  EXPECT_EQ(rejection(run.info().groups[0] + ":MINE"), "");
  for (const char* unknown : {"unknown:MINE", "99999:MINE", "-1:MINE", "7x:MINE"})
    EXPECT_THAT(rejection(unknown), testing::HasSubstr("a body id from 0 to ")) << unknown;
}

}  // namespace
}  // namespace throng::filtered_channels_test
