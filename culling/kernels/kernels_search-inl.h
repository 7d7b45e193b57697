// Spheres and rectangles of whole bodies with Highway, compiled once a target: slots as lanes.
// Included by kernels_simd.cpp only.
#if defined(THRONG_CULLING_KERNELS_SEARCH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef THRONG_CULLING_KERNELS_SEARCH_INL_H_
#undef THRONG_CULLING_KERNELS_SEARCH_INL_H_
#else
#define THRONG_CULLING_KERNELS_SEARCH_INL_H_
#endif

#include <hwy/highway.h>

#include <bit>

#include "culling/kernels/kernels.h"
#include "culling/kernels/kernels_lanes-inl.h"

#if THRONG_HAS_LANES  // the scalar reference is kernels_scalar.cpp
HWY_BEFORE_NAMESPACE();
namespace throng::HWY_NAMESPACE {

/// Loads a row's numbers at slots: the same slot in every lane, or consecutive ones from j on. The
/// rows are padded, so a full load is safe.
HWY_INLINE auto in_every_lane(uint32_t i) {
  return [i](const float* row) { return hn::Set(Lanes(), row[i]); };
}
HWY_INLINE auto from(uint32_t j) {
  return [j](const float* row) { return hn::LoadU(Lanes(), row + j); };
}

/// A sphere and cylinder a lane.
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

/// A rectangle a lane.
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

/// Separating axes along the sides of both. Every sum is formed so that exchanging the two changes
/// a sign at most.
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

/// The first `count` lanes.
HWY_INLINE M first_lanes(uint32_t count) {
  return hn::RebindMask(Lanes(), hn::FirstN(LaneBits(), count));
}

/// Writes the pair (i, others) of every lane that hits.
HWY_INLINE size_t append(uint32_t i, U others, M hits, SlotPair* out) {
  const LaneBits d;
  if constexpr (kLanes == 16) {  // whole registers: nothing branches on how many hit
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

/// A sphere and a rectangle a lane.
struct UprightBody {
  template <typename Load>
  HWY_INLINE UprightBody(const SphereRows& s, const RectangleRows& r, const Load& load)
      : sphere(s, load), rectangle(r, load) {}
  UprightSphere sphere;
  Rectangle rectangle;
};

/// What body_runs finds.
class FoundPairs {
 public:
  HWY_INLINE explicit FoundPairs(SlotPair* out) : out_(out) {}
  /// Tests slot i against others in the lanes of the mask. Both tests at once: which lanes hit is
  /// hard to foretell, a branch would cost more.
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

/// Loads several runs into one register, one behind the other.
class RunsInLanes {
 public:
  /// Whether they fit. A run is loaded from before its begin, which must be memory of the row's.
  HWY_INLINE static bool fit(const SlotRun* runs, size_t count) {
    uint32_t lanes = 0;
    bool fits = count <= kMostRuns;
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
  static constexpr size_t kMostRuns = 4;
  uint32_t first_;
  size_t behind_;
  uint32_t begin_[kMostRuns - 1];
  M from_[kMostRuns - 1];
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
