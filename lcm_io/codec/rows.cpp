#include "lcm_io/codec/rows.h"

#include <algorithm>

namespace throng {
namespace {

void begin_proximity(proximity_t& m, const ProximityOptions& options, uint64_t hash, size_t count) {
  m.margin_m = options.margin_m;
  m.closest_margin_m = options.closest_margin_m;
  m.hash = static_cast<int64_t>(hash);
  resize_pairs(m, count);
  m.kind.resize(count);
  for (auto* column : {&m.distance_lo_m, &m.distance_hi_m, &m.normal_x, &m.normal_y, &m.normal_z,
                       &m.depth_m, &m.closing_speed_mps})
    column->resize(count);
  for (auto* column : {&m.point_a_x_m, &m.point_a_y_m, &m.point_a_z_m, &m.point_b_x_m,
                       &m.point_b_y_m, &m.point_b_z_m})
    column->resize(count);
}

/// `is_closest`: the closest parts of two avatars, not a pair within proximity_m.
void set_proximity(proximity_t& m, size_t i, const ProximityPair& row, bool is_closest) {
  set_pair(m, i, row.pair, static_cast<uint8_t>(row.level));
  m.kind[i] = is_closest ? 1 : 0;
  m.distance_lo_m[i] = row.lo_m;
  m.distance_hi_m[i] = row.hi_m;
  m.point_a_x_m[i] = row.point_a_m[0];
  m.point_a_y_m[i] = row.point_a_m[1];
  m.point_a_z_m[i] = row.point_a_m[2];
  m.point_b_x_m[i] = row.point_b_m[0];
  m.point_b_y_m[i] = row.point_b_m[1];
  m.point_b_z_m[i] = row.point_b_m[2];
  m.normal_x[i] = row.normal[0];
  m.normal_y[i] = row.normal[1];
  m.normal_z[i] = row.normal[2];
  m.depth_m[i] = row.depth_m;
  m.closing_speed_mps[i] = row.closing_speed_mps;
}

}  // namespace

void set_events(events_t& m, std::span<const PairEvent> events) {
  resize_pairs(m, events.size());
  m.kind.resize(events.size());
  for (size_t i = 0; i < events.size(); ++i) {
    set_pair(m, i, events[i].pair, static_cast<uint8_t>(events[i].level));
    m.kind[i] = static_cast<uint8_t>(events[i].kind);
  }
}

void set_proximity_chunk(proximity_t& m, const ProximityOptions& options, uint64_t hash,
                         const ProximityRows& parts, const ProximityRows& closest_parts,
                         size_t first) {
  const size_t count =
      std::min(kRowsPerMessage<proximity_t>, parts.size() + closest_parts.size() - first);
  begin_proximity(m, options, hash, count);
  for (size_t i = 0; i < count; ++i) {
    const size_t row = first + i;
    const bool is_closest = row >= parts.size();
    set_proximity(m, i, is_closest ? closest_parts[row - parts.size()] : parts[row], is_closest);
  }
}

ProximityPair proximity_at(const proximity_t& m, size_t i) {
  ProximityPair row;
  row.pair = pair_at(m, i);
  row.level = static_cast<PairLevel>(m.level[i]);
  row.lo_m = m.distance_lo_m[i];
  row.hi_m = m.distance_hi_m[i];
  row.point_a_m = {m.point_a_x_m[i], m.point_a_y_m[i], m.point_a_z_m[i]};
  row.point_b_m = {m.point_b_x_m[i], m.point_b_y_m[i], m.point_b_z_m[i]};
  row.normal = {m.normal_x[i], m.normal_y[i], m.normal_z[i]};
  row.depth_m = m.depth_m[i];
  row.closing_speed_mps = m.closing_speed_mps[i];
  return row;
}

void set_contacts(contact_points_t& m, std::span<const ContactPoint> rows) {
  resize_pairs(m, rows.size());
  for (auto* column : {&m.x_m, &m.y_m, &m.z_m}) column->resize(rows.size());
  for (auto* column : {&m.normal_x, &m.normal_y, &m.normal_z, &m.depth_m})
    column->resize(rows.size());
  for (size_t i = 0; i < rows.size(); ++i) {
    const ContactPoint& row = rows[i];
    set_pair(m, i, row.pair);
    m.x_m[i] = row.point_m[0];
    m.y_m[i] = row.point_m[1];
    m.z_m[i] = row.point_m[2];
    m.normal_x[i] = row.normal[0];
    m.normal_y[i] = row.normal[1];
    m.normal_z[i] = row.normal[2];
    m.depth_m[i] = row.depth_m;
  }
}

ContactPoint contact_at(const contact_points_t& m, size_t i) {
  return {pair_at(m, i),
          {m.x_m[i], m.y_m[i], m.z_m[i]},
          {m.normal_x[i], m.normal_y[i], m.normal_z[i]},
          m.depth_m[i]};
}

void begin_separation(separation_t& m, size_t count) {
  m.count = static_cast<int32_t>(count);
  for (auto* column : {&m.kind, &m.region, &m.truncated, &m.beyond_margin}) column->resize(count);
  for (auto* column : {&m.robot, &m.person}) column->resize(count);
  for (auto* column : {&m.min_distance_lo_m, &m.min_distance_hi_m, &m.max_shortfall_m})
    column->resize(count);
  m.begin_frame.resize(count);
}

void set_shortfall(separation_t& m, size_t i, EventKind kind, const Shortfall& shortfall) {
  m.kind[i] = static_cast<uint8_t>(kind);
  m.robot[i] = static_cast<int32_t>(shortfall.robot);
  m.person[i] = static_cast<int32_t>(shortfall.person);
  m.region[i] = static_cast<uint8_t>(shortfall.region);
  m.begin_frame[i] = shortfall.begin_frame;
  m.min_distance_lo_m[i] = shortfall.min_distance_lo_m;
  m.min_distance_hi_m[i] = shortfall.min_distance_hi_m;
  m.max_shortfall_m[i] = shortfall.max_shortfall_m;
  m.truncated[i] = shortfall.is_truncated ? 1 : 0;
  m.beyond_margin[i] = shortfall.is_beyond_margin ? 1 : 0;
}

ShortfallEvent shortfall_at(const separation_t& m, size_t i) {
  ShortfallEvent event;
  event.kind = static_cast<EventKind>(m.kind[i]);
  Shortfall& shortfall = event.shortfall;
  shortfall.robot = static_cast<uint32_t>(m.robot[i]);
  shortfall.person = static_cast<uint32_t>(m.person[i]);
  shortfall.region = static_cast<BodyRegion>(m.region[i]);
  shortfall.begin_frame = m.begin_frame[i];
  shortfall.end_frame = event.kind == EventKind::kEnd ? m.frame : 0;
  shortfall.min_distance_lo_m = m.min_distance_lo_m[i];
  shortfall.min_distance_hi_m = m.min_distance_hi_m[i];
  shortfall.max_shortfall_m = m.max_shortfall_m[i];
  shortfall.is_truncated = m.truncated[i] != 0;
  shortfall.is_beyond_margin = m.beyond_margin[i] != 0;
  return event;
}

void set_change(crowd_change_t& m, const CrowdChange& change, size_t first, size_t count) {
  constexpr size_t kRow = 4 + 2 * 8 + 2 * 4;
  static_assert(kHeaderBytes + kMaxGoalBytes + kAgentsPerChange * kRow + 200 <= kMaxMessageBytes);
  m.kind = static_cast<int32_t>(change.kind);
  m.group = change.kind == CrowdChange::Kind::kAdd ? change.group : "";
  m.goal = change.goal;
  m.count = static_cast<int32_t>(count);
  for (auto* numbers : {&m.x_m, &m.y_m}) numbers->assign(count, 0);
  for (auto* numbers : {&m.heading_rad, &m.speed_mps}) numbers->assign(count, 0);
  m.avatar.resize(count);
  for (size_t i = 0; i < count; ++i) {
    m.avatar[i] = static_cast<int32_t>(change.ids[first + i]);
    if (change.kind == CrowdChange::Kind::kAdd) {
      const AgentEntry& entry = change.entries[first + i];
      m.x_m[i] = entry.position_m.x();
      m.y_m[i] = entry.position_m.y();
      m.heading_rad[i] = static_cast<float>(entry.heading_rad);
      m.speed_mps[i] = static_cast<float>(entry.speed_mps);
    }
    if (change.kind == CrowdChange::Kind::kSetDesiredSpeed)
      m.speed_mps[i] = static_cast<float>(change.desired_mps[first + i]);
  }
}

CrowdChange change_of(const crowd_change_t& m) {
  CrowdChange change;
  change.kind = static_cast<CrowdChange::Kind>(m.kind);
  change.group = m.group;
  change.goal = m.goal;
  for (size_t i = 0; i < m.avatar.size(); ++i) {
    change.ids.push_back(static_cast<uint32_t>(m.avatar[i]));
    if (change.kind == CrowdChange::Kind::kAdd)
      change.entries.push_back({{m.x_m[i], m.y_m[i]},
                                static_cast<double>(m.heading_rad[i]),
                                static_cast<double>(m.speed_mps[i])});
    if (change.kind == CrowdChange::Kind::kSetDesiredSpeed)
      change.desired_mps.push_back(static_cast<double>(m.speed_mps[i]));
  }
  return change;
}

}  // namespace throng
