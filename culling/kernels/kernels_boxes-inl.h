// kernels_boxes-inl.h implements the tests before or-DOPs with Highway: boxes of bodies and parts,
// spheres and rectangles of bodies. Compiled once per target; included by kernels_simd.cpp only.
#if defined(THRONG_CULLING_KERNELS_BOXES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef THRONG_CULLING_KERNELS_BOXES_INL_H_
#undef THRONG_CULLING_KERNELS_BOXES_INL_H_
#else
#define THRONG_CULLING_KERNELS_BOXES_INL_H_
#endif

#include <hwy/highway.h>

#include <bit>

#include "culling/kernels/kernels.h"
#include "culling/kernels/kernels_lanes-inl.h"

#if THRONG_HAS_LANES  // the scalar reference is kernels_scalar.cpp
HWY_BEFORE_NAMESPACE();
namespace throng::HWY_NAMESPACE {

/// Stores rows of four parts, one body per lane, at `offset` of each body's block.
HWY_INLINE void store_parts(const V (&by_part)[4], float* const* blocks, size_t offset,
                            size_t bodies) {
  V by_body[4];
  transpose4(by_part, by_body);
  const Lanes d;
  const hn::CappedTag<float, 4> quad;
  HWY_ALIGN float rows[4][kLanes];
  for (size_t i = 0; i < 4; ++i) hn::Store(by_body[i], d, rows[i]);
  for (size_t lane = 0; lane < bodies; ++lane)
    hn::Store(hn::Load(quad, &rows[lane % 4][lane / 4 * 4]), quad, blocks[lane] + offset);
}

HWY_NOINLINE void part_boxes(const OrdopTable* tables, size_t parts, const PartPose* poses,
                             const float* scales, const float* margins, size_t bodies,
                             float* const* blocks) {
  const Lanes d;
  const size_t padded = padded_parts(parts);
  const V nothing_low = hn::Set(d, kEmptyLow), nothing_high = hn::Set(d, kEmptyHigh);
  for (size_t first = 0; first < bodies; first += kLanes) {
    const size_t in_use = HWY_MIN(kLanes, bodies - first);
    HWY_ALIGN float scale_of[kLanes], margin_of[kLanes];
    for (size_t lane = 0; lane < kLanes; ++lane) {
      const size_t body = first + HWY_MIN(lane, in_use - 1);
      scale_of[lane] = scales[body];
      margin_of[lane] = margins[body];
    }
    const V scale = hn::Load(d, scale_of), margin = hn::Load(d, margin_of);
    V body_low[3] = {nothing_low, nothing_low, nothing_low};
    V body_high[3] = {nothing_high, nothing_high, nothing_high};
    for (size_t quad = 0; quad < padded; quad += 4) {
      V low[3][4], high[3][4];
      for (size_t p = 0; p < 4; ++p) {
        const size_t part = quad + p;
        if (part >= parts) {
          for (size_t axis = 0; axis < 3; ++axis)
            low[axis][p] = nothing_low, high[axis][p] = nothing_high;
          continue;
        }
        const Poses pose = load_poses([&](size_t lane) {
          return &poses[(first + HWY_MIN(lane, in_use - 1)) * parts + part];
        });
        const float* half_box = tables[part].half_box;
        const V half_x = hn::Set(d, half_box[0]), half_y = hn::Set(d, half_box[1]),
                half_z = hn::Set(d, half_box[2]);
        const V3 origin = centre_of(tables[part], pose, scale);
        const V middle[3] = {origin.x, origin.y, origin.z};
        const V3 direction[3] = {{pose.column[0].x, pose.column[1].x, pose.column[2].x},
                                 {pose.column[0].y, pose.column[1].y, pose.column[2].y},
                                 {pose.column[0].z, pose.column[1].z, pose.column[2].z}};
        for (size_t axis = 0; axis < 3; ++axis) {
          const V3 in_units = {hn::Mul(direction[axis].x, half_x),
                               hn::Mul(direction[axis].y, half_y),
                               hn::Mul(direction[axis].z, half_z)};
          const Interval extent = scaled(bound<26>(tables[part], in_units), scale);
          const V centre = hn::Add(middle[axis], extent.centre);
          const V half = hn::Add(extent.half, margin);
          low[axis][p] = hn::Sub(centre, half);
          high[axis][p] = hn::Add(centre, half);
          body_low[axis] = hn::Min(body_low[axis], low[axis][p]);
          body_high[axis] = hn::Max(body_high[axis], high[axis][p]);
        }
      }
      for (size_t axis = 0; axis < 3; ++axis) {
        store_parts(low[axis], blocks + first, kBoxLanes + axis * padded + quad, in_use);
        store_parts(high[axis], blocks + first, kBoxLanes + (axis + 3) * padded + quad, in_use);
      }
    }
    const V zero = hn::Zero(d);
    store_parts({body_low[0], body_low[1], body_low[2], zero}, blocks + first, 0, in_use);
    store_parts({body_high[0], body_high[1], body_high[2], zero}, blocks + first, 4, in_use);
  }
}

/// Low and high corner of a box, equal in all lanes.
struct Box {
  V low[3], high[3];
};

HWY_INLINE Box splat(const float* low, const float* high) {
  const Lanes d;
  Box b;
  for (size_t axis = 0; axis < 3; ++axis) {
    b.low[axis] = hn::Set(d, low[axis]);
    b.high[axis] = hn::Set(d, high[axis]);
  }
  return b;
}

class SixteenBoxes {
 public:
  /// `rows`: rows of the first part. Boxes are moved by `shift` and then widened.
  HWY_INLINE SixteenBoxes(const float* rows, size_t padded, const V (&shift)[3], V wider) {
    const Lanes d;
    for (size_t axis = 0; axis < 3; ++axis) {
      for (size_t i = 0; i < kRegisters; ++i) {
        const float* low = rows + axis * padded + i * kLanes;
        low_[axis][i] = hn::Sub(hn::Add(hn::Load(d, low), shift[axis]), wider);
        high_[axis][i] = hn::Add(hn::Add(hn::Load(d, low + 3 * padded), shift[axis]), wider);
      }
    }
  }
  /// Bit p is set if part p overlaps the box.
  HWY_INLINE uint32_t overlapping(const Box& box) const {
    uint32_t bits = 0;
    for (size_t i = 0; i < kRegisters; ++i) {
      const M x = hn::And(hn::Le(low_[0][i], box.high[0]), hn::Ge(high_[0][i], box.low[0]));
      const M y = hn::And(hn::Le(low_[1][i], box.high[1]), hn::Ge(high_[1][i], box.low[1]));
      const M z = hn::And(hn::Le(low_[2][i], box.high[2]), hn::Ge(high_[2][i], box.low[2]));
      bits |= bits_of(hn::And(hn::And(x, y), z)) << (i * kLanes);
    }
    return bits;
  }

 private:
  static constexpr size_t kRegisters = kBoxLanes / kLanes;
  V low_[3][kRegisters], high_[3][kRegisters];
};

/// Overlap of the body boxes of a pair, a's widened, in a's coordinates; false if there is none.
struct Overlap {
  float low[3], high[3];
};
HWY_INLINE bool body_overlap(const float* a, const float* b, const float* shift, float margin_m,
                             Overlap& out) {
  bool apart = false;
  for (size_t axis = 0; axis < 3; ++axis) {
    const float b_low = b[axis] + shift[axis], b_high = b[4 + axis] + shift[axis];
    const float a_low = a[axis] - margin_m, a_high = a[4 + axis] + margin_m;
    out.low[axis] = a_low > b_low ? a_low : b_low;
    out.high[axis] = a_high < b_high ? a_high : b_high;
    apart |= out.low[axis] > out.high[axis];
  }
  return !apart;
}

/// Widened box of one part in every lane.
HWY_INLINE Box part_box(const float* rows, size_t padded, size_t part, float margin_m) {
  const Lanes d;
  Box b;
  for (size_t axis = 0; axis < 3; ++axis) {
    b.low[axis] = hn::Set(d, rows[axis * padded + part] - margin_m);
    b.high[axis] = hn::Set(d, rows[(axis + 3) * padded + part] + margin_m);
  }
  return b;
}

/// Writes the candidates of one pair of bodies.
class CandidateWriter {
 public:
  HWY_INLINE CandidateWriter(const BoxFrame& frame, const BodyPair& pair, uint32_t index)
      : bucket_(frame, pair.type_a, pair.type_b),
        index_(index),
        all_have_buckets_(bucket_.first_a() + frame.type_parts[pair.type_a] <= bucket_.shapes() &&
                          bucket_.first_b() + frame.type_parts[pair.type_b] <= bucket_.shapes()) {}

  /// Adds part a with those of the sixteen parts of b from first_b on whose bit is set. May write
  /// up to kBoxLanes candidates from `out`, beyond the new end.
  HWY_INLINE Candidate* add(uint32_t part_a, uint32_t first_b, uint32_t hits,
                            Candidate* out) const {
    if (kLanes == kBoxLanes && all_have_buckets_) return add_row(part_a, first_b, hits, out);
    for (; hits != 0; hits &= hits - 1) {
      const uint32_t part_b = first_b + static_cast<uint32_t>(std::countr_zero(hits));
      *out++ = {index_, static_cast<uint8_t>(part_a), static_cast<uint8_t>(part_b),
                bucket_(part_a, part_b)};
    }
    return out;
  }

 private:
  /// The same without a branch on the bits: the end of a loop over bits is not predictable.
  HWY_INLINE Candidate* add_row(uint32_t part_a, uint32_t first_b, uint32_t hits,
                                Candidate* out) const {
    const LaneBits d;
    const hn::Repartition<uint64_t, LaneBits> wide;
    const uint32_t shapes = bucket_.shapes(), shape_a = bucket_.first_a() + part_a;
    const auto part_b = counting_from(first_b);
    const auto a = hn::Set(d, shape_a), b = hn::Add(part_b, hn::Set(d, bucket_.first_b()));
    // BucketRule: lower shape times the number of shapes, plus the higher shape.
    const auto bucket =
        hn::Add(hn::Min(hn::Set(d, shape_a * shapes), b * hn::Set(d, shapes)), hn::Max(a, b));
    const auto turn = hn::IfThenElseZero(hn::Lt(b, a), hn::Set(d, uint32_t{Candidate::kSwapped}));
    const auto parts = hn::Or(hn::Set(d, part_a), hn::ShiftLeft<8>(part_b));
    const auto upper_half = hn::Or3(parts, hn::ShiftLeft<16>(bucket), hn::ShiftLeft<16>(turn));
    const auto hit = hn::LoadMaskBits(d, reinterpret_cast<const uint8_t*>(&hits));
    const auto packed = Packing(hn::RebindMask(Lanes(), hit))(upper_half);
    const auto with_index = [&](auto half) {
      return hn::Or(hn::ShiftLeft<32>(hn::PromoteTo(wide, half)), hn::Set(wide, uint64_t{index_}));
    };
    static_assert(sizeof(Candidate) == sizeof(uint64_t) && offsetof(Candidate, pair) == 0 &&
                  offsetof(Candidate, part_b) == 5 && offsetof(Candidate, bucket_and_swap) == 6);
    const hn::Half<LaneBits> half;
    hn::StoreU(with_index(hn::LowerHalf(half, packed)), wide, reinterpret_cast<uint64_t*>(out));
    hn::StoreU(with_index(hn::UpperHalf(half, packed)), wide,
               reinterpret_cast<uint64_t*>(out + kBoxLanes / 2));
    return out + std::popcount(hits);
  }

  BucketRule bucket_;
  uint32_t index_;
  bool all_have_buckets_;
};

/// Appends the overlapping parts of one pair; returns the new end.
HWY_INLINE Candidate* box_pair(const BoxFrame& frame, const BodyPair& pair, uint32_t index,
                               Candidate* out) {
  const float* block_a = frame.blocks + size_t{pair.box_a} * kBoxLanes;
  const float* block_b = frame.blocks + size_t{pair.box_b} * kBoxLanes;
  Overlap both;
  if (!body_overlap(block_a, block_b, pair.shift_m, frame.margin_m, both)) return out;
  const size_t padded_a = padded_parts(frame.type_parts[pair.type_a]);
  const size_t padded_b = padded_parts(frame.type_parts[pair.type_b]);
  const float* rows_a = block_a + kBoxLanes;
  const float* rows_b = block_b + kBoxLanes;
  const Box overlap = splat(both.low, both.high);
  const Lanes d;
  const V shift[3] = {hn::Set(d, pair.shift_m[0]), hn::Set(d, pair.shift_m[1]),
                      hn::Set(d, pair.shift_m[2])};
  const V still[3] = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
  const V none = hn::Zero(d), wider = hn::Set(d, frame.margin_m);
  const CandidateWriter writer(frame, pair, index);
  if (padded_a == kBoxLanes && padded_b == kBoxLanes) {  // all boxes fit into registers
    const SixteenBoxes boxes_a(rows_a, padded_a, still, wider),
        boxes_b(rows_b, padded_b, shift, none);
    const uint32_t inside_b = boxes_b.overlapping(overlap);
    uint32_t inside_a = inside_b == 0 ? 0 : boxes_a.overlapping(overlap);
    for (; inside_a != 0; inside_a &= inside_a - 1) {
      const uint32_t part_a = static_cast<uint32_t>(std::countr_zero(inside_a));
      const Box box = part_box(rows_a, kBoxLanes, part_a, frame.margin_m);
      out = writer.add(part_a, 0, inside_b & boxes_b.overlapping(box), out);
    }
    return out;
  }
  for (uint32_t group_a = 0; group_a < padded_a; group_a += kBoxLanes) {
    uint32_t inside_a = SixteenBoxes(rows_a + group_a, padded_a, still, wider).overlapping(overlap);
    for (; inside_a != 0; inside_a &= inside_a - 1) {
      const uint32_t part_a = group_a + static_cast<uint32_t>(std::countr_zero(inside_a));
      const Box box = part_box(rows_a, padded_a, part_a, frame.margin_m);
      for (uint32_t group_b = 0; group_b < padded_b; group_b += kBoxLanes)
        out =
            writer.add(part_a, group_b,
                       SixteenBoxes(rows_b + group_b, padded_b, shift, none).overlapping(box), out);
    }
  }
  return out;
}

HWY_NOINLINE size_t box_pairs(const BoxFrame& frame, const BodyPair* pairs, size_t first,
                              size_t count, Candidate* out, size_t capacity, size_t* found) {
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

// Tests of spheres and rectangles of bodies with Highway, slots as lanes. Compiled once per target.

/// Loads numbers of a row: the same slot in every lane, or consecutive slots from j on. Rows are
/// padded, so a full load is safe.
HWY_INLINE auto in_every_lane(uint32_t i) {
  return [i](const float* row) { return hn::Set(Lanes(), row[i]); };
}
HWY_INLINE auto from(uint32_t j) {
  return [j](const float* row) { return hn::LoadU(Lanes(), row + j); };
}

struct UprightSphere {
  template <typename Load>
  HWY_INLINE UprightSphere(const SphereRows& s, const Load& load)
      : x(load(s.x)),
        y(load(s.y)),
        z(load(s.z)),
        radius(load(s.radius)),
        upright(load(s.upright)) {}
  V x, y, z, radius, upright;
};

HWY_INLINE M overlapping(const UprightSphere& a, const UprightSphere& b) {
  const V dx = hn::Sub(b.x, a.x), dy = hn::Sub(b.y, a.y), dz = hn::Sub(b.z, a.z);
  const V reach = hn::Add(b.radius, a.radius), around = hn::Add(b.upright, a.upright);
  const V flat2 = hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy));
  const M spheres = hn::Le(hn::Add(flat2, hn::Mul(dz, dz)), hn::Mul(reach, reach));
  return hn::And(spheres, hn::Le(flat2, hn::Mul(around, around)));
}

struct Rectangle {
  template <typename Load>
  HWY_INLINE Rectangle(const RectangleRows& r, const Load& load)
      : mid_x(load(r.mid_x)),
        mid_y(load(r.mid_y)),
        axis_x(load(r.axis_x)),
        axis_y(load(r.axis_y)),
        half_x(load(r.half_x)),
        half_y(load(r.half_y)) {}
  V mid_x, mid_y, axis_x, axis_y, half_x, half_y;
};

/// Tests separating axes along the sides of both. Exchanging them changes only signs of sums.
HWY_INLINE M overlapping(const Rectangle& a, const Rectangle& b) {
  const V dx = hn::Sub(b.mid_x, a.mid_x), dy = hn::Sub(b.mid_y, a.mid_y);
  const V c = hn::Abs(hn::Add(hn::Mul(a.axis_x, b.axis_x), hn::Mul(a.axis_y, b.axis_y)));
  const V n = hn::Abs(hn::Sub(hn::Mul(a.axis_x, b.axis_y), hn::Mul(a.axis_y, b.axis_x)));
  const auto within = [&](V along, V own, V first, V second) {
    return hn::Le(hn::Abs(along), hn::Add(own, hn::Add(first, second)));
  };
  const M one = within(hn::Add(hn::Mul(dx, a.axis_x), hn::Mul(dy, a.axis_y)), a.half_x,
                       hn::Mul(b.half_x, c), hn::Mul(b.half_y, n));
  const M two = within(hn::Sub(hn::Mul(dy, a.axis_x), hn::Mul(dx, a.axis_y)), a.half_y,
                       hn::Mul(b.half_x, n), hn::Mul(b.half_y, c));
  const M three = within(hn::Add(hn::Mul(dx, b.axis_x), hn::Mul(dy, b.axis_y)), b.half_x,
                         hn::Mul(a.half_x, c), hn::Mul(a.half_y, n));
  const M four = within(hn::Sub(hn::Mul(dy, b.axis_x), hn::Mul(dx, b.axis_y)), b.half_y,
                        hn::Mul(a.half_x, n), hn::Mul(a.half_y, c));
  return hn::And(hn::And(one, two), hn::And(three, four));
}

HWY_INLINE M first_lanes(uint32_t count) {
  return hn::RebindMask(Lanes(), hn::FirstN(LaneBits(), count));
}

/// Writes the pair (i, others) of every lane that hits.
HWY_INLINE size_t append(uint32_t i, U others, M hits, SlotPair* out) {
  const LaneBits d;
  if constexpr (kLanes == 16) {  // whole registers, without branches on the number of hits
    hn::StoreInterleaved2(hn::Set(d, i), Packing(hits)(others), d, &out->a);
    return hn::CountTrue(Lanes(), hits);
  }
  HWY_ALIGN uint32_t slots[kLanes];
  hn::Store(others, d, slots);
  size_t found = 0;
  for (uint32_t left = bits_of(hits); left != 0; left &= left - 1)
    out[found++] = {i, slots[std::countr_zero(left)]};
  return found;
}

HWY_NOINLINE size_t sphere_run(const SphereRows& s, uint32_t i, uint32_t begin, uint32_t end,
                               SlotPair* out) {
  const UprightSphere own(s, in_every_lane(i));
  size_t found = 0;
  for (uint32_t j = begin; j < end; j += static_cast<uint32_t>(kLanes)) {
    const M hits = hn::And(overlapping(own, UprightSphere(s, from(j))), first_lanes(end - j));
    found += append(i, counting_from(j), hits, out + found);
  }
  return found;
}

struct UprightBody {
  template <typename Load>
  HWY_INLINE UprightBody(const SphereRows& s, const RectangleRows& r, const Load& load)
      : sphere(s, load), rectangle(r, load) {}
  UprightSphere sphere;
  Rectangle rectangle;
};

class FoundPairs {
 public:
  HWY_INLINE explicit FoundPairs(SlotPair* out) : out_(out) {}
  /// Tests slot i against others in the lanes of the mask. Both tests run at once: hits are not
  /// predictable, and a branch would cost more.
  HWY_INLINE void test(uint32_t i, const UprightBody& own, U slots, const UprightBody& others,
                       M lanes) {
    const M hits = hn::And(overlapping(own.sphere, others.sphere), lanes);
    spheres_ += hn::CountTrue(Lanes(), hits);
    const M both = hn::And(hits, overlapping(own.rectangle, others.rectangle));
    count_ += append(i, slots, both, out_ + count_);
  }
  size_t count() const { return count_; }
  size_t spheres() const { return spheres_; }

 private:
  SlotPair* out_;
  size_t count_ = 0, spheres_ = 0;
};

/// Loads several consecutive runs into one register.
class RunsInLanes {
 public:
  /// True if the runs fit. A run is loaded from before its begin, which must be memory of the row.
  HWY_INLINE static bool fit(const SlotRun* runs, size_t count) {
    uint32_t lanes = 0;
    bool fits = count <= kMaxRuns;
    for (size_t run = 0; run < count; ++run) {
      fits &= runs[run].begin >= lanes;
      lanes += runs[run].end - runs[run].begin;
    }
    return fits && lanes <= kLanes;
  }
  HWY_INLINE RunsInLanes(const SlotRun* runs, size_t count)
      : first_(runs[0].begin), behind_(count - 1), lanes_(runs[0].end - runs[0].begin) {
    for (size_t run = 0; run < behind_; ++run) {
      begin_[run] = runs[run + 1].begin - lanes_;
      from_[run] = hn::Not(first_lanes(lanes_));
      lanes_ += runs[run + 1].end - runs[run + 1].begin;
    }
  }
  HWY_INLINE V operator()(const float* row) const {
    V out = from(first_)(row);
    for (size_t run = 0; run < behind_; ++run)
      out = hn::IfThenElse(from_[run], from(begin_[run])(row), out);
    return out;
  }
  HWY_INLINE U slots() const {
    const LaneBits d;
    U out = counting_from(first_);
    for (size_t run = 0; run < behind_; ++run)
      out = hn::IfThenElse(hn::RebindMask(d, from_[run]), counting_from(begin_[run]), out);
    return out;
  }
  HWY_INLINE M lanes() const { return first_lanes(lanes_); }

 private:
  static constexpr size_t kMaxRuns = 4;
  uint32_t first_;
  size_t behind_;
  uint32_t begin_[kMaxRuns - 1];
  M from_[kMaxRuns - 1];
  uint32_t lanes_;
};

HWY_NOINLINE size_t body_runs(const SphereRows& s, const RectangleRows& r, SlotRun own,
                              const SlotRun* runs, size_t run_count, SlotPair* out,
                              uint64_t* spheres_passed) {
  FoundPairs found(out);
  if (RunsInLanes::fit(runs, run_count)) {
    const RunsInLanes load(runs, run_count);
    const UprightBody others(s, r, load);
    const U slots = load.slots();
    for (uint32_t i = own.begin; i < own.end; ++i) {
      const M earlier = first_lanes(runs[0].first_for(i) - runs[0].begin);
      found.test(i, UprightBody(s, r, in_every_lane(i)), slots, others,
                 hn::AndNot(earlier, load.lanes()));
    }
  } else {
    for (uint32_t i = own.begin; i < own.end; ++i) {
      const UprightBody body(s, r, in_every_lane(i));
      for (size_t run = 0; run < run_count; ++run) {
        const uint32_t end = runs[run].end;
        for (uint32_t j = runs[run].first_for(i); j < end; j += static_cast<uint32_t>(kLanes))
          found.test(i, body, counting_from(j), UprightBody(s, r, from(j)), first_lanes(end - j));
      }
    }
  }
  *spheres_passed += found.spheres();
  return found.count();
}

}  // namespace throng::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif  // THRONG_HAS_LANES

#endif  // per-target include guard
