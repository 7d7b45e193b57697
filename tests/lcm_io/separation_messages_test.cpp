// Separation shortfalls are sent bit for bit, every begin with its end, and only on request.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "lcm_io/codec/run_reader.h"
#include "synthetic_run.h"

namespace throng::separation_messages_test {
namespace {

using Key = std::tuple<uint32_t, uint32_t, BodyRegion>;

auto all_of(const Shortfall& s) {
  return std::tuple(s.robot, s.person, s.region, s.begin_frame, s.min_distance_lo_m,
                    s.min_distance_hi_m, s.max_shortfall_m, s.is_truncated, s.is_beyond_margin);
}

TEST(SeparationMessages, CarryTheShortfallsOfTheMonitor) {
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    SyntheticRun run({.avatars = 20, .seed = seed, .proximity = true});
    SeparationMonitor monitor(run.info());
    MessageList list;
    RunEncoder encoder({}, list);
    RunReader reader;
    std::map<Key, int> open;
    size_t taken = 0, begins = 0, ends = 0;
    const auto compare = [&] {
      std::vector<ShortfallEvent> received;
      for (; taken < list.messages.size(); ++taken) {
        const auto& m = list.messages[taken];
        const RunReader::Update update = reader.take(name_of(m.channel), m.bytes);
        ASSERT_NE(update, RunReader::Update::kRejected) << reader.rejection();
        if (update == RunReader::Update::kSeparation)
          received.insert(received.end(), reader.new_shortfalls().begin(),
                          reader.new_shortfalls().end());
      }
      ASSERT_EQ(received.size(), monitor.begun().size() + monitor.ended().size());
      for (size_t i = 0; i < received.size(); ++i) {
        const bool is_begin = i < monitor.begun().size();
        const Shortfall& row = received[i].shortfall;
        EXPECT_EQ(received[i].kind, is_begin ? EventKind::kBegin : EventKind::kEnd);
        EXPECT_EQ(all_of(row), all_of(is_begin ? monitor.begun()[i]
                                               : monitor.ended()[i - monitor.begun().size()]));
        open[{row.robot, row.person, row.region}] += is_begin ? 1 : -1;
        ++(is_begin ? begins : ends);
      }
    };
    encoder.begin(run.info());
    for (int i = 0; i < 30; ++i) {
      const Frame& frame = run.step();
      encoder.frame(run.info(), frame);
      monitor.frame(run.info(), frame);
      compare();
      if (HasFatalFailure()) return;
    }
    encoder.end(run.info(), run.finish());
    monitor.end();
    compare();
    EXPECT_GT(begins, 20u);
    EXPECT_EQ(begins, ends);
    for (const auto& [key, count] : open) EXPECT_EQ(count, 0);
  }
}

TEST(SeparationMessages, AreRejectedWhenInvalid) {
  separation_t m{};
  m.schema = kSchema;
  m.chunk_count = 1;
  m.frame = 5;
  Shortfall row;
  row.robot = 1;
  row.person = 2;
  row.begin_frame = 5;
  row.min_distance_lo_m = 0.1f;
  row.min_distance_hi_m = 0.2f;
  const auto defect = [&](const Shortfall& shortfall) {
    begin_separation(m, 1);
    set_shortfall(m, 0, EventKind::kBegin, shortfall);
    std::vector<uint8_t> bytes(static_cast<size_t>(m.getEncodedSize()));
    m.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    separation_t out;
    return decode(bytes, out);
  };
  EXPECT_EQ(defect(row), "");
  const auto rejected = [&](auto member, auto value) {
    Shortfall other = row;
    other.*member = value;
    return !defect(other).empty();
  };
  EXPECT_TRUE(rejected(&Shortfall::begin_frame, int64_t{6}));
  EXPECT_TRUE(rejected(&Shortfall::begin_frame, int64_t{-1}));
  EXPECT_TRUE(rejected(&Shortfall::robot, 2u));
  EXPECT_TRUE(rejected(&Shortfall::min_distance_lo_m, 0.3f));
  EXPECT_TRUE(rejected(&Shortfall::min_distance_lo_m, NAN));
  EXPECT_TRUE(rejected(&Shortfall::max_shortfall_m, -1.f));
  EXPECT_TRUE(rejected(&Shortfall::region, static_cast<BodyRegion>(9)));
}

}  // namespace
}  // namespace throng::separation_messages_test
