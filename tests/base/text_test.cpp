// Names and text from files: valid text is UTF-8 without terminal control sequences, other bytes
// are escaped.
#include "base/text.h"

#include <gtest/gtest.h>

#include "base/limits.h"
#include "base/random.h"

namespace throng::text_test {
namespace {

TEST(Names, AreShortPrintableUtf8) {
  for (const std::string& name :
       {std::string("hall 3"), std::string("caf\xc3\xa9"), std::string("\xe6\x97\xa5\xe6\x9c\xac"),
        std::string("\xf0\x9f\xa4\x96"), std::string("\"quoted\" \\ 'so'"),
        std::string(kMaxNameBytes, 'x')})
    EXPECT_EQ(defect_of_name(name), "") << name;
  EXPECT_EQ(defect_of_name(""), "an empty one");
  EXPECT_EQ(defect_of_name(" \t"), "an empty one");
  EXPECT_EQ(defect_of_name(std::string(121, 'x')), "one of 121 bytes, more than 120");
  EXPECT_EQ(defect_of_name(std::string("a\0b", 3)), "one with a control character: 'a\\x00b'");
  EXPECT_EQ(defect_of_name("a\nb"), "one with a control character: 'a\\x0ab'");
  EXPECT_EQ(defect_of_name("\x1b[31m"), "one with a control character: '\\x1b[31m'");
  EXPECT_EQ(defect_of_name("a\xc2\x85"), "one with a control character: 'a\\xc2\\x85'");
  EXPECT_EQ(defect_of_name("a\xff"), "one with bytes that are no UTF-8: 'a\\xff'");
}

TEST(Text, EscapesAnyBytes) {
  // Truncated characters, surrogates, overlong forms, code points beyond the last one.
  for (const char* bytes : {"\xc3", "\xe6\x97", "\xed\xa0\x80", "\xc0\xaf", "\xe0\x80\xaf",
                            "\xf4\x90\x80\x80", "\xf8", "\x80"}) {
    EXPECT_EQ(find_invalid_utf8(bytes), 0u);
    EXPECT_EQ(printable_character(bytes), 0u);
  }
  for (uint64_t seed = 1; seed <= 20'000; ++seed) {
    std::string text;
    const RandomKey key{seed, 0, 0, Purpose::kBoxWorld};
    const uint64_t length = 1 + random_bits(key, 0) % 60;
    for (uint64_t i = 0; i < length; ++i)
      text += static_cast<char>(random_bits(key, static_cast<uint32_t>(i + 1)));
    const std::string fit = escaped(text), name = name_after(text);
    ASSERT_EQ(find_invalid_utf8(fit), std::string::npos) << "seed " << seed;
    ASSERT_LE(name.size(), kMaxNameBytes) << "seed " << seed;
    if (text.find_first_not_of(" \t\r\n") != std::string::npos) {
      ASSERT_EQ(defect_of_name(name), "") << "seed " << seed;
    }
    ASSERT_EQ(escaped(fit), fit) << "escaping twice changes nothing, seed " << seed;
  }
}

TEST(Text, MakesReadableNames) {
  for (const auto& [name, shown] : std::vector<std::pair<std::string, std::string>>{
           {"upperRightLeg", "upper right leg"},
           {"RightHand", "right hand"},
           {"left_hip_pitch_link", "left hip pitch link"},
           {"left__Hand_", "left hand"},
           {"wrist3Link", "wrist3 link"},
           {"URDFLink", "urdf link"},
           {"LElbow", "l elbow"},
           {"whole body", "whole body"},
           {"torso", "torso"},
           {"_", "_"},
           {"", ""}}) {
    EXPECT_EQ(display_name(name), shown);
    EXPECT_EQ(display_name(display_name(name)), shown) << "applied twice";
  }
}

TEST(Text, UsesTheSingularForOne) {
  EXPECT_EQ(counted(0, "pair"), "0 pairs");
  EXPECT_EQ(counted(1, "pair"), "1 pair");
  EXPECT_EQ(counted(size_t{2}, "pair"), "2 pairs");
  EXPECT_EQ(counted(1, "person", "people"), "1 person");
  EXPECT_EQ(counted(uint64_t{1} << 60, "byte"), "1152921504606846976 bytes");
}

TEST(Text, SplitsIntoOnePieceMoreThanSeparators) {
  using Pieces = std::vector<std::string>;
  EXPECT_EQ(split_text("", ','), Pieces({""}));
  EXPECT_EQ(split_text("a", ','), Pieces({"a"}));
  EXPECT_EQ(split_text("a,,b,", ','), Pieces({"a", "", "b", ""}));
}

}  // namespace
}  // namespace throng::text_test
