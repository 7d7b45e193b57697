// Message validation: any bytes give a sound message or a reason.
#include "lcm_io/codec/message_validation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/random.h"
#include "lcm_io/codec/log_format.h"
#include "synthetic_run.h"

namespace throng::message_validation_test {
namespace {

using testing::HasSubstr;

std::vector<MessageList::Message> one_of_each() {
  SyntheticRun run({.avatars = 5, .seed = 3, .pairs = 12, .changes = true, .proximity = true});
  std::vector<MessageList::Message> out;
  std::set<Channel> seen;
  for (auto& m : messages_of(run, 2, {.part_poses = true}))
    if (seen.insert(m.channel).second) out.push_back(std::move(m));
  return out;
}

TEST(MessageValidation, AcceptsEveryMessageOfThrong) {
  const auto messages = one_of_each();
  EXPECT_EQ(messages.size(), static_cast<size_t>(kChannelCount));
  for (const auto& m : messages)
    EXPECT_EQ(check_message(m.channel, m.bytes), "") << name_of(m.channel);
}

TEST(MessageValidation, RejectsMessagesOfWrongLength) {
  for (const auto& m : one_of_each()) {
    auto bytes = m.bytes;
    bytes.push_back(0);
    EXPECT_THAT(check_message(m.channel, bytes),
                HasSubstr(bytes.size() > kMaxMessageBytes ? "bytes" : "extra bytes after"))
        << name_of(m.channel);
    const size_t step = std::max<size_t>(1, m.bytes.size() / 500);
    for (size_t size = 0; size < m.bytes.size(); size += step)
      ASSERT_NE(check_message(m.channel, std::span(m.bytes).first(size)), "")
          << name_of(m.channel) << " cut to " << size;
  }
}

TEST(MessageValidation, NamesAForeignFingerprint) {
  for (auto& m : one_of_each()) {
    m.bytes[3] ^= 1;
    EXPECT_THAT(check_message(m.channel, m.bytes), HasSubstr("another version of Throng?"))
        << name_of(m.channel);
  }
  const auto messages = one_of_each();
  for (const auto& m : messages)
    for (const Channel other : kAllChannels)
      EXPECT_EQ(check_message(other, m.bytes).empty(), other == m.channel) << name_of(other);
}

TEST(MessageValidation, RejectsAnotherSchema) {
  for (const auto& m : one_of_each()) {
    auto bytes = m.bytes;
    put_big_endian(bytes.data() + 56, int32_t{2});
    EXPECT_EQ(check_message(m.channel, bytes), "schema 2, this program reads 1");
  }
}

TEST(MessageValidation, RejectsInvalidPairsAndPresence) {
  SyntheticRun run({.avatars = 12, .seed = 3, .pairs = 12, .comings = true});
  const auto defect_of_encoded = [](const auto& message) {
    std::vector<uint8_t> bytes(static_cast<size_t>(message.getEncodedSize()));
    message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    auto out = message;
    return decode(bytes, out);
  };
  for (const auto& m : messages_of(run, 1)) {
    if (m.channel == Channel::kEvents) {
      events_t sound;
      ASSERT_EQ(decode(m.bytes, sound), "");
      const auto with = [&](auto change) {
        events_t damaged = sound;
        change(damaged);
        return defect_of_encoded(damaged);
      };
      EXPECT_THAT(with([](auto& e) { e.b[0] = e.a[0]; }),
                  HasSubstr("expected 0 <= a < b <= 16777215, found a "));
      EXPECT_THAT(with([](auto& e) { e.b[0] = 1 << 24; }), HasSubstr(", b 16777216"));
      EXPECT_THAT(with([](auto& e) { e.part_a[0] = 255; }),
                  HasSubstr("(part_b == 255), found part_a 255, part_b "));
      EXPECT_EQ(with([](auto& e) { e.part_a[0] = e.part_b[0] = 255; }), "") << "whole bodies";
      EXPECT_EQ(with([](auto& e) { e.level[0] = 4; }), "expected level <= 3, found level 4");
      EXPECT_EQ(with([](auto& e) { e.kind[0] = 2; }), "expected kind <= 1, found kind 2");
    }
    if (m.channel == Channel::kStates) {
      states_t states;
      ASSERT_EQ(decode(m.bytes, states), "");
      ASSERT_EQ(states.present_count, 12);
      states.present.pop_back();
      --states.present_count;
      EXPECT_EQ(
          defect_of_encoded(states),
          "expected present_count == 0 || present_count == avatar_count, found present_count 11, "
          "avatar_count 12");
    }
  }
}

TEST(MessageValidation, NeitherThrowsNorAllocatesOnMaliciousCounts) {
  // Replaces each int32 of a message by a count that would crash generated code.
  for (const auto& m : one_of_each()) {
    const size_t end = std::min<size_t>(m.bytes.size() - 4, 2000);
    for (size_t at = 8; at < end; ++at)
      for (const int32_t count : {-1, INT32_MIN, INT32_MAX, 0x10000000}) {
        auto bytes = m.bytes;
        put_big_endian(bytes.data() + at, count);
        EXPECT_NO_THROW(check_message(m.channel, bytes));
      }
  }
}

TEST(MessageValidation, NeitherThrowsNorAllocatesOnMaliciousDescriptions) {
  SyntheticRun run({.avatars = 4, .crowd = SyntheticRun::Crowd::kRovers});
  const run_description_t description = describe(run.info());
  std::vector<uint8_t> sound(static_cast<size_t>(description.getEncodedSize()));
  description.encode(sound.data(), 0, static_cast<int>(sound.size()));
  run_description_t out;
  ASSERT_EQ(decode(sound, out), "");
  for (size_t at = 8; at + 4 <= sound.size(); ++at)
    for (const int32_t count : {-1, 0, INT32_MIN, INT32_MAX}) {
      auto bytes = sound;
      put_big_endian(bytes.data() + at, count);
      EXPECT_NO_THROW(decode(bytes, out)) << "count " << count << " at byte " << at;
    }
  for (size_t size = 0; size < sound.size(); ++size)
    ASSERT_NE(decode(std::span(sound).first(size), out), "") << "cut to " << size;
}

TEST(MessageValidation, GivesAMessageOrAReasonAfterRandomDamage) {
  constexpr uint64_t kSeed = 77;
  const auto messages = one_of_each();
  int rejected = 0;
  for (uint64_t round = 0; round < 20'000; ++round) {
    SCOPED_TRACE(testing::Message() << "seed " << kSeed << " round " << round);
    const RandomKey key{kSeed, round, 0, Purpose::kStyle};
    const auto& m = messages[random_bits(key, 0) % messages.size()];
    auto bytes = m.bytes;
    for (uint32_t hit = 0; hit < 4; ++hit)
      bytes[random_bits(key, 2 * hit + 1) % bytes.size()] =
          static_cast<uint8_t>(random_bits(key, 2 * hit + 2));
    ASSERT_NO_THROW(rejected += check_message(m.channel, bytes).empty() ? 0 : 1);
  }
  EXPECT_GT(rejected, 1000);
}

TEST(MessageValidation, RejectsImpossibleHeaders) {
  for (const auto& m : one_of_each()) {
    const auto with = [&](size_t at, auto value) {
      auto bytes = m.bytes;
      put_big_endian(bytes.data() + at, value);
      return check_message(m.channel, bytes);
    };
    EXPECT_THAT(with(8, int64_t{-1}), HasSubstr("utime"));
    EXPECT_THAT(with(32, INT64_MAX), HasSubstr("seq"));
    EXPECT_THAT(with(40, INT64_MIN), HasSubstr("seq"));
    EXPECT_THAT(with(48, int32_t{-1}), HasSubstr("chunk -1"));
    EXPECT_THAT(with(52, int32_t{0}), HasSubstr("of 0"));
    EXPECT_THAT(with(52, INT32_MAX), HasSubstr("chunk"));
    EXPECT_THAT(with(56, kSchema + 1), HasSubstr("schema 2, this program reads 1"));
  }
}

}  // namespace
}  // namespace throng::message_validation_test
