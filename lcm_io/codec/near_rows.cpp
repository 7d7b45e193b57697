#include "lcm_io/codec/near_rows.h"

#include <algorithm>

#include "lcm_io/codec/pair_columns.h"

namespace throng {
namespace {

/// A message of so many rows, to be set.
void begin_near(near_t& m, const NearOptions& asked, uint64_t hash, size_t count) {
  m.near_m = asked.near_m;
  m.person_near_m = asked.body_near_m;
  m.hash = static_cast<int64_t>(hash);
  resize_pairs(m, count);
  m.of.resize(count);
  for (auto* column :
       {&m.lo_m, &m.hi_m, &m.normal_x, &m.normal_y, &m.normal_z, &m.depth_m, &m.closing_mps})
    column->resize(count);
  for (auto* column : {&m.a_x_m, &m.a_y_m, &m.a_z_m, &m.b_x_m, &m.b_y_m, &m.b_z_m})
    column->resize(count);
}

/// `of_people`: the nearest parts of two people, not a pair within near_m.
void set_near(near_t& m, size_t i, const NearPair& row, bool of_people) {
  set_pair(m, i, row.pair, static_cast<uint8_t>(row.level));
  m.of[i] = of_people ? 1 : 0;
  m.lo_m[i] = row.lo_m;
  m.hi_m[i] = row.hi_m;
  m.a_x_m[i] = row.point_a_m[0];
  m.a_y_m[i] = row.point_a_m[1];
  m.a_z_m[i] = row.point_a_m[2];
  m.b_x_m[i] = row.point_b_m[0];
  m.b_y_m[i] = row.point_b_m[1];
  m.b_z_m[i] = row.point_b_m[2];
  m.normal_x[i] = row.normal[0];
  m.normal_y[i] = row.normal[1];
  m.normal_z[i] = row.normal[2];
  m.depth_m[i] = row.depth_m;
  m.closing_mps[i] = row.closing_mps;
}

}  // namespace

void set_near_chunk(near_t& m, const NearOptions& asked, uint64_t hash, const NearRows& parts,
                    const NearRows& people, size_t first) {
  const size_t count = std::min(kNearPerMessage, parts.size() + people.size() - first);
  begin_near(m, asked, hash, count);
  for (size_t i = 0; i < count; ++i) {
    const size_t row = first + i;
    const bool of_people = row >= parts.size();
    set_near(m, i, of_people ? people[row - parts.size()] : parts[row], of_people);
  }
}

NearPair near_at(const near_t& m, size_t i) {
  NearPair row;
  row.pair = pair_at(m, i);
  row.level = static_cast<PairLevel>(m.level[i]);
  row.lo_m = m.lo_m[i];
  row.hi_m = m.hi_m[i];
  row.point_a_m = {m.a_x_m[i], m.a_y_m[i], m.a_z_m[i]};
  row.point_b_m = {m.b_x_m[i], m.b_y_m[i], m.b_z_m[i]};
  row.normal = {m.normal_x[i], m.normal_y[i], m.normal_z[i]};
  row.depth_m = m.depth_m[i];
  row.closing_mps = m.closing_mps[i];
  return row;
}

}  // namespace throng
