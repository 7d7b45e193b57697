// Grouping by a small key is complete, ordered by key, and stable.
#include "base/counting_sort.h"

#include <gtest/gtest.h>

#include <vector>

#include "base/random.h"

namespace throng::counting_sort_test {
namespace {

TEST(CountingSort, GroupsItemsByKeyAndKeepsTheirOrder) {
  for (const size_t count : {size_t{0}, size_t{1}, size_t{5000}}) {
    constexpr size_t kKeys = 37;
    std::vector<uint32_t> keys(count), sorted(count), start(kKeys + 2);
    for (size_t i = 0; i < count; ++i)
      keys[i] = static_cast<uint32_t>(random_uniform({.seed = 5, .id = i}) * kKeys);
    counting_sort(
        count, kKeys, start.data(), [&](size_t i) { return keys[i]; },
        [&](size_t i, uint32_t at) { sorted[at] = static_cast<uint32_t>(i); });
    EXPECT_EQ(start[0], 0u);
    EXPECT_EQ(start[kKeys], count);
    for (uint32_t key = 0; key < kKeys; ++key) {
      for (uint32_t at = start[key]; at < start[key + 1]; ++at) {
        EXPECT_EQ(keys[sorted[at]], key);
        if (at > start[key]) {
          EXPECT_LT(sorted[at - 1], sorted[at]) << "not stable";
        }
      }
    }
  }
}

}  // namespace
}  // namespace throng::counting_sort_test
