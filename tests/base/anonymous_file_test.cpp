// ExternalSorter gives the same order as sorting in memory.
#include "base/files/anonymous_file.h"

#include <gtest/gtest.h>

#include "base/random.h"

namespace throng::anonymous_file_test {
namespace {

struct Value {
  uint64_t key = 0;
  uint64_t number = 0;
  bool operator==(const Value&) const = default;
};

struct ByKey {
  bool operator()(const Value& a, const Value& b) const {
    return a.key != b.key ? a.key < b.key : a.number < b.number;
  }
};

TEST(ExternalSorter, VisitsAnyNumberOfValuesInOrder) {
  using Spill = ExternalSorter<Value, ByKey>;
  const size_t run = Spill::kRun;
  for (const size_t count : {size_t{0}, size_t{1}, run - 1, run, run + 1, 3 * run, 7 * run + 123}) {
    Spill spill;
    std::vector<Value> expected;
    for (size_t i = 0; i < count; ++i) {
      const double drawn = random_uniform({count, i, 0, Purpose::kHeight});
      const Value value{static_cast<uint64_t>(drawn * 1e5), i};  // some keys repeat
      spill.add(value);
      expected.push_back(value);
    }
    std::sort(expected.begin(), expected.end(), ByKey{});
    EXPECT_EQ(spill.size(), count);
    for (int time = 0; time < 2; ++time) {
      std::vector<Value> found;
      spill.for_each([&](const Value& value) { found.push_back(value); });
      EXPECT_TRUE(found == expected) << count << " values";
    }
  }
}

}  // namespace
}  // namespace throng::anonymous_file_test
