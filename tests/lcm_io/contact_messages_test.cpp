// Contact points are sent bit for bit in as many messages as needed, and checked in the log.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "culled_again.h"
#include "lcm_io/codec/rows.h"
#include "lcm_io/codec/run_reader.h"
#include "lcm_io/log/log_check.h"
#include "lcm_io/log/log_reader.h"
#include "synthetic_run.h"
#include "tests/same_bits.h"

namespace throng::contact_messages_test {
namespace {

using Rows = std::vector<ContactPoint>;

Rows some_rows(size_t count) {
  Rows rows(count);
  for (size_t i = 0; i < count; ++i) {
    const auto number = static_cast<uint32_t>(i);
    rows[i] = {PairKey(number / 200 % 10, 10 + number / 400 % 9, number % 14, number / 14 % 15),
               {1e5 + 0.125 * number, -2.5, i % 7 == 0 ? ProximityPair::kNoPosition : 1.5},
               {0.6f, 0, 0.8f},
               0.001f * static_cast<float>(number)};
  }
  return rows;
}

TEST(ContactPointMessages, PreserveEveryRowBitForBit) {
  SyntheticRun run({.avatars = 20});
  RunInfo info = run.info();
  info.culler.proximity = {0, 0, 0.1, true};
  for (const size_t count : {0, 1, 1198, 1199, 5000}) {
    SCOPED_TRACE(testing::Message() << count << " rows");
    const Rows rows = some_rows(count);
    Frame frame = run.step();
    frame.contact_points = rows;
    MessageList list;
    RunEncoder encoder({}, list);
    encoder.begin(info);
    encoder.frame(info, frame);
    RunReader reader;
    size_t messages = 0;
    int updates = 0;
    for (const auto& m : list.messages) {
      EXPECT_NE(m.channel, Channel::kProximity) << "no margin";
      ASSERT_LE(m.bytes.size(), kMaxMessageBytes);
      messages += m.channel == Channel::kContactPoints;
      const RunReader::Update update = reader.take(name_of(m.channel), m.bytes);
      ASSERT_NE(update, RunReader::Update::kRejected) << reader.rejection();
      updates += update == RunReader::Update::kContactPoints;
      reader.take(name_of(m.channel), m.bytes);  // the network may repeat a datagram
    }
    EXPECT_EQ(updates, 1);
    EXPECT_EQ(messages, std::max<size_t>(1, (count + 1197) / 1198));
    EXPECT_TRUE(same_bits<ContactPoint>(reader.contact_points(), rows));
  }
}

TEST(ContactPointMessages, AreRejectedWhenInvalid) {
  contact_points_t m{};
  m.schema = kSchema;
  m.chunk_count = 1;
  const ContactPoint sound{PairKey(1, 2, 3, 4), {1, 2, 3}, {0, 0, 1}, 0.1f};
  const auto defect = [&] {
    std::vector<uint8_t> bytes(static_cast<size_t>(m.getEncodedSize()));
    m.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    contact_points_t out;
    return decode(bytes, out);
  };
  const auto begin = [&] { set_contacts(m, {&sound, 1}); };
  begin();
  EXPECT_EQ(defect(), "");
  for (const float depth_m : {-1.0f, NAN}) {
    begin();
    m.depth_m = {depth_m};
    EXPECT_NE(defect(), "") << depth_m;
  }
  begin();
  m.b = m.a;
  EXPECT_NE(defect(), "");
  begin();
  m.part_a = {kWholeBody};
  EXPECT_NE(defect(), "");
}

using ByFrame = std::map<int64_t, Rows>;

ByFrame logged_points(Simulation& simulation, int frames, const std::filesystem::path& log) {
  ByFrame out;
  LogSink sink(log, {});
  sink.begin(simulation.info());
  for (int i = 0; i < frames; ++i) {
    const Frame& frame = simulation.step();
    sink.frame(simulation.info(), frame);
    out[frame.number] = {frame.contact_points.begin(), frame.contact_points.end()};
    EXPECT_EQ(frame.contact_points.size(), frame.pairs.size());
  }
  sink.end(simulation.info(), simulation.finish());
  return out;
}

ByFrame read_points(const std::filesystem::path& log) {
  ByFrame out;
  LogReader reader(log);
  RunReader run;
  LogEvent event;
  while (reader.next(event) == LogReader::Status::kEvent)
    if (run.take(event.channel, event.data) == RunReader::Update::kContactPoints)
      out[run.header()->frame] = {run.contact_points().begin(), run.contact_points().end()};
  return out;
}

TEST(ContactPointMessages, SurviveLoggingAndCullingOfTheLog) {
  constexpr int kFrames = 60;
  const ScratchFile log, again_log;
  Scene scene = small_scene("robot_in_crowd", 2, 160);
  scene.contact_points = true;
  Simulation simulation(scene, {});
  const ByFrame expected = logged_points(simulation, kFrames, log.path());
  size_t rows = 0;
  for (const auto& [frame, points] : expected) rows += points.size();
  EXPECT_GT(rows, 100u);
  const ByFrame found = read_points(log.path());
  ASSERT_EQ(found.size(), static_cast<size_t>(kFrames)) << "also for frames without contacts";
  for (const auto& [frame, points] : expected)
    ASSERT_TRUE(same_bits<ContactPoint>(found.at(frame), points)) << "frame " << frame;
  const LogReport report = check_log(log.path());
  EXPECT_TRUE(report.is_sound());
  EXPECT_EQ(report.channels[static_cast<size_t>(Channel::kContactPoints)].messages, kFrames);
  EXPECT_EQ(report.channels[static_cast<size_t>(Channel::kProximity)].messages, 0);

  LogRun recorded = read_log_run(log.path());
  recorded.scene.contact_points = true;
  Simulation again(recorded.scene, options_of(recorded));
  const ByFrame culled = logged_points(again, kFrames, again_log.path());
  EXPECT_TRUE(check_log(again_log.path()).is_sound());
  size_t shared = 0;
  for (const auto& [frame, points] : culled)
    for (const ContactPoint& point : points) {
      const Rows& then = expected.at(frame);
      const auto same_pair = [&](const ContactPoint& p) { return p.pair == point.pair; };
      const auto known = std::find_if(then.begin(), then.end(), same_pair);
      if (known == then.end()) continue;
      ++shared;
      ASSERT_NEAR(known->depth_m, point.depth_m, 2e-3) << "states are quantised: 1 mm, and 1 mm";
    }
  EXPECT_GT(shared, rows * 9 / 10);
}

TEST(ContactPointMessages, AreReportedWhenDamaged) {
  const ScratchFile log;
  SyntheticRun run({.proximity = true});
  LogSink sink(log.path(), {});
  run.play(sink, 30);
  ASSERT_TRUE(check_log(log.path()).is_sound());
  auto bytes = bytes_of(log.path());
  const std::string name = "THRONG_CONTACT_POINTS";
  const auto at = std::search(bytes.begin() + static_cast<std::ptrdiff_t>(bytes.size() / 2),
                              bytes.end(), name.begin(), name.end());
  ASSERT_NE(at, bytes.end());
  *(at + static_cast<std::ptrdiff_t>(name.size() + kHeaderBytes + 40)) ^= 1;
  write_bytes(log.path(), bytes);
  const LogReport report = check_log(log.path());
  EXPECT_FALSE(report.is_sound());
  ASSERT_FALSE(report.problems.empty());
  EXPECT_NE(report.problems[0].find("THRONG_CONTACT_POINTS"), std::string::npos)
      << report.problems[0];
}

}  // namespace
}  // namespace throng::contact_messages_test
