// Tests that requests of the page are read, and that any other text is an empty query.
#include "viewer/server/view_query.h"

#include <gtest/gtest.h>

#include <string>

#include "base/random.h"

namespace throng::view_query_test {
namespace {

bool is_empty(const ViewQuery& query) {
  return !query.frame && !query.person && !query.index && !query.contacts && !query.since &&
         !query.proximity && !query.positions;
}

TEST(ViewQuery, ReadsRequests) {
  EXPECT_EQ(parse_view_query(R"({"frame": 7})").frame, 7);
  EXPECT_TRUE(parse_view_query(R"({"index": true})").index);
  const ViewQuery history = parse_view_query(R"({"history": 3, "frame": 9})");
  EXPECT_EQ(history.person, 3u);
  EXPECT_EQ(history.frame, 9);
  const ViewQuery all = parse_view_query(R"({"contacts": 0})");
  EXPECT_EQ(all.contacts, 0u);
  EXPECT_FALSE(all.since || all.frame || all.person || all.index);
  const ViewQuery rest = parse_view_query(R"({"contacts": 5000000000, "since": 120})");
  EXPECT_EQ(rest.contacts, 5'000'000'000u);
  EXPECT_EQ(rest.since, 120);
  const ViewQuery near = parse_view_query(R"({"proximity": 4, "since": 60})");
  EXPECT_EQ(near.proximity, 4u);
  EXPECT_EQ(near.since, 60);
  const ViewQuery places = parse_view_query(R"({"positions": 30, "to": 90, "every": 6})");
  EXPECT_EQ(places.positions, 30);
  EXPECT_EQ(places.to, 90);
  EXPECT_EQ(places.every, 6);
  EXPECT_EQ(parse_view_query(R"({"positions": 30, "every": 0})").every, 1);
}

TEST(ViewQuery, RejectsMalformedRequests) {
  for (const char* text : {"",
                           "contacts",
                           "[0]",
                           "{",
                           R"({"contacts"})",
                           R"({"contacts": -1})",
                           R"({"contacts": 1.5})",
                           R"({"contacts": "0"})",
                           R"({"contacts": null})",
                           R"({"contacts": [0]})",
                           R"({"contacts": 18446744073709551615})",
                           R"({"contacts": 1e300})",
                           R"({"contacts": 9007199254740993})",
                           R"({"contacts": 0, "since": -1})",
                           R"({"contacts": 0, "since": "5"})",
                           R"({"contacts": 0, "since": 0.5})",
                           R"({"contacts": 0, "since": 1099511627777})",
                           R"({"proximity": -1})",
                           R"({"positions": -1})",
                           R"({"proximity": 4294967296})",
                           R"({"proximity": 4, "since": "5"})"})
    EXPECT_TRUE(is_empty(parse_view_query(text))) << text;
}

TEST(ViewQuery, SurvivesDamagedText) {
  const std::string sound = R"({"contacts": 1234567, "since": 890, "history": 3, "frame": 9})";
  for (uint64_t i = 0; i < 20'000; ++i) {
    const RandomKey key{.seed = 21, .id = i};
    std::string text = sound;
    for (uint32_t change = 0; change < 1 + random_bits(key, 0) % 3; ++change)
      text[random_bits(key, 10 + change) % text.size()] =
          static_cast<char>(random_bits(key, 20 + change));
    const ViewQuery query = parse_view_query(text);
    EXPECT_LE(query.contacts.value_or(0), uint64_t{1} << 53) << text;
    EXPECT_GE(query.since.value_or(0), 0) << text;
  }
}

}  // namespace
}  // namespace throng::view_query_test
