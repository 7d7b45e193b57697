#include "culling/kernels_scalar.h"

#include <algorithm>

#include "culling/volumes/ordop.h"

namespace throng {

OrdopTable::OrdopTable(const Slabs& fitted) : slabs(fitted) {
  for (size_t axis = 0; axis < 3; ++axis) {
    axis_half[axis] = slabs.slab[axis].half;
    axis_centre[axis] = slabs.slab[axis].centre;
  }
  for (size_t entry = 0; entry < 16; ++entry) {
    const bool negative[3] = {(entry & 1) != 0, (entry & 2) != 0, (entry & 4) != 0};
    for (size_t omitted = 0; omitted < 3; ++omitted) {
      const size_t first = omitted == 0 ? 1 : 0, second = omitted == 2 ? 1 : 2;
      const Slab& slab = slabs.slab[edge_direction(omitted, negative[first] != negative[second])];
      edge_half[omitted][entry] = slab.half;
      edge_centre[omitted][entry] = negative[first] ? -slab.centre : slab.centre;
    }
    const Slab& slab =
        slabs.slab[corner_direction(negative[1] != negative[0], negative[2] != negative[0])];
    corner_half[entry] = slab.half;
    corner_centre[entry] = negative[0] ? -slab.centre : slab.centre;
  }
}

namespace {

size_t sphere_run(const SphereRows& s, uint32_t i, uint32_t begin, uint32_t end, SlotPair* out) {
  size_t found = 0;
  for (uint32_t j = begin; j < end; ++j) {
    const float dx = s.x[j] - s.x[i], dy = s.y[j] - s.y[i], dz = s.z[j] - s.z[i];
    const float reach = s.radius[j] + s.radius[i];
    if ((dx * dx + dy * dy) + dz * dz <= reach * reach) out[found++] = {i, j};
  }
  return found;
}

void part_boxes(const OrdopTable* tables, size_t parts, const PartPose* poses, const float* scales,
                const float* margins, size_t bodies, float* const* blocks) {
  const size_t padded = padded_parts(parts);
  for (size_t body = 0; body < bodies; ++body) {
    float* const own = blocks[body];
    float* const rows = own + kBoxLanes;
    std::fill_n(own, 8, 0.0f);
    std::fill_n(own, 3, kEmptyLow);
    std::fill_n(own + 4, 3, kEmptyHigh);
    std::fill_n(rows, 3 * padded, kEmptyLow);
    std::fill_n(rows + 3 * padded, 3 * padded, kEmptyHigh);
    for (size_t part = 0; part < parts; ++part) {
      const auto& pose = poses[body * parts + part].rows;
      for (size_t axis = 0; axis < 3; ++axis) {
        const Slab extent =
            tables[part].slabs.bound<26>({pose[axis][0], pose[axis][1], pose[axis][2]});
        const float centre = pose[axis][3] + scales[body] * extent.centre;
        const float half = scales[body] * extent.half + margins[body];
        const float low = centre - half, high = centre + half;
        rows[axis * padded + part] = low;
        rows[(axis + 3) * padded + part] = high;
        own[axis] = std::min(own[axis], low);
        own[4 + axis] = std::max(own[4 + axis], high);
      }
    }
  }
}

/// Part boxes of a against part boxes of b, all of them, one by one.
Candidate* box_pair(const BoxFrame& frame, const BodyPair& pair, uint32_t index, Candidate* out) {
  const size_t parts_a = frame.type_parts[pair.type_a], padded_a = padded_parts(parts_a);
  const size_t parts_b = frame.type_parts[pair.type_b], padded_b = padded_parts(parts_b);
  const float* rows_a = frame.blocks + (size_t{pair.box_a} + 1) * kBoxLanes;
  const float* rows_b = frame.blocks + (size_t{pair.box_b} + 1) * kBoxLanes;
  for (size_t a = 0; a < parts_a; ++a) {
    for (size_t b = 0; b < parts_b; ++b) {
      bool overlap = true;
      for (size_t axis = 0; axis < 3; ++axis) {
        const float low = rows_a[axis * padded_a + a] - pair.shift_m[axis];
        const float high = rows_a[(axis + 3) * padded_a + a] - pair.shift_m[axis];
        overlap &= rows_b[axis * padded_b + b] <= high && rows_b[(axis + 3) * padded_b + b] >= low;
      }
      if (!overlap) continue;
      *out++ = {index, static_cast<uint8_t>(a), static_cast<uint8_t>(b),
                bucket_of(frame, pair.type_a, a, pair.type_b, b)};
    }
  }
  return out;
}

size_t box_pairs(const BoxFrame& frame, const BodyPair* pairs, size_t first, size_t count,
                 Candidate* out, size_t room, size_t* found) {
  Candidate* const start = out;
  size_t i = first;
  for (; i < count; ++i) {
    const size_t worst =
        size_t{frame.type_parts[pairs[i].type_a]} * frame.type_parts[pairs[i].type_b];
    if (room - static_cast<size_t>(out - start) < worst) break;
    out = box_pair(frame, pairs[i], static_cast<uint32_t>(i), out);
  }
  *found = static_cast<size_t>(out - start);
  return i;
}

template <int K>
void ordop_pairs(const OrdopTable& a, const OrdopTable& b, const BodyPair* pairs,
                 const PartPose* poses, const Candidate* candidates, const uint32_t* order,
                 size_t count, uint8_t* overlaps) {
  for (size_t i = 0; i < count; ++i) {
    const Candidate& c = candidates[order[i]];
    const BodyPair& pair = pairs[c.pair];
    overlaps[order[i]] =
        ordop_overlaps<K>(a.slabs, poses[pair.pose_a + c.part_a], pair.scale_a, b.slabs,
                          poses[pair.pose_b + c.part_b], pair.scale_b,
                          {pair.shift_m[0], pair.shift_m[1], pair.shift_m[2]}, pair.shift_m[3]);
  }
}

}  // namespace

const Kernels& scalar_kernels() {
  static constexpr Kernels kernels = {sphere_run,      part_boxes,      box_pairs,
                                      ordop_pairs<14>, ordop_pairs<18>, ordop_pairs<26>};
  return kernels;
}

}  // namespace throng
