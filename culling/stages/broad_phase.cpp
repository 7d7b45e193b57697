#include "culling/stages/broad_phase.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/stopwatch.h"
#include "culling/kernels/kernels.h"

namespace throng {
namespace {

constexpr size_t kTaskBodies = 1024;
constexpr size_t kMaxLarge = 1024;  // large bodies are tested one by one
constexpr float kLargeRatio = 2;    // relative to the mean sphere of moving bodies

float half_of(float margin_m) { return 0.5f * margin_m * (1 + 0x1p-20f); }

int tasks_of(size_t count) { return static_cast<int>((count + kTaskBodies - 1) / kTaskBodies); }

bool reaches_box(const PlacedBody& body, const Eigen::Vector3f& low, const Eigen::Vector3f& high) {
  const Eigen::Vector3f centre(body.x, body.y, body.z);
  const float distance2 = (centre - centre.cwiseMax(low).cwiseMin(high)).squaredNorm();
  return !(distance2 > body.radius * body.radius);
}

}  // namespace

BroadPhase::BroadPhase(std::span<const std::shared_ptr<const BodyType>> types,
                       const Kernels& kernels, Workers& workers, PairSearch kind,
                       const PairFilter& filter, const Margins& margins)
    : types_(types),
      kernels_(kernels),
      workers_(workers),
      kind_(kind),
      filter_(filter),
      half_margin_m_(half_of(margins.reach_m)),
      has_inner_(margins.inner_m > 0),
      half_inner_m_(half_of(margins.inner_m)) {
  counters_.volume = "sphere";
  for (const auto& type : types) {
    const RootSphere& sphere = type->sphere();
    // The cylinder is around the sphere's centre, that of the type around the root.
    sizes_of_type_.push_back({sphere.centre_m, sphere.radius_m,
                              sphere.upright_radius_m + sphere.centre_m.head<2>().norm(),
                              body_margin_m(reach_m(*type)), type->is_static()});
    any_static_ |= type->is_static();
  }
}

void BroadPhase::run(const BodiesView& bodies, const PoseSource& source, Slots& slots) {
  counters_ = {.volume = "sphere"};
  Stopwatch watch;
  body_count_ = bodies.ids.size();
  place(bodies, source);
  split_by_size(bodies);
  searcher_.build(kind_, {placed_.data(), body_count_}, {small_.data(), small_count_}, workers_);
  slots.begin_frame(bodies, searcher_.bodies(), {large_.data(), large_count_});
  counters_.updates = body_count_;
  counters_.update_ns = watch.lap_ns();

  block_count_ = searcher_.block_count() + 1;
  if (blocks_.size() < block_count_) blocks_.resize(block_count_);
  search_small(slots);
  if (large_count_ > 0) search_large(source, slots);
  if (has_inner_) find_inner(slots);
  counters_.test_ns = watch.lap_ns();
  listed_ = 0;
  for (size_t i = 0; i < block_count_; ++i) {
    counters_.tests += blocks_[i].found.tests;
    counters_.passed += blocks_[i].found.spheres;
    listed_ += blocks_[i].count;
  }
}

void BroadPhase::place(const BodiesView& bodies, const PoseSource& source) {
  placed_.resize(body_count_);
  if (has_inner_) placed_inner_.resize(body_count_);
  sizes_.resize(static_cast<size_t>(tasks_of(body_count_)));
  if (body_count_ == 0) return;
  // Relative to one of the bodies, to keep numbers small wherever the crowd is.
  origin_m_ = bodies.roots[body_count_ / 2].position_m;
  workers_.for_blocks(tasks_of(body_count_), [&](int task, int) {
    constexpr size_t kBatch = PoseSource::kMaxBatch;
    const size_t first = static_cast<size_t>(task) * kTaskBodies,
                 end = std::min(body_count_, first + kTaskBodies);
    Sizes sizes;
    for (size_t batch = first; batch < end; batch += kBatch) {
      const size_t count = std::min(kBatch, end - batch);
      uint32_t numbers[kBatch];
      RootBox bounds[kBatch];
      for (size_t i = 0; i < count; ++i) numbers[i] = static_cast<uint32_t>(batch + i);
      source.bounds({numbers, count}, {bounds, count});
      for (size_t i = 0; i < count; ++i) {
        const size_t body = batch + i;
        const TypeSize& type = sizes_of_type_[bodies.types[body]];
        place_body(bodies.roots[body], bodies.scales[body], type, bounds[i], half_margin_m_,
                   placed_[body]);
        if (has_inner_)
          place_body(bodies.roots[body], bodies.scales[body], type, bounds[i], half_inner_m_,
                     placed_inner_[body]);
        const float radius = own_radius(body, bodies);
        sizes.widest_m = std::max(sizes.widest_m, radius);
        sizes.radii += type.is_static ? 0 : static_cast<double>(radius);
        sizes.moving += !type.is_static;
      }
    }
    sizes_[static_cast<size_t>(task)] = sizes;
  });
}

void BroadPhase::place_body(const RootPose& root, float scale, const TypeSize& type,
                            const RootBox& bounds, float half_margin_m, PlacedBody& out) const {
  const Eigen::Quaternionf& q = root.world_from_root;
  const Eigen::Matrix3f turn = q.toRotationMatrix();
  const Eigen::Vector3d from_origin = root.position_m - origin_m_;
  const Eigen::Vector3f offset = turn * (scale * type.centre_m);
  const Eigen::Vector3f centre = (from_origin + offset.cast<double>()).cast<float>();
  out.x = centre.x();
  out.y = centre.y();
  out.z = centre.z();
  // Coordinates are rounded when stored and when the search adds and subtracts them.
  const float margin =
      scale * type.margin_m + 0x1p-22f * centre.cwiseAbs().maxCoeff() + half_margin_m;
  out.radius = scale * type.radius_m + margin;
  const bool upright = q.x() == 0 && q.y() == 0;
  out.upright = upright ? std::min(out.radius, scale * type.upright_m + margin) : out.radius;
  // Without bounds, the square around the cylinder.
  out.mid_x = out.x;
  out.mid_y = out.y;
  out.axis_x = 1;
  out.axis_y = 0;
  out.half_x = out.half_y = out.upright;
  if (!bounds.is_known()) return;
  const Eigen::Vector3f low(bounds.min_m), high(bounds.max_m);
  const Eigen::Vector3f middle = 0.5f * (low + high), half = 0.5f * (high - low);
  const Eigen::Vector3d middle_world = from_origin + (turn * middle).cast<double>();
  out.mid_x = static_cast<float>(middle_world.x());
  out.mid_y = static_cast<float>(middle_world.y());
  if (upright) {
    out.axis_x = turn(0, 0);
    out.axis_y = turn(1, 0);
    out.half_x = half.x() + margin;
    out.half_y = half.y() + margin;
  } else {
    const Eigen::Vector3f reach = turn.cwiseAbs() * half;
    out.half_x = reach.x() + margin;
    out.half_y = reach.y() + margin;
  }
}

float BroadPhase::own_radius(size_t body, const BodiesView& bodies) const {
  const PlacedBody& placed = placed_[body];
  if (half_margin_m_ == 0) return placed.radius;
  const TypeSize& type = sizes_of_type_[bodies.types[body]];
  const float scale = bodies.scales[body];
  const float far = std::max({std::fabs(placed.x), std::fabs(placed.y), std::fabs(placed.z)});
  return scale * type.radius_m + (scale * type.margin_m + 0x1p-22f * far);
}

void BroadPhase::split_by_size(const BodiesView& bodies) {
  Sizes all;
  for (size_t i = 0; i < static_cast<size_t>(tasks_of(body_count_)); ++i) {
    all.radii += sizes_[i].radii;
    all.moving += sizes_[i].moving;
    all.widest_m = std::max(all.widest_m, sizes_[i].widest_m);
  }
  const float limit =
      all.moving == 0
          ? 0
          : kLargeRatio * static_cast<float>(all.radii / static_cast<double>(all.moving));
  small_.resize(body_count_);
  large_.resize(body_count_);
  small_count_ = large_count_ = 0;
  widest_m_ = 0;
  if (all.widest_m <= limit) {  // the usual crowd
    std::iota(small_.data(), small_.data() + body_count_, 0u);
    small_count_ = body_count_;
    widest_m_ =
        half_margin_m_ == 0 ? all.widest_m : (all.widest_m + half_margin_m_) * (1 + 0x1p-20f);
    return;
  }
  for (size_t i = 0; i < body_count_; ++i) {
    if (own_radius(i, bodies) > limit && large_count_ < kMaxLarge) {
      large_[large_count_++] = static_cast<uint32_t>(i);
    } else {
      small_[small_count_++] = static_cast<uint32_t>(i);
      widest_m_ = std::max(widest_m_, placed_[i].radius);
    }
  }
}

void BroadPhase::search_small(const Slots& slots) {
  workers_.for_blocks(static_cast<int>(searcher_.block_count()), [&](int index, int) {
    Block& block = blocks_[static_cast<size_t>(index)];
    block.found = searcher_.search_block(kernels_, static_cast<size_t>(index), block.pairs);
    block.count = block.found.pairs;
    if (!any_static_ && filter_.sides_of_body.empty()) return;
    const auto is_excluded = [&](const SlotPair& pair) {
      return !passes_filter(pair.a, pair.b, slots);
    };
    SlotPair* const pairs = block.pairs.data();
    block.count =
        static_cast<size_t>(std::remove_if(pairs, pairs + block.found.pairs, is_excluded) - pairs);
    block.found.spheres -= block.found.pairs - block.count;
  });
  Block& last = blocks_[block_count_ - 1];
  last.count = 0;
  last.found = {};
}

/// False for two static bodies and for pairs that the filter rejects.
bool BroadPhase::passes_filter(size_t slot_a, size_t slot_b, const Slots& slots) const {
  return !(slots.is_static(slot_a) && slots.is_static(slot_b)) &&
         filter_.includes_bodies(slots.id(slot_a), slots.id(slot_b));
}

void BroadPhase::add(Block& block, size_t a, size_t b) {
  block.pairs.grow(block.count + 1, block.count);
  block.pairs[block.count++] = {static_cast<uint32_t>(a), static_cast<uint32_t>(b)};
  ++block.found.spheres;
}

void BroadPhase::search_large(const PoseSource& source, const Slots& slots) {
  Block& last = blocks_[block_count_ - 1];
  posed_large_.prepare(slots.count());
  posed_large_.clear();
  for (size_t slot = small_count_; slot < slots.count(); ++slot)
    posed_large_.request(static_cast<uint32_t>(slot));
  posed_large_.pose({types_, kernels_, slots, source}, workers_);
  for (size_t slot = small_count_; slot < slots.count(); ++slot) {
    Eigen::Vector3f low, high;
    box_of(slot, slots, half_margin_m_, low, high);
    test_against_small(slot, low, high, slots);
    for (size_t other = slot + 1; other < slots.count(); ++other) {
      if (!passes_filter(slot, other, slots)) continue;
      ++last.found.tests;
      add(last, slot, other);  // both boxes are known, so the next stage decides
    }
  }
}

void BroadPhase::find_inner(const Slots& slots) {
  workers_.for_blocks(static_cast<int>(block_count_), [&](int index, int) {
    Block& block = blocks_[static_cast<size_t>(index)];
    block.inner.resize(block.count);
    for (size_t i = 0; i < block.count; ++i) block.inner[i] = is_inner(block.pairs[i], slots);
  });
}

/// Uses the test that lists pairs, bit for bit.
bool BroadPhase::is_inner(const SlotPair& pair, const Slots& slots) const {
  const PlacedBody &a = placed_inner_[slots.body(pair.a)], &b = placed_inner_[slots.body(pair.b)];
  const bool large_a = pair.a >= small_count_, large_b = pair.b >= small_count_;
  if (large_a && large_b) return true;
  if (large_a || large_b) {
    Eigen::Vector3f low, high;
    box_of(large_a ? pair.a : pair.b, slots, half_inner_m_, low, high);
    return reaches_box(large_a ? b : a, low, high);
  }
  const auto both = [&](float PlacedBody::*column) { return std::array{a.*column, b.*column}; };
  const auto x = both(&PlacedBody::x), y = both(&PlacedBody::y), z = both(&PlacedBody::z),
             radius = both(&PlacedBody::radius), upright = both(&PlacedBody::upright),
             mid_x = both(&PlacedBody::mid_x), mid_y = both(&PlacedBody::mid_y),
             axis_x = both(&PlacedBody::axis_x), axis_y = both(&PlacedBody::axis_y),
             half_x = both(&PlacedBody::half_x), half_y = both(&PlacedBody::half_y);
  const SlotRun other{1, 2};
  SlotPair found[1 + kPairSlack];
  uint64_t spheres = 0;
  return scalar_kernels().body_runs({x.data(), y.data(), z.data(), radius.data(), upright.data()},
                                    {mid_x.data(), mid_y.data(), axis_x.data(), axis_y.data(),
                                     half_x.data(), half_y.data()},
                                    {0, 1}, &other, 1, found, &spheres) > 0;
}

/// Box of a large body in the coordinates of the placed spheres.
void BroadPhase::box_of(size_t slot, const Slots& slots, float half_margin_m, Eigen::Vector3f& low,
                        Eigen::Vector3f& high) const {
  const float* box = posed_large_.box_of(posed_large_.of_slot(static_cast<uint32_t>(slot)));
  const Eigen::Vector3f root = (slots[slot].root() - origin_m_).cast<float>();
  low = root + Eigen::Vector3f(box[0], box[1], box[2]);
  high = root + Eigen::Vector3f(box[4], box[5], box[6]);
  // Rounding of the three sums; the radii of the crowd include their own.
  const Eigen::Vector3f slack = Eigen::Vector3f::Constant(
      0x1p-21f * (root.cwiseAbs().maxCoeff() + (high - low).maxCoeff()) + half_margin_m);
  low -= slack;
  high += slack;
}

float BroadPhase::depth_m(const SlotPair& pair, const Slots& slots) const {
  const PlacedBody &a = placed_[slots.body(pair.a)], &b = placed_[slots.body(pair.b)];
  const Eigen::Vector3f centre_a(a.x, a.y, a.z), centre_b(b.x, b.y, b.z);
  const bool large_a = pair.a >= small_count_, large_b = pair.b >= small_count_;
  if (!large_a && !large_b) return a.radius + b.radius - (centre_a - centre_b).norm();
  Eigen::Vector3f low, high;
  box_of(large_a ? pair.a : pair.b, slots, half_margin_m_, low, high);
  if (large_a && large_b) {
    Eigen::Vector3f other_low, other_high;
    box_of(pair.b, slots, half_margin_m_, other_low, other_high);
    return (high.cwiseMin(other_high) - low.cwiseMax(other_low)).minCoeff();
  }
  const Eigen::Vector3f& centre = large_a ? centre_b : centre_a;
  return (large_a ? b : a).radius - (centre - centre.cwiseMax(low).cwiseMin(high)).norm();
}

void BroadPhase::test_against_small(size_t slot, const Eigen::Vector3f& low,
                                    const Eigen::Vector3f& high, const Slots& slots) {
  const auto visit = [&](uint32_t first, uint32_t end) {
    for (uint32_t other = first; other < end; ++other) {
      Block& block = blocks_[other / PairSearcher::kBlockSlots];
      ++block.found.tests;
      const PlacedBody& p = placed_[slots.body(other)];
      if (!reaches_box(p, low, high)) continue;
      if (!passes_filter(slot, other, slots)) continue;
      add(block, slot, other);
    }
  };
  searcher_.around(low.x() - widest_m_, low.y() - widest_m_, high.x() + widest_m_,
                   high.y() + widest_m_, visit);
}

uint32_t BroadPhase::times_grown() const {
  uint32_t sum = searcher_.times_grown() + placed_.times_grown() + sizes_.times_grown() +
                 small_.times_grown() + large_.times_grown() + posed_large_.times_grown();
  sum += placed_inner_.times_grown();
  for (const Block& block : blocks_) sum += block.pairs.times_grown() + block.inner.times_grown();
  return sum;
}

}  // namespace throng
