// Tests that a page gets all changes of the contacts, in order, once and byte by byte.
#include "viewer/server/pair_history.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "tests/viewer/contacts_message.h"

namespace throng::pair_history_test {
namespace {

using Kind = PairBegins::ChangeKind;

constexpr size_t kAll = 1'000'000;

/// Two changes per frame, told apart by their bodies.
std::vector<PairBegins::Change> changes_until(int64_t frames) {
  std::vector<PairBegins::Change> changes;
  for (int64_t frame = 0; frame < frames; ++frame)
    for (uint32_t i = 0; i < 2; ++i) {
      const auto number = static_cast<uint32_t>(2 * frame) + i;
      changes.push_back({{number, number + 1, i, kWholeBody}, Kind::kBegan, frame, frame});
    }
  return changes;
}

std::vector<uint32_t> first_bodies(const ContactsMessage& message) {
  std::vector<uint32_t> bodies;
  for (const ContactRecord& record : message.records) bodies.push_back(record.a);
  return bodies;
}

TEST(PairHistory, WritesChangesLittleEndian) {
  PairHistory history;
  history.add(std::vector<PairBegins::Change>{
      {{0x010203, 0x040506, 7, 8}, Kind::kBegan, 0x11223344, 0x11223344, {2, -1}},
      {{1, 2, 3, kWholeBody}, Kind::kEnded, 9, began_before(5)},
      {{1, 2, kWholeBody, 4}, Kind::kLost, 10, 6}});
  history.complete(10);
  const Bytes expected = {
      0x54, 0x54, 0x43, 0x31, 3,    0,    0,    0,                     // "TTC1", count
      0,    0,    0,    0,    0,    0,    0,    0,                     // first 0.0
      0,    0,    0,    0,    0,    0,    0x08, 0x40,                  // known 3.0
      0,    0,    0,    0,    0,    0,    0x24, 0x40,                  // frame 10.0
      0x44, 0x33, 0x22, 0x11, 0x44, 0x33, 0x22, 0x11,                  // frame, began
      0x03, 0x02, 0x01, 0,    0x06, 0x05, 0x04, 0,    7,   8,   0, 0,  // a, b, parts, began
      0,    0,    0,    0x40, 0,    0,    0x80, 0xbf,                  // place 2.0, -1.0
      9,    0,    0,    0,    0xfa, 0xff, 0xff, 0xff,                  // began before frame 5: ~5
      1,    0,    0,    0,    2,    0,    0,    0,    3,   255, 1, 0,  // ended
      0,    0,    0xc0, 0x7f, 0,    0,    0xc0, 0x7f,                  // no place
      10,   0,    0,    0,    6,    0,    0,    0,                     //
      1,    0,    0,    0,    2,    0,    0,    0,    255, 4,   2, 0,  // lost
      0,    0,    0xc0, 0x7f, 0,    0,    0xc0, 0x7f,                  // no place
  };
  EXPECT_EQ(history.changes_from(0, 0, kAll), expected);
}

TEST(PairHistory, GivesAllChangesInPieces) {
  const std::vector<PairBegins::Change> changes = changes_until(50);
  PairHistory history;
  history.add(changes);
  history.complete(49);
  std::vector<uint32_t> bodies;
  for (uint64_t next = 0; next < changes.size();) {
    const ContactsMessage piece = contacts_of(history.changes_from(next, 0, 7));
    ASSERT_EQ(piece.head.first, static_cast<double>(next));
    ASSERT_EQ(piece.head.known, 100);
    ASSERT_EQ(piece.head.frame, 49);
    ASSERT_EQ(piece.records.size(), std::min<size_t>(7, changes.size() - next));
    for (const uint32_t body : first_bodies(piece)) bodies.push_back(body);
    next += piece.records.size();
  }
  ASSERT_EQ(bodies.size(), changes.size());
  for (uint32_t i = 0; i < bodies.size(); ++i) ASSERT_EQ(bodies[i], i);
}

TEST(PairHistory, HasNoChangesBeyondTheKnown) {
  PairHistory history;
  ContactsMessage none = contacts_of(history.changes_from(0, 0, kAll));
  EXPECT_TRUE(none.records.empty());
  EXPECT_EQ(none.head.known, 0);
  EXPECT_EQ(none.head.frame, -1);
  history.add(changes_until(5));
  for (const uint64_t first : {uint64_t{10}, uint64_t{11}, uint64_t{1} << 53}) {
    none = contacts_of(history.changes_from(first, 0, kAll));
    EXPECT_TRUE(none.records.empty());
    EXPECT_EQ(none.head.first, 10);
    EXPECT_EQ(none.head.known, 10);
  }
}

TEST(PairHistory, SkipsChangesBeforeAFrame) {
  PairHistory history;
  history.add(changes_until(10));
  const ContactsMessage late = contacts_of(history.changes_from(0, 8, kAll));
  EXPECT_EQ(late.head.first, 16);
  EXPECT_EQ(first_bodies(late), (std::vector<uint32_t>{16, 17, 18, 19}));
  // The sequence number lies further on than the frame.
  EXPECT_EQ(first_bodies(contacts_of(history.changes_from(19, 8, kAll))),
            (std::vector<uint32_t>{19}));
  const ContactsMessage none = contacts_of(history.changes_from(0, 10, kAll));
  EXPECT_TRUE(none.records.empty());
  EXPECT_EQ(none.head.first, 20);
}

TEST(PairHistory, StartsAtTheOldestChangeLeft) {
  PairHistory history(6);
  history.add(changes_until(10));
  for (const uint64_t first : {0u, 13u, 14u}) {
    const ContactsMessage left = contacts_of(history.changes_from(first, 0, kAll));
    EXPECT_EQ(left.head.first, 14);
    EXPECT_EQ(left.head.known, 20);
    EXPECT_EQ(first_bodies(left), (std::vector<uint32_t>{14, 15, 16, 17, 18, 19}));
  }
  EXPECT_EQ(contacts_of(history.changes_from(17, 0, kAll)).head.first, 17);
  EXPECT_EQ(contacts_of(history.changes_from(0, 9, kAll)).head.first, 18);
}

TEST(PairHistory, NumbersANewRunFromZero) {
  PairHistory history(6);
  history.add(changes_until(10));
  history.complete(9);
  history.clear();
  EXPECT_EQ(contacts_of(history.changes_from(0, 0, kAll)).head.frame, -1);
  history.add(changes_until(1));
  const ContactsMessage message = contacts_of(history.changes_from(0, 0, kAll));
  EXPECT_EQ(message.head.first, 0);
  EXPECT_EQ(message.head.known, 2);
}

TEST(PairHistory, SaturatesDamagedFrames) {
  PairHistory history;
  history.add(std::vector<PairBegins::Change>{
      {{1, 2, 0, 0}, Kind::kEnded, int64_t{1} << 53, began_before(int64_t{1} << 53)}});
  const ContactsMessage message = contacts_of(history.changes_from(0, 0, kAll));
  ASSERT_EQ(message.records.size(), 1u);
  EXPECT_EQ(message.records[0].frame, INT32_MAX);
  EXPECT_EQ(message.records[0].began, INT32_MIN);
}

TEST(PairHistory, AnswersWhileChangesAreAdded) {
  const std::vector<PairBegins::Change> changes = changes_until(5000);
  PairHistory history;
  std::thread run([&] {
    for (size_t i = 0; i < changes.size(); i += 2) {
      history.add(std::span(changes).subspan(i, 2));
      history.complete(changes[i].frame);
    }
  });
  uint64_t next = 0;
  bool is_right = true;
  while (next < changes.size() && is_right) {
    const ContactsMessage piece = contacts_of(history.changes_from(next, 0, 100));
    is_right = piece.head.first == static_cast<double>(next) &&
               piece.head.known >= 2 * (piece.head.frame + 1);
    for (const ContactRecord& record : piece.records) is_right = is_right && record.a == next++;
  }
  run.join();
  EXPECT_TRUE(is_right) << "at " << next;
}

}  // namespace
}  // namespace throng::pair_history_test
