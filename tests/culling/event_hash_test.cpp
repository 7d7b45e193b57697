// EventHash adds up events in any order and chains frames in order; every event counts.
#include "culling/event_hash.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "base/random.h"

namespace throng::event_hash_test {
namespace {

std::vector<PairEvent> events_of(uint64_t seed, uint64_t frame, size_t count) {
  std::vector<PairEvent> out;
  for (uint64_t i = 0; i < count; ++i) {
    const RandomKey key{seed, i, frame, Purpose::kGoal};
    const auto a = static_cast<uint32_t>(random_bits(key, 0) % 1000);
    const auto b = a + 1 + static_cast<uint32_t>(random_bits(key, 1) % 1000);
    out.push_back({PairKey(a, b, static_cast<uint32_t>(random_bits(key, 2) % 15),
                           static_cast<uint32_t>(random_bits(key, 3) % 15)),
                   random_bits(key, 4) % 2 == 0 ? EventKind::kBegin : EventKind::kEnd,
                   PairLevel::kPartVolume});
  }
  return out;
}

EventSum sum_of(std::span<const PairEvent> events, EventHashKind kind = EventHashKind::kEvents) {
  EventSum sum;
  sum.add(events, kind);
  return sum;
}

TEST(EventHash, AddsUpPartsOfACrowdInAnyOrder) {
  constexpr uint64_t kSeed = 12;
  EventHash whole, split;
  for (uint64_t frame = 0; frame < 50; ++frame) {
    auto events = events_of(kSeed, frame, 40);
    whole.add_frame(frame, sum_of(events));
    std::reverse(events.begin(), events.end());
    EventSum sum;
    for (size_t first = 0; first < events.size(); first += 7)
      sum += sum_of(std::span(events).subspan(first, std::min<size_t>(7, events.size() - first)));
    split.add_frame(frame, sum);
  }
  EXPECT_EQ(split.value(), whole.value()) << "seed " << kSeed;
}

TEST(EventHash, DependsOnFrameOrderAndNumbers) {
  const EventSum a = sum_of(events_of(1, 0, 5)), b = sum_of(events_of(1, 1, 5));
  const auto of = [](std::initializer_list<std::pair<uint64_t, EventSum>> frames) {
    EventHash hash;
    for (const auto& [frame, sum] : frames) hash.add_frame(frame, sum);
    return hash.value();
  };
  EXPECT_NE(of({{0, a}, {1, b}}), of({{0, b}, {1, a}}));
  EXPECT_NE(of({{0, a}, {1, b}}), of({{0, a}, {2, b}}));
  EXPECT_EQ(of({{0, a}, {1, {}}, {2, b}}), of({{0, a}, {2, b}})) << "nothing happened";
  EXPECT_EQ(of({{3, {}}}), 0u);
}

TEST(EventHash, DependsOnEveryEvent) {
  const auto events = events_of(3, 0, 30);
  constexpr EventHashKind kLevels = EventHashKind::kEventsAndLevels;
  const EventSum sum = sum_of(events, kLevels);
  EXPECT_NE(sum.sum, sum_of(events).sum) << "known levels";
  for (size_t i = 0; i < events.size(); ++i) {
    auto other = events;
    other[i].kind = other[i].kind == EventKind::kBegin ? EventKind::kEnd : EventKind::kBegin;
    EXPECT_NE(sum_of(other, kLevels).sum, sum.sum) << "kind of event " << i;
    other = events;
    other[i].pair = PairKey(other[i].pair.a(), other[i].pair.b() ^ 1, 3, 4);
    EXPECT_NE(sum_of(other, kLevels).sum, sum.sum) << "pair of event " << i;
    other = events;
    other[i].level = PairLevel::kTriangles;
    EXPECT_NE(sum_of(other, kLevels).sum, sum.sum) << "level of event " << i;
    EXPECT_EQ(sum_of(other).sum, sum_of(events).sum) << "a level that is not hashed";
  }
}

TEST(EventHash, ContinuesFromAHash) {
  EventHash whole;
  uint64_t middle = 0;
  for (uint64_t frame = 0; frame < 20; ++frame) {
    if (frame == 9) middle = whole.value();
    whole.add_frame(frame, sum_of(events_of(8, frame, 10)));
  }
  EventHash rest(middle);
  for (uint64_t frame = 9; frame < 20; ++frame)
    rest.add_frame(frame, sum_of(events_of(8, frame, 10)));
  EXPECT_EQ(rest.value(), whole.value());
}

// Published hashes depend on this value: a change needs a new EventHashKind.
TEST(EventHash, HasTheValueOfExistingLogs) {
  EventHash hash;
  hash.add_frame(7, sum_of(std::vector<PairEvent>{{PairKey(1, 2, 3, 4), EventKind::kBegin}}));
  EXPECT_EQ(hash.value(), 0xae8754dbc5148aa1u);
}

}  // namespace
}  // namespace throng::event_hash_test
