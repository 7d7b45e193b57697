#include "lcm_io/codec/separation_rows.h"

namespace throng {

void begin_separation(separation_t& m, size_t count) {
  m.count = static_cast<int32_t>(count);
  for (auto* column : {&m.kind, &m.region, &m.cut, &m.beyond_margin}) column->resize(count);
  for (auto* column : {&m.robot, &m.person}) column->resize(count);
  for (auto* column : {&m.least_lo_m, &m.least_hi_m, &m.most_short_m}) column->resize(count);
  m.begin_frame.resize(count);
}

void set_shortfall(separation_t& m, size_t i, EventKind kind, const Shortfall& shortfall) {
  m.kind[i] = static_cast<uint8_t>(kind);
  m.robot[i] = static_cast<int32_t>(shortfall.robot);
  m.person[i] = static_cast<int32_t>(shortfall.person);
  m.region[i] = static_cast<uint8_t>(shortfall.region);
  m.begin_frame[i] = shortfall.begin_frame;
  m.least_lo_m[i] = shortfall.least_lo_m;
  m.least_hi_m[i] = shortfall.least_hi_m;
  m.most_short_m[i] = shortfall.most_short_m;
  m.cut[i] = shortfall.is_cut ? 1 : 0;
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
  shortfall.least_lo_m = m.least_lo_m[i];
  shortfall.least_hi_m = m.least_hi_m[i];
  shortfall.most_short_m = m.most_short_m[i];
  shortfall.is_cut = m.cut[i] != 0;
  shortfall.is_beyond_margin = m.beyond_margin[i] != 0;
  return event;
}

}  // namespace throng
