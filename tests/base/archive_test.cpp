// An archive restores every bit and rejects impossible content.
#include "base/files/archive.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "base/errors.h"

namespace throng::archive_test {
namespace {

enum class Colour : uint8_t { kRed = 1, kBlue = 7 };

struct Inner {
  int32_t count = 0;
  double length = 0;
  void archive(Archive& a) { a(count, length); }
  bool operator==(const Inner&) const = default;
};

struct Everything {
  uint8_t byte = 0;
  int64_t negative = 0;
  float small = 0;
  double large = 0;
  bool is_set = false;
  Colour colour = Colour::kRed;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  Eigen::Quaternionf turn = Eigen::Quaternionf::Identity();
  std::vector<Inner> inner = std::vector<Inner>(2);
  std::vector<uint16_t> list;

  void archive(Archive& a) {
    a(byte, negative, small, large, is_set, colour, point, turn, inner);
    a.resized(list, 100);
  }
};

Everything example() {
  Everything e;
  e.byte = 200;
  e.negative = std::numeric_limits<int64_t>::min();
  e.small = -0.0F;
  e.large = std::numeric_limits<double>::denorm_min();
  e.is_set = true;
  e.colour = Colour::kBlue;
  e.point = {1, -2, 1e300};
  e.turn = {0.5F, -0.5F, 0.5F, 0.5F};
  e.inner = {{-3, 0.1}, {4, 1e-300}};
  e.list = {1, 2, 65535};
  return e;
}

std::vector<uint8_t> bytes_of(Everything e) {
  Archive out;
  out(e);
  return out.bytes();
}

TEST(Archive, RestoresEveryBit) {
  Everything expected = example();
  Everything found;
  const std::vector<uint8_t> bytes = bytes_of(expected);
  Archive in(bytes, "test");
  in(found);
  in.expect_end();
  EXPECT_EQ(bytes_of(found), bytes);
  EXPECT_EQ(found.negative, expected.negative);
  EXPECT_TRUE(std::signbit(found.small));
  EXPECT_EQ(found.colour, Colour::kBlue);
  EXPECT_EQ(found.point, expected.point);
  EXPECT_EQ(found.turn.coeffs(), expected.turn.coeffs());
  EXPECT_EQ(found.inner, expected.inner);
  EXPECT_EQ(found.list, expected.list);
}

TEST(Archive, HasTheSameBytesOnEveryMachine) {
  Archive out;
  uint32_t word = 0x01020304;
  double one = 1;
  out(word, one);
  EXPECT_THAT(out.bytes(), testing::ElementsAre(4, 3, 2, 1, 0, 0, 0, 0, 0, 0, 0xf0, 0x3f));
}

TEST(Archive, RejectsTruncationAndSurplus) {
  std::vector<uint8_t> bytes = bytes_of(example());
  for (size_t size = 0; size < bytes.size(); ++size) {
    Everything found;
    const std::vector<uint8_t> cut(bytes.begin(), bytes.begin() + static_cast<ptrdiff_t>(size));
    Archive in(cut, "test");
    EXPECT_THROW(in(found), InputError) << size << " of " << bytes.size() << " bytes";
  }
  bytes.push_back(0);
  Everything found;
  Archive in(bytes, "test");
  in(found);
  EXPECT_THROW(in.expect_end(), InputError);
}

TEST(Archive, RejectsImpossibleLengths) {
  for (const uint64_t length : {uint64_t{3}, uint64_t{1} << 40, ~uint64_t{0}}) {
    Archive out;
    uint64_t count = length;
    uint16_t value = 7;
    out(count, value, value);
    std::vector<uint16_t> two(2);
    Archive fixed(out.bytes(), "test");
    EXPECT_THROW(fixed(two), InputError) << length;
    Archive resized(out.bytes(), "test");
    EXPECT_THROW(resized.resized(two, size_t{1} << 50), InputError) << length;
  }
}

}  // namespace
}  // namespace throng::archive_test
