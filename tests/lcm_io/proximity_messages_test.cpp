// Proximity rows are sent bit for bit in as many messages as needed.
#include <gtest/gtest.h>

#include <cmath>

#include "lcm_io/codec/run_reader.h"
#include "synthetic_run.h"

namespace throng::proximity_messages_test {
namespace {

std::vector<ProximityPair> some_rows(size_t count) {
  std::vector<ProximityPair> rows(count);
  for (size_t i = 0; i < count; ++i) {
    ProximityPair& row = rows[i];
    const auto number = static_cast<uint32_t>(i);
    row.pair = PairKey(number / 200 % 10, 10 + number / 400 % 9, number % 14, number / 14 % 15);
    row.lo_m = 0.001f * static_cast<float>(number);
    row.hi_m = row.lo_m + 0.0005f;
    if (i % 3 == 0) continue;
    row.level = PairLevel::kTriangles;
    row.point_a_m = {1e5 + 0.125 * number, -2.5, 1};
    row.point_b_m = {1e5 + 0.25 * number, -2.25, 1.5};
    row.normal = {0.6f, 0, 0.8f};
    row.depth_m = 0.01f;
    if (i % 2 == 0) row.closing_speed_mps = -0.5f;
  }
  return rows;
}

bool same(const ProximityPair& a, const ProximityPair& b) {
  // NaN equals itself here.
  const auto bits = [](const ProximityPair& r) {
    std::vector<double> all = {static_cast<double>(r.lo_m), static_cast<double>(r.hi_m),
                               static_cast<double>(r.depth_m),
                               static_cast<double>(r.closing_speed_mps)};
    all.insert(all.end(), r.point_a_m.begin(), r.point_a_m.end());
    all.insert(all.end(), r.point_b_m.begin(), r.point_b_m.end());
    for (const float x : r.normal) all.push_back(static_cast<double>(x));
    for (double& x : all)
      if (std::isnan(x)) x = -1e300;
    return all;
  };
  return a.pair == b.pair && a.level == b.level && bits(a) == bits(b);
}

TEST(ProximityMessages, PreserveEveryRowBitForBit) {
  SyntheticRun run({.avatars = 20});
  RunInfo info = run.info();
  info.culler.proximity = {0.3f, 1.0f, 0.1};
  for (const size_t count : {0, 1, 700, 3000}) {
    const std::vector<ProximityPair> parts = some_rows(count), closest_parts = some_rows(count / 2);
    Frame frame = run.step();
    frame.proximity_pairs = parts;
    frame.closest_parts = closest_parts;
    MessageList list;
    RunEncoder encoder({}, list);
    encoder.begin(info);
    encoder.frame(info, frame);
    RunReader reader;
    int messages = 0, updates = 0;
    for (const auto& m : list.messages) {
      ASSERT_LE(m.bytes.size(), kMaxMessageBytes);
      messages += m.channel == Channel::kProximity;
      const RunReader::Update update = reader.take(name_of(m.channel), m.bytes);
      ASSERT_NE(update, RunReader::Update::kRejected) << reader.rejection();
      updates += update == RunReader::Update::kProximity;
    }
    EXPECT_EQ(updates, 1);
    EXPECT_EQ(messages, count < 500 ? 1 : count < 1000 ? 2 : 7) << "680 rows per message";
    ASSERT_EQ(reader.proximity_pairs().size(), parts.size());
    ASSERT_EQ(reader.closest_parts().size(), closest_parts.size());
    for (size_t i = 0; i < parts.size(); ++i)
      ASSERT_TRUE(same(reader.proximity_pairs()[i], parts[i])) << i;
    for (size_t i = 0; i < closest_parts.size(); ++i)
      ASSERT_TRUE(same(reader.closest_parts()[i], closest_parts[i])) << i;
  }
}

TEST(ProximityMessages, AreRejectedWithInvalidDistances) {
  proximity_t m{};
  m.schema = kSchema;
  m.chunk_count = 1;
  m.count = 1;
  m.kind = {0};
  m.a = {1};
  m.b = {2};
  m.part_a = m.part_b = {0};
  m.level = {3};
  for (auto* column : {&m.distance_lo_m, &m.distance_hi_m, &m.normal_x, &m.normal_y, &m.normal_z,
                       &m.depth_m, &m.closing_speed_mps})
    column->assign(1, 0.5f);
  for (auto* column : {&m.point_a_x_m, &m.point_a_y_m, &m.point_a_z_m, &m.point_b_x_m,
                       &m.point_b_y_m, &m.point_b_z_m})
    column->assign(1, 0);
  const auto defect = [&] {
    std::vector<uint8_t> bytes(static_cast<size_t>(m.getEncodedSize()));
    m.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    proximity_t out;
    return decode(bytes, out);
  };
  EXPECT_EQ(defect(), "");
  for (const auto& [lo, hi] : {std::pair(0.5f, 0.4f), std::pair(-1.0f, 1.0f), std::pair(NAN, 1.0f),
                               std::pair(0.0f, NAN)}) {
    m.distance_lo_m = {lo};
    m.distance_hi_m = {hi};
    EXPECT_NE(defect(), "") << lo << " " << hi;
  }
  m.distance_lo_m = {0};
  m.distance_hi_m = {1};
  m.kind = {2};
  EXPECT_NE(defect(), "");
}

}  // namespace
}  // namespace throng::proximity_messages_test
