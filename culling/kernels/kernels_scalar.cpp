#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "culling/kernels/kernels.h"
#include "culling/volumes/ordop_table.h"
#include "culling/volumes/pose_math.h"
#include "culling/volumes/slabs.h"

namespace throng {
namespace {

bool spheres_overlap(const SphereRows& s, uint32_t i, uint32_t j) {
  const float dx = s.x[j] - s.x[i], dy = s.y[j] - s.y[i], dz = s.z[j] - s.z[i];
  const float reach = s.radius[j] + s.radius[i];
  const float around = s.upright[j] + s.upright[i];
  const float flat2 = dx * dx + dy * dy;
  return flat2 + dz * dz <= reach * reach && flat2 <= around * around;
}

bool rectangles_overlap(const RectangleRows& s, uint32_t i, uint32_t j) {
  const float dx = s.mid_x[j] - s.mid_x[i], dy = s.mid_y[j] - s.mid_y[i];
  const float ax = s.axis_x[i], ay = s.axis_y[i], bx = s.axis_x[j], by = s.axis_y[j];
  const float c = std::fabs(ax * bx + ay * by), n = std::fabs(ax * by - ay * bx);
  const float ahx = s.half_x[i], ahy = s.half_y[i], bhx = s.half_x[j], bhy = s.half_y[j];
  return std::fabs(dx * ax + dy * ay) <= ahx + (bhx * c + bhy * n) &&
         std::fabs(dy * ax - dx * ay) <= ahy + (bhx * n + bhy * c) &&
         std::fabs(dx * bx + dy * by) <= bhx + (ahx * c + ahy * n) &&
         std::fabs(dy * bx - dx * by) <= bhy + (ahx * n + ahy * c);
}

size_t sphere_run(const SphereRows& s, uint32_t i, uint32_t begin, uint32_t end, SlotPair* out) {
  size_t found = 0;
  for (uint32_t j = begin; j < end; ++j)
    if (spheres_overlap(s, i, j)) out[found++] = {i, j};
  return found;
}

size_t body_runs(const SphereRows& s, const RectangleRows& r, SlotRun own, const SlotRun* runs,
                 size_t run_count, SlotPair* out, uint64_t* spheres_passed) {
  size_t found = 0;
  for (uint32_t i = own.begin; i < own.end; ++i) {
    for (const SlotRun& run : std::span(runs, run_count)) {
      for (uint32_t j = run.first_for(i); j < run.end; ++j) {
        if (!spheres_overlap(s, i, j)) continue;
        ++*spheres_passed;
        if (rectangles_overlap(r, i, j)) out[found++] = {i, j};
      }
    }
  }
  return found;
}

/// Origin of a table's slabs, relative to the body's root.
Eigen::Vector3f centre_m(const OrdopTable& table, const PartPose& pose, float scale) {
  const Eigen::Vector3f origin(scale * table.origin[0], scale * table.origin[1],
                               scale * table.origin[2]);
  return translation_m(pose) + rotated(pose, origin);
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
        const auto& h = tables[part].half_box;
        const Slab extent =
            tables[part].slabs.bound<26>({row[0] * h[0], row[1] * h[1], row[2] * h[2]});
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

/// Tests all widened part boxes of a against all part boxes of b, in a's coordinates.
Candidate* box_pair(const BoxFrame& frame, const BodyPair& pair, uint32_t index, Candidate* out) {
  const size_t parts_a = frame.type_parts[pair.type_a], padded_a = padded_parts(parts_a);
  const size_t parts_b = frame.type_parts[pair.type_b], padded_b = padded_parts(parts_b);
  const float* rows_a = frame.blocks + (size_t{pair.box_a} + 1) * kBoxLanes;
  const float* rows_b = frame.blocks + (size_t{pair.box_b} + 1) * kBoxLanes;
  const BucketRule bucket(frame, pair.type_a, pair.type_b);
  for (size_t a = 0; a < parts_a; ++a) {
    for (size_t b = 0; b < parts_b; ++b) {
      bool overlap = true;
      for (size_t axis = 0; axis < 3; ++axis) {
        const float low = rows_b[axis * padded_b + b] + pair.shift_m[axis];
        const float high = rows_b[(axis + 3) * padded_b + b] + pair.shift_m[axis];
        overlap &= low <= rows_a[(axis + 3) * padded_a + a] + frame.margin_m &&
                   high >= rows_a[axis * padded_a + a] - frame.margin_m;
      }
      if (!overlap) continue;
      *out++ = {index, static_cast<uint8_t>(a), static_cast<uint8_t>(b),
                bucket(static_cast<uint32_t>(a), static_cast<uint32_t>(b))};
    }
  }
  return out;
}

size_t box_pairs(const BoxFrame& frame, const BodyPair* pairs, size_t first, size_t count,
                 Candidate* out, size_t capacity, size_t* found) {
  Candidate* const start = out;
  size_t i = first;
  for (; i < count; ++i) {
    const size_t worst = max_candidates(frame, pairs[i]);
    if (capacity - static_cast<size_t>(out - start) < worst) break;
    out = box_pair(frame, pairs[i], static_cast<uint32_t>(i), out);
  }
  *found = static_cast<size_t>(out - start);
  return i;
}

/// Directions of one or-DOP against the other's bound, in units of its own half sides and scale.
struct HalfTest {
  const OrdopTable& own;
  const OrdopTable& other;
  Eigen::Matrix3f other_from_own;  // directions of own in units of other
  Eigen::Vector3f offset;          // other's centre, in own's frame and units
  float margin;                    // divided by own's scale

  HalfTest(const OrdopTable& own_table, const OrdopTable& other_table, const Eigen::Matrix3f& axes,
           float other_over_own, const Eigen::Vector3f& offset_m, float per_own, float margin_m)
      : own(own_table), other(other_table), margin(margin_m * per_own) {
    const OrdopTable::Ratios ratio = other.ratios_to(own);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        other_from_own(i, j) = (axes(i, j) * other_over_own) * ratio.of[i][j];
    for (int j = 0; j < 3; ++j) offset[j] = (offset_m[j] * per_own) * own.per_half_box[j];
  }

  /// Along a direction of own, in its units: distance of the middles, and sum of the half widths.
  struct Along {
    float gap, reach;
  };
  template <int K>
  Along along_direction(size_t i) const {
    const Eigen::Vector3f n = direction_vector(static_cast<int>(i));
    const Eigen::Vector3f d(along(n, other_from_own.row(0)), along(n, other_from_own.row(1)),
                            along(n, other_from_own.row(2)));
    const Slab far = other.slabs.bound<K>(d);
    const Slab& near = own.slabs.slab[i];
    return {std::fabs((along(n, offset) + far.centre) - near.centre), near.half + far.half};
  }

  template <int K>
  bool separates() const {
    for (size_t i = 0; i < kDirections.size(); ++i) {
      if (!has_direction(K, static_cast<int>(i))) continue;
      const Along at = along_direction<K>(i);
      if (at.gap > at.reach + margin * own.length[i]) return true;
    }
    return false;
  }

  /// Largest gap along a direction of own, divided by own's scale; below 0 if none separates.
  float widest_gap() const {
    float widest = -kEmptyLow;
    for (size_t i = 0; i < kDirections.size(); ++i) {
      const Along at = along_direction<26>(i);
      widest = std::max(widest, (at.gap - at.reach) * own.per_length[i]);
    }
    return widest;
  }
};

struct Side {
  const OrdopTable& table;
  const PartPose& pose;
  float scale;
};

struct Halves {
  HalfTest from_a, from_b;

  static Halves of(const Side& a, const Side& b, const Eigen::Vector3f& a_to_b, float margin) {
    const Eigen::Vector3f delta =
        a_to_b + centre_m(b.table, b.pose, b.scale) - centre_m(a.table, a.pose, a.scale);
    const Eigen::Matrix3f axes = b_from_a(a.pose, b.pose);
    const float per_a = 1.0f / a.scale, per_b = 1.0f / b.scale;
    return {{a.table, b.table, axes, b.scale * per_a, rotated_back(a.pose, delta), per_a, margin},
            {b.table, a.table, axes.transpose(), a.scale * per_b, -rotated_back(b.pose, delta),
             per_b, margin}};
  }
  /// Row i: axis i of b, in a's frame.
  static Eigen::Matrix3f b_from_a(const PartPose& a, const PartPose& b) {
    Eigen::Matrix3f out;
    for (int column = 0; column < 3; ++column)
      out.col(column) = rotated_back(b, {a.rows[0][column], a.rows[1][column], a.rows[2][column]});
    return out;
  }
};

/// Calls visit(candidate's index, bucket's part a, its part b, vector between roots, margin).
template <typename Visit>
void for_sides(const OrdopTable& a, const OrdopTable& b, const BodyPair* pairs,
               const PartPose* poses, const Candidate* candidates, std::span<const uint32_t> order,
               const Visit& visit) {
  for (const uint32_t index : order) {
    const Candidate& c = candidates[index];
    const BodyPair& pair = pairs[c.pair];
    const Eigen::Vector3f shift(pair.shift_m[0], pair.shift_m[1], pair.shift_m[2]);
    const PartPose& pose_a = poses[pair.pose_a + c.part_a];
    const PartPose& pose_b = poses[pair.pose_b + c.part_b];
    if (c.is_swapped())
      visit(index, Side{a, pose_b, pair.scale_b}, Side{b, pose_a, pair.scale_a}, -shift,
            pair.shift_m[3]);
    else
      visit(index, Side{a, pose_a, pair.scale_a}, Side{b, pose_b, pair.scale_b}, shift,
            pair.shift_m[3]);
  }
}

template <int K>
void ordop_pairs(const OrdopTable& a, const OrdopTable& b, const BodyPair* pairs,
                 const PartPose* poses, const Candidate* candidates, const uint32_t* order,
                 size_t count, uint8_t* overlaps) {
  for_sides(a, b, pairs, poses, candidates, {order, count},
            [&](uint32_t index, const Side& side_a, const Side& side_b,
                const Eigen::Vector3f& a_to_b, float margin) {
              const Halves halves = Halves::of(side_a, side_b, a_to_b, margin);
              overlaps[index] = !halves.from_a.separates<K>() && !halves.from_b.separates<K>();
            });
}

/// Distance of a point on a from one on b. Looks up three points: from b's middle on a, b, a.
float point_to_point(const NearbyPoints& on_a, const NearbyPoints& on_b, const Side& side_a,
                     const Side& side_b, const Eigen::Vector3f& a_to_b) {
  const float per_a = 1.0f / side_a.scale, per_b = 1.0f / side_b.scale;
  const Eigen::Vector3f root =
      rotated_back(side_a.pose, (a_to_b + translation_m(side_b.pose)) - translation_m(side_a.pose));
  const Eigen::Matrix3f axes = Halves::b_from_a(side_a.pose, side_b.pose);
  const auto from_a = [&](const Eigen::Vector3f& b) -> Eigen::Vector3f {
    const Eigen::Vector3f scaled_b = b * side_b.scale;
    return root + Eigen::Vector3f(along(axes.col(0), scaled_b), along(axes.col(1), scaled_b),
                                  along(axes.col(2), scaled_b));
  };
  const auto from_b = [&](const Eigen::Vector3f& a) -> Eigen::Vector3f {
    const Eigen::Vector3f away = a * side_a.scale - root;
    return Eigen::Vector3f(along(axes.row(0), away), along(axes.row(1), away),
                           along(axes.row(2), away)) *
           per_b;
  };
  Eigen::Vector3f b(side_b.table.origin[0], side_b.table.origin[1], side_b.table.origin[2]);
  Eigen::Vector3f a = on_a.lookup(from_a(b) * per_a);
  b = on_b.lookup(from_b(a));
  a = on_a.lookup(from_a(b) * per_a);
  const Eigen::Vector3f apart = a * side_a.scale - from_a(b);
  return std::sqrt(along(apart, apart));
}

void ordop_gaps(const OrdopTable& a, const OrdopTable& b, const NearbyPoints& on_a,
                const NearbyPoints& on_b, const BodyPair* pairs, const PartPose* poses,
                const Candidate* candidates, const uint32_t* order, size_t count, float margin_m,
                GapBounds* bounds, uint8_t* overlaps) {
  for_sides(a, b, pairs, poses, candidates, {order, count},
            [&](uint32_t index, const Side& side_a, const Side& side_b,
                const Eigen::Vector3f& a_to_b, float margin) {
              const Halves halves = Halves::of(side_a, side_b, a_to_b, margin);
              const float gap = std::max(halves.from_a.widest_gap() * side_a.scale,
                                         halves.from_b.widest_gap() * side_b.scale);
              const float lo_m = std::max(gap * kGapDown - margin, 0.0f);
              if (lo_m > margin_m) return;
              bounds[index] = {
                  lo_m, point_to_point(on_a, on_b, side_a, side_b, a_to_b) * kGapUp + margin};
              overlaps[index] = !halves.from_a.separates<26>() && !halves.from_b.separates<26>();
            });
}

}  // namespace

const Kernels& scalar_kernels() {
  static constexpr Kernels kernels = {sphere_run,      body_runs,       part_boxes,      box_pairs,
                                      ordop_pairs<14>, ordop_pairs<18>, ordop_pairs<26>, ordop_gaps,
                                      ordop_pair<14>,  ordop_pair<18>,  ordop_pair<26>};
  return kernels;
}

}  // namespace throng
