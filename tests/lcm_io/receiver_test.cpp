// Receiver: all input is counted per run, and none stops it.
#include "lcm_io/wire/receiver.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <lcm/lcm-cpp.hpp>

#include "base/errors.h"
#include "base/random.h"
#include "lcm_io/codec/log_format.h"
#include "lcm_io/wire/lcm_sink.h"
#include "synthetic_run.h"

namespace throng::receiver_test {
namespace {

using namespace std::chrono_literals;
using Messages = std::vector<MessageList::Message>;

Messages run_of(uint64_t seed, uint64_t instance, int frames) {
  SyntheticRun run({.seed = seed, .pairs = 100});
  run.set_instance(instance);
  return messages_of(run, frames);
}

TEST(Receiver, ReceivesAllMessagesOfALiveRun) {
  const auto lcm = std::make_shared<lcm::LCM>("memq://");
  Receiver receiver(lcm);
  LcmSink sink({}, lcm);
  SyntheticRun run({.avatars = 300, .pairs = 200});
  run.play(sink, 30);
  int64_t calls = 0, updates = 0;
  while (receiver.receive(0ms, [&](const ReceivedMessage& m) {
    ++calls;
    updates += m.update == RunReader::Update::kState ? 1 : 0;
    EXPECT_TRUE(channel_of(m.channel).has_value());
  }) > 0) {
  }
  EXPECT_EQ(calls, sink.messages());
  EXPECT_EQ(updates, 30);
  ASSERT_EQ(receiver.inbox().runs().size(), 1u);
  const RunTally& tally = receiver.inbox().runs().front();
  EXPECT_TRUE(tally.ended && tally.from_start);
  for (const Channel channel : kAllChannels) {
    EXPECT_EQ(tally[channel].messages, sink.target_state().totals(channel).messages);
    EXPECT_EQ(tally[channel].missing, 0) << name_of(channel);
  }
  EXPECT_EQ(receiver.inbox().rejected(), 0);
}

TEST(Receiver, RethrowsExceptionsOfTheListener) {
  const auto lcm = std::make_shared<lcm::LCM>("memq://");
  Receiver receiver(lcm);
  LcmSink sink({}, lcm);
  SyntheticRun run({});
  run.play(sink, 2);
  EXPECT_THROW(
      receiver.receive(0ms, [](const ReceivedMessage&) { throw InputError("a", "b", "c"); }),
      InputError);
  EXPECT_GT(receiver.receive(0ms), 0) << "it continues";
}

TEST(Receiver, ReportsARemedyForAnUnusableUrl) {
  try {
    Receiver receiver("nosuchtransport://");
    FAIL() << "no error";
  } catch (const EnvironmentError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("ip route add 224.0.0.0/4 dev lo"));
  }
}

TEST(Inbox, CountsTwoRunsSeparately) {
  const Messages first = run_of(1, 100, 40), second = run_of(1, 200, 40);
  Inbox inbox;
  std::map<int64_t, std::array<int64_t, kChannelCount>> dropped, sent;
  const auto offer = [&](const MessageList::Message& m, int64_t instance, bool drop) {
    ++(drop ? dropped : sent)[instance][static_cast<size_t>(m.channel)];
    if (!drop) inbox.take(name_of(m.channel), m.bytes);
  };
  for (size_t i = 0; i < std::max(first.size(), second.size()); ++i) {
    // The first run loses messages, the second only its last ones. The last checksums follow the
    // end: their loss is not detected.
    const auto may_go = [i](const Messages& run) {
      return run[i].channel != Channel::kEnd && i + 1 < run.size();
    };
    if (i < first.size()) offer(first[i], 100, i % 5 == 4 && may_go(first));
    if (i < second.size()) offer(second[i], 200, i > second.size() - 10 && may_go(second));
  }
  ASSERT_EQ(inbox.runs().size(), 2u);
  for (const RunTally& run : inbox.runs()) {
    EXPECT_TRUE(run.ended);
    for (const Channel channel : kAllChannels) {
      const auto i = static_cast<size_t>(channel);
      EXPECT_EQ(run[channel].messages, sent[run.instance][i]) << name_of(channel);
      EXPECT_EQ(run[channel].missing, dropped[run.instance][i])
          << name_of(channel) << " of instance " << run.instance;
    }
  }
}

TEST(Inbox, LimitsTheNumberOfRuns) {
  Inbox inbox;
  const Messages run = run_of(1, 1, 1);
  for (int64_t instance = 0; instance < 1000; ++instance) {
    auto bytes = run.front().bytes;
    put_big_endian(bytes.data() + 24, instance);
    inbox.take("THRONG_RUN", bytes);
  }
  EXPECT_EQ(inbox.runs().size(), Inbox::kMaxRuns);
  EXPECT_EQ(inbox.runs().back().instance, 999);
}

TEST(Inbox, ContinuesTheSameRunAfterSilence) {
  const Messages run = run_of(1, 1, 60);
  Inbox inbox;
  int64_t lost = 0;
  for (size_t i = 0; i < run.size(); ++i) {
    const bool is_away = i > run.size() / 3 && i < run.size() / 2;
    if (i == run.size() / 2) inbox.run().forget();
    lost += is_away ? 1 : 0;
    if (!is_away) inbox.take(name_of(run[i].channel), run[i].bytes);
  }
  EXPECT_NE(inbox.run().run(), nullptr) << "the description is kept";
  int64_t missing = 0;
  for (const Channel channel : kAllChannels) missing += inbox.run().tally(channel).missing;
  EXPECT_EQ(missing, lost) << "the outage is counted";
}

/// Returns a message after damage, or as made by an attacker.
std::vector<uint8_t> damaged(const std::vector<uint8_t>& sound, const RandomKey& key) {
  auto bytes = sound;
  const auto random = [&key](uint32_t k) { return random_bits(key, k); };
  switch (random(0) % 5) {
    case 0:
      for (uint32_t hit = 0; hit < 1 + random(1) % 8; ++hit)
        bytes[random(2 * hit + 2) % bytes.size()] = static_cast<uint8_t>(random(2 * hit + 3));
      break;
    case 1:
      put_big_endian(bytes.data() + random(1) % (bytes.size() - 4),
                     static_cast<int32_t>(random(2) % 4 == 0 ? INT32_MAX : random(3)));
      break;
    case 2:
      bytes.resize(random(1) % bytes.size());
      break;
    case 3:
      bytes.resize(bytes.size() + random(1) % 1000, static_cast<uint8_t>(random(2)));
      break;
    default:  // noise after a valid fingerprint
      for (size_t i = 8; i < bytes.size(); ++i)
        bytes[i] = static_cast<uint8_t>(random(static_cast<uint32_t>(i)));
  }
  return bytes;
}

TEST(Receiver, FollowsTheRunDespiteAHundredThousandDamagedPackets) {
  constexpr uint64_t kSeed = 4;
  const auto lcm = std::make_shared<lcm::LCM>("memq://");
  Receiver receiver(lcm);
  SyntheticRun source(
      {.avatars = 6, .pairs = 10, .crowd = SyntheticRun::Crowd::kRovers, .has_budget = true});
  const Messages run = messages_of(source, 200, {.part_poses = true});
  int64_t sent = 0, forged = 0;
  const auto send = [&](Channel channel, std::span<const uint8_t> bytes) {
    ++sent;
    ASSERT_EQ(lcm->publish(std::string(name_of(channel)), bytes.data(),
                           static_cast<unsigned>(bytes.size())),
              0);
  };
  const uint64_t per_message = 100'000 / run.size() + 1;
  for (size_t i = 0; i < run.size(); ++i) {
    send(run[i].channel, run[i].bytes);
    for (uint64_t copy = 0; copy < per_message && forged < 100'000; ++copy, ++forged) {
      const RandomKey key{kSeed, i, copy, Purpose::kStyle};
      const auto& victim = run[random_bits(key, 1'000'000) % run.size()];
      send(victim.channel, damaged(victim.bytes, key));
    }
    while (receiver.receive(0ms) > 0) {
    }
  }
  EXPECT_EQ(forged, 100'000);
  int64_t received = 0;
  for (const Channel channel : kAllChannels) received += receiver.inbox().totals(channel).messages;
  EXPECT_EQ(received, sent) << "all were checked, seed " << kSeed;
  EXPECT_GT(receiver.inbox().rejected(), 50'000);
  EXPECT_LE(receiver.inbox().runs().size(), Inbox::kMaxRuns);
  EXPECT_EQ(receiver.inbox().others(), 0);
}

}  // namespace
}  // namespace throng::receiver_test
