#include "lcm_io/codec/contact_rows.h"

#include "lcm_io/codec/pair_columns.h"

namespace throng {

void set_contacts(contact_points_t& m, std::span<const ContactPoint> rows) {
  resize_pairs(m, rows.size());
  for (auto* column : {&m.x_m, &m.y_m, &m.z_m}) column->resize(rows.size());
  for (auto* column : {&m.direction_x, &m.direction_y, &m.direction_z, &m.depth_m})
    column->resize(rows.size());
  for (size_t i = 0; i < rows.size(); ++i) {
    const ContactPoint& row = rows[i];
    set_pair(m, i, row.pair);
    m.x_m[i] = row.point_m[0];
    m.y_m[i] = row.point_m[1];
    m.z_m[i] = row.point_m[2];
    m.direction_x[i] = row.direction[0];
    m.direction_y[i] = row.direction[1];
    m.direction_z[i] = row.direction[2];
    m.depth_m[i] = row.depth_m;
  }
}

ContactPoint contact_at(const contact_points_t& m, size_t i) {
  return {pair_at(m, i),
          {m.x_m[i], m.y_m[i], m.z_m[i]},
          {m.direction_x[i], m.direction_y[i], m.direction_z[i]},
          m.depth_m[i]};
}

}  // namespace throng
