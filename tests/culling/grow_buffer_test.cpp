// GrowBuffer grows with the crowd, keeps the requested content and never shrinks.
#include <gtest/gtest.h>

#include <numeric>
#include <utility>

#include "base/memory.h"

namespace throng::grow_buffer_test {
namespace {

TEST(GrowBuffer, KeepsContentFromAFewBytesToManyPages) {
  GrowBuffer<uint64_t> buffer;
  size_t written = 0;
  uint64_t next = 0;
  while (buffer.capacity() < 1'000'000) {
    buffer.grow(buffer.capacity() + 1, written);
    ASSERT_EQ(reinterpret_cast<uintptr_t>(buffer.data()) % 64, 0u);
    for (size_t i = 0; i < written; ++i) ASSERT_EQ(buffer[i], i) << buffer.capacity();
    for (; written < buffer.capacity(); ++written) buffer[written] = next++;
  }
  EXPECT_GT(buffer.times_grown(), 30u);
}

TEST(GrowBuffer, GrowsByAQuarter) {
  GrowBuffer<uint32_t> buffer;
  for (size_t count = 1; count <= 100'000; ++count) buffer.resize(count);
  EXPECT_LT(buffer.times_grown(), 45u);
  EXPECT_LT(buffer.capacity(), 126'000u);
  const uint32_t before = buffer.times_grown();
  for (size_t count = 100'000; count > 0; --count) buffer.resize(count);
  EXPECT_EQ(buffer.times_grown(), before);
}

TEST(GrowBuffer, MatchesAnotherAndSwaps) {
  GrowBuffer<uint32_t> small, large;
  large.resize(300'000);
  std::iota(large.data(), large.data() + 300'000, 0u);
  small.resize(3);
  small.match(large);
  EXPECT_EQ(small.capacity(), large.capacity());
  small[299'999] = 7;
  small = std::move(large);
  EXPECT_EQ(small[299'999], 299'999u);
  const GrowBuffer<uint32_t> taken(std::move(small));
  EXPECT_EQ(taken[1], 1u);
}

}  // namespace
}  // namespace throng::grow_buffer_test
