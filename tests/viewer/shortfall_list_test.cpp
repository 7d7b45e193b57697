// Tests the separation shortfalls of the timeline.
#include "viewer/server/shortfall_list.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace throng::shortfall_list_test {
namespace {

ShortfallEvent event(EventKind kind, uint32_t person, int64_t begin_frame) {
  Shortfall shortfall;
  shortfall.robot = 1;
  shortfall.person = person;
  shortfall.region = BodyRegion::kHands;
  shortfall.begin_frame = begin_frame;
  shortfall.max_shortfall_m = 0.25F;
  return {kind, shortfall};
}

void take(ShortfallList& list, int64_t frame, const ShortfallEvent& one) {
  list.take(frame, std::span(&one, 1));
}

TEST(ShortfallList, JoinsBeginsAndEnds) {
  ShortfallList list;
  EXPECT_TRUE(list.to_json().empty());
  take(list, 10, event(EventKind::kBegin, 5, 10));
  take(list, 12, event(EventKind::kBegin, 6, 12));
  take(list, 20, event(EventKind::kEnd, 5, 10));
  take(list, 30, event(EventKind::kEnd, 7, 3));  // its begin was not recorded
  const nlohmann::json all = list.to_json();
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0], nlohmann::json({10, 20, 1, 5, "hands", 0.25}));
  EXPECT_EQ(all[1], nlohmann::json({12, -1, 1, 6, "hands", 0.25}));
  EXPECT_EQ(all[2], nlohmann::json({3, 30, 1, 7, "hands", 0.25}));
}

TEST(ShortfallList, IsBounded) {
  ShortfallList list;
  const std::vector<ShortfallEvent> ends(2 * ShortfallList::kCapacity,
                                         event(EventKind::kEnd, 5, 1));
  list.take(9, ends);
  EXPECT_EQ(list.to_json().size(), ShortfallList::kCapacity);
}

}  // namespace
}  // namespace throng::shortfall_list_test
