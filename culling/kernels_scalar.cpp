#include "culling/kernels_scalar.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "culling/volumes/directions.h"
#include "culling/volumes/pose_math.h"

namespace throng {

namespace {

/// The same slabs around another origin: centres move, half widths grow by what rounding cost.
Slabs recentred(const Slabs& slabs, const float (&origin)[3]) {
  Slabs out;
  for (size_t i = 0; i < slabs.slab.size(); ++i) {
    double moved = static_cast<double>(slabs.slab[i].centre);
    for (size_t axis = 0; axis < 3; ++axis)
      moved -= kDirections[i][axis] * static_cast<double>(origin[axis]);
    const float centre = static_cast<float>(moved);
    const double half =
        static_cast<double>(slabs.slab[i].half) + std::fabs(moved - static_cast<double>(centre));
    out.slab[i] = {centre,
                   std::nextafter(static_cast<float>(half), std::numeric_limits<float>::max())};
  }
  return out;
}

}  // namespace

OrdopTable::OrdopTable(const Slabs& fitted) {
  for (size_t axis = 0; axis < 3; ++axis) origin[axis] = fitted.slab[axis].centre;
  slabs = recentred(fitted, origin);
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
    const float around = s.upright[j] + s.upright[i];
    const float flat2 = dx * dx + dy * dy;
    if (flat2 + dz * dz <= reach * reach && flat2 <= around * around) out[found++] = {i, j};
  }
  return found;
}

/// Where the origin of a table's slabs lies, relative to the body's root.
Eigen::Vector3f centre_m(const OrdopTable& table, const PartPose& pose, float scale) {
  const Eigen::Vector3f origin(scale * table.origin[0], scale * table.origin[1],
                               scale * table.origin[2]);
  return translation_m(pose) + turned(pose, origin);
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
      const PartPose& pose = poses[body * parts + part];
      const Eigen::Vector3f centre = centre_m(tables[part], pose, scales[body]);
      for (size_t axis = 0; axis < 3; ++axis) {
        const auto& row = pose.rows[axis];
        const Slab extent = tables[part].slabs.bound<26>({row[0], row[1], row[2]});
        const float middle = centre[static_cast<int>(axis)] + scales[body] * extent.centre;
        const float half = scales[body] * extent.half + margins[body];
        const float low = middle - half, high = middle + half;
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

/// One or-DOP's directions against the other's bound, in units of its own scale.
struct HalfTest {
  const OrdopTable& own;
  const OrdopTable& other;
  Eigen::Matrix3f other_from_own;  // times the ratio of the scales
  Eigen::Vector3f offset;          // of other's centre, in own's frame, over own's scale
  float margin;                    // over own's scale

  template <int K>
  bool separates() const {
    for (size_t i = 0; i < kDirections.size(); ++i) {
      if (!has_direction(K, static_cast<int>(i))) continue;
      const Eigen::Vector3f n = direction_vector(static_cast<int>(i));
      const Eigen::Vector3f d(along(n, other_from_own.row(0)), along(n, other_from_own.row(1)),
                              along(n, other_from_own.row(2)));
      const Slab far = other.slabs.bound<K>(d);
      const Slab& near = own.slabs.slab[i];
      const float gap = std::fabs((along(n, offset) + far.centre) - near.centre);
      if (gap > (near.half + far.half) + margin * direction_length(static_cast<int>(i)))
        return true;
    }
    return false;
  }
};

template <int K>
bool overlap(const OrdopTable& a, const PartPose& pose_a, const OrdopTable& b,
             const PartPose& pose_b, const BodyPair& pair) {
  const Eigen::Vector3f shift(pair.shift_m[0], pair.shift_m[1], pair.shift_m[2]);
  const Eigen::Vector3f delta =
      shift + centre_m(b, pose_b, pair.scale_b) - centre_m(a, pose_a, pair.scale_a);
  Eigen::Matrix3f b_from_a;
  for (int column = 0; column < 3; ++column)
    b_from_a.col(column) = turned_back(
        pose_b, {pose_a.rows[0][column], pose_a.rows[1][column], pose_a.rows[2][column]});
  const float per_a = 1.0f / pair.scale_a, per_b = 1.0f / pair.scale_b;
  const HalfTest from_a{a, b, b_from_a * (pair.scale_b * per_a), turned_back(pose_a, delta) * per_a,
                        pair.shift_m[3] * per_a};
  const HalfTest from_b{b, a, b_from_a.transpose() * (pair.scale_a * per_b),
                        -turned_back(pose_b, delta) * per_b, pair.shift_m[3] * per_b};
  return !from_a.separates<K>() && !from_b.separates<K>();
}

template <int K>
void ordop_pairs(const OrdopTable& a, const OrdopTable& b, const BodyPair* pairs,
                 const PartPose* poses, const Candidate* candidates, const uint32_t* order,
                 size_t count, uint8_t* overlaps) {
  for (size_t i = 0; i < count; ++i) {
    const Candidate& c = candidates[order[i]];
    const BodyPair& pair = pairs[c.pair];
    overlaps[order[i]] =
        overlap<K>(a, poses[pair.pose_a + c.part_a], b, poses[pair.pose_b + c.part_b], pair);
  }
}

}  // namespace

const Kernels& scalar_kernels() {
  static constexpr Kernels kernels = {sphere_run,      part_boxes,      box_pairs,
                                      ordop_pairs<14>, ordop_pairs<18>, ordop_pairs<26>};
  return kernels;
}

}  // namespace throng
