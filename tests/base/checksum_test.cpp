// The checksum detects every flipped bit and is the same on every machine.
#include "base/checksum.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <vector>

#include "base/random.h"

namespace throng::checksum_test {
namespace {

std::vector<uint8_t> bytes_of(size_t size, uint64_t seed) {
  std::vector<uint8_t> out(size);
  for (size_t i = 0; i < size; ++i)
    out[i] = static_cast<uint8_t>(random_bits({seed, i, 0, Purpose::kStyle}));
  return out;
}

TEST(Checksum, ChangesWithEveryFlippedBit) {
  constexpr uint64_t kSeed = 4;
  for (size_t size = 1; size <= 200; ++size)
    for (const bool is_zero : {false, true}) {
      auto bytes = is_zero ? std::vector<uint8_t>(size) : bytes_of(size, kSeed);
      const uint64_t sum = checksum(bytes);
      for (size_t bit = 0; bit < 8 * size; ++bit) {
        bytes[bit / 8] ^= static_cast<uint8_t>(1u << bit % 8);
        ASSERT_NE(checksum(bytes), sum) << "bit " << bit << " of " << size << ", seed " << kSeed;
        bytes[bit / 8] ^= static_cast<uint8_t>(1u << bit % 8);
      }
    }
}

TEST(Checksum, ChangesWithEveryWrongByte) {
  auto bytes = bytes_of(77, 5);
  const uint64_t sum = checksum(bytes);
  for (uint8_t& byte : bytes)
    for (int wrong = 1; wrong < 256; ++wrong) {
      byte ^= static_cast<uint8_t>(wrong);
      ASSERT_NE(checksum(bytes), sum) << "byte " << &byte - bytes.data() << " xor " << wrong;
      byte ^= static_cast<uint8_t>(wrong);
    }
}

TEST(Checksum, DependsOnLengthAndOrder) {
  std::set<uint64_t> seen;
  for (size_t size = 0; size <= 200; ++size) seen.insert(checksum(std::vector<uint8_t>(size)));
  EXPECT_EQ(seen.size(), 201u) << "trailing zeros";
  const auto bytes = bytes_of(64, 6);
  for (size_t i = 0; i + 8 <= 64; i += 8)
    for (size_t k = i + 8; k + 8 <= 64; k += 8) {
      auto swapped = bytes;
      const auto first = swapped.begin() + static_cast<ptrdiff_t>(i);
      std::swap_ranges(first, first + 8, swapped.begin() + static_cast<ptrdiff_t>(k));
      seen.insert(checksum(swapped));
    }
  EXPECT_EQ(seen.size(), 201u + 28u) << "swapped words";
}

// Logs store these numbers: a different result needs a new checksum_kind.
TEST(Checksum, IsTheSameOnEveryMachine) {
  std::vector<uint8_t> bytes(100);
  for (size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<uint8_t>(i);
  EXPECT_EQ(checksum(""), 0x88580a29a211f336u);
  EXPECT_EQ(checksum("THRONG_STATES"), 0x7f09f39a5b415de7u);
  EXPECT_EQ(checksum(bytes), 0x279017fc1d1da4d9u);
}

TEST(Chained, IsABijectionOfStateAndWord) {
  // No two states and no two words collide.
  std::set<uint64_t> of_states, of_words;
  for (uint64_t i = 0; i < 100'000; ++i) {
    of_states.insert(chained(i, 77));
    of_words.insert(chained(77, i));
  }
  EXPECT_EQ(of_states.size(), 100'000u);
  EXPECT_EQ(of_words.size(), 100'000u);
  EXPECT_NE(chained(0, 0), 0u) << "zeros must change the state";
  EXPECT_NE(chained(chained(1, 2), 3), chained(chained(1, 3), 2)) << "the order counts";
}

}  // namespace
}  // namespace throng::checksum_test
