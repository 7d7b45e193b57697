#include "culling/broad_phase.h"

#include <algorithm>
#include <limits>

#include "culling/stopwatch.h"

namespace throng {
namespace {

constexpr size_t kPlaceBlock = 1024;  // bodies a task
constexpr size_t kMostLarge = 1024;   // large bodies are asked one by one
constexpr float kLargeRatio = 2;      // times the mean sphere of what moves

/// Radius of the upright cylinder around the sphere's centre that holds an unscaled body.
float upright_radius_m(const BodyType& type, const RootPose& root) {
  const bool upright = root.world_from_root.x() == 0 && root.world_from_root.y() == 0;
  if (!upright) return std::numeric_limits<float>::infinity();
  return type.sphere().upright_radius_m + type.sphere().centre_m.head<2>().norm();
}

}  // namespace

BroadPhase::BroadPhase(std::span<const std::shared_ptr<const BodyType>> types,
                       const Kernels& kernels, Workers& workers, PairSearch kind)
    : types_(types), kernels_(kernels), workers_(workers), kind_(kind) {
  counters_.volume = "sphere";
}

void BroadPhase::run(const BodiesView& bodies, const PoseSource& source, Slots& slots) {
  counters_ = {.volume = "sphere"};
  Stopwatch watch;
  place_spheres(bodies);
  split_by_size(bodies);
  searcher_.build(
      kind_, {bodies.ids.size(), x_.data(), y_.data(), z_.data(), radius_.data(), upright_.data()},
      {small_.data(), small_count_});
  slots.begin_frame(bodies.ids.size());
  for (size_t slot = 0; slot < small_count_; ++slot)
    slots.fill(slot, searcher_.body_of_slot(slot), bodies);
  for (size_t i = 0; i < large_count_; ++i) slots.fill(small_count_ + i, large_[i], bodies);
  counters_.updates = bodies.ids.size();
  counters_.update_ns = watch.lap_ns();

  block_count_ = searcher_.block_count() + 1;
  if (blocks_.size() < block_count_) blocks_.resize(block_count_);
  if (large_count_ > 0) {
    for (size_t i = 0; i < large_count_; ++i) slots.need(small_count_ + i);
    slots.pose_needed(source);
    watch.lap_ns();  // posing has its own counter
  }
  search_small(slots);
  search_large(slots);
  counters_.test_ns = watch.lap_ns();
  for (size_t i = 0; i < block_count_; ++i) {
    counters_.tests += blocks_[i].tests;
    counters_.passed += blocks_[i].count;
  }
}

void BroadPhase::place_spheres(const BodiesView& bodies) {
  const size_t n = bodies.ids.size();
  for (GrowBuffer<float>* column : {&x_, &y_, &z_, &radius_, &upright_}) column->resize(n);
  if (n == 0) return;
  // Relative to where one of the bodies is: small numbers, wherever the crowd walks.
  origin_m_ = bodies.roots[n / 2].position_m;
  workers_.for_blocks(static_cast<int>((n + kPlaceBlock - 1) / kPlaceBlock), [&](int block, int) {
    const size_t first = static_cast<size_t>(block) * kPlaceBlock,
                 end = std::min(n, first + kPlaceBlock);
    for (size_t i = first; i < end; ++i) {
      const BodyType& type = *types_[bodies.types[i]];
      const RootPose& root = bodies.roots[i];
      const float scale = bodies.scales[i];
      const Eigen::Vector3f offset =
          root.world_from_root * Eigen::Vector3f(scale * type.sphere().centre_m);
      const Eigen::Vector3f centre =
          (root.position_m - origin_m_ + offset.cast<double>()).cast<float>();
      x_[i] = centre.x();
      y_[i] = centre.y();
      z_[i] = centre.z();
      // Coordinates are rounded when stored and when the search adds and subtracts them.
      const float margin =
          body_margin_m(scale * reach_m(type)) + 0x1p-22f * centre.cwiseAbs().maxCoeff();
      radius_[i] = scale * type.sphere().radius_m + margin;
      upright_[i] = std::min(radius_[i], scale * upright_radius_m(type, root) + margin);
    }
  });
}

void BroadPhase::split_by_size(const BodiesView& bodies) {
  const size_t n = bodies.ids.size();
  small_.resize(n);
  large_.resize(n);
  small_count_ = large_count_ = 0;
  double moving_radii = 0;
  size_t moving = 0;
  for (size_t i = 0; i < n; ++i) {
    if (types_[bodies.types[i]]->is_static()) continue;
    moving_radii += static_cast<double>(radius_[i]);
    ++moving;
  }
  const float limit =
      moving == 0 ? 0
                  : kLargeRatio * static_cast<float>(moving_radii / static_cast<double>(moving));
  for (size_t i = 0; i < n; ++i) {
    if (radius_[i] > limit && large_count_ < kMostLarge) {
      large_[large_count_++] = static_cast<uint32_t>(i);
    } else {
      small_[small_count_++] = static_cast<uint32_t>(i);
    }
  }
}

void BroadPhase::search_small(Slots& slots) {
  workers_.for_blocks(static_cast<int>(searcher_.block_count()), [&](int index, int) {
    Block& block = blocks_[static_cast<size_t>(index)];
    block.tests =
        searcher_.search_block(kernels_, static_cast<size_t>(index), block.pairs, block.count);
    size_t kept = 0;
    for (size_t i = 0; i < block.count; ++i) {
      const SlotPair pair = block.pairs[i];
      if (slots.is_static(pair.a) && slots.is_static(pair.b)) continue;
      block.pairs[kept++] = pair;
      slots.need(pair.a);
      slots.need(pair.b);
    }
    block.count = kept;
  });
}

void BroadPhase::add(Block& block, size_t a, size_t b, Slots& slots) {
  block.pairs.grow(block.count + 1, block.count);
  block.pairs[block.count++] = {static_cast<uint32_t>(a), static_cast<uint32_t>(b)};
  slots.need(a);
  slots.need(b);
}

void BroadPhase::search_large(Slots& slots) {
  Block& block = blocks_[block_count_ - 1];
  block.count = 0;
  block.tests = 0;
  widest_m_ = 0;
  for (size_t i = 0; i < small_count_; ++i) widest_m_ = std::max(widest_m_, radius_[small_[i]]);
  for (size_t slot = small_count_; slot < slots.count(); ++slot) {
    Eigen::Vector3f low, high;
    box_of(slot, slots, low, high);
    meet_crowd(slot, low, high, slots, block);
    for (size_t other = slot + 1; other < slots.count(); ++other) {
      if (slots.is_static(slot) && slots.is_static(other)) continue;
      ++block.tests;
      add(block, slot, other, slots);  // both boxes are known: the next stage decides at once
    }
  }
}

/// The box of a posed body, as the spheres are placed.
void BroadPhase::box_of(size_t slot, const Slots& slots, Eigen::Vector3f& low,
                        Eigen::Vector3f& high) const {
  const float* box = slots.box_of(slot);
  const Eigen::Vector3f root = (slots[slot].root() - origin_m_).cast<float>();
  low = root + Eigen::Vector3f(box[0], box[1], box[2]);
  high = root + Eigen::Vector3f(box[4], box[5], box[6]);
  // Rounding of the three sums; the crowd's radii hold their own.
  const Eigen::Vector3f slack =
      Eigen::Vector3f::Constant(0x1p-21f * (root.cwiseAbs().maxCoeff() + (high - low).maxCoeff()));
  low -= slack;
  high += slack;
}

float BroadPhase::depth_m(const SlotPair& pair, const Slots& slots) const {
  const uint32_t a = slots[pair.a].body, b = slots[pair.b].body;
  const Eigen::Vector3f centre_a(x_[a], y_[a], z_[a]), centre_b(x_[b], y_[b], z_[b]);
  const bool large_a = pair.a >= small_count_, large_b = pair.b >= small_count_;
  if (!large_a && !large_b) return radius_[a] + radius_[b] - (centre_a - centre_b).norm();
  Eigen::Vector3f low, high;
  box_of(large_a ? pair.a : pair.b, slots, low, high);
  if (large_a && large_b) {
    Eigen::Vector3f other_low, other_high;
    box_of(pair.b, slots, other_low, other_high);
    return (high.cwiseMin(other_high) - low.cwiseMax(other_low)).minCoeff();
  }
  const Eigen::Vector3f& centre = large_a ? centre_b : centre_a;
  return radius_[large_a ? b : a] - (centre - centre.cwiseMax(low).cwiseMin(high)).norm();
}

/// The box of a large body against the spheres around it.
void BroadPhase::meet_crowd(size_t slot, const Eigen::Vector3f& low, const Eigen::Vector3f& high,
                            Slots& slots, Block& block) {
  const auto visit = [&](uint32_t first, uint32_t end) {
    block.tests += end - first;
    for (uint32_t other = first; other < end; ++other) {
      const uint32_t body = slots[other].body;
      const Eigen::Vector3f centre(x_[body], y_[body], z_[body]);
      const float distance2 = (centre - centre.cwiseMax(low).cwiseMin(high)).squaredNorm();
      if (distance2 > radius_[body] * radius_[body]) continue;
      if (slots.is_static(slot) && slots.is_static(other)) continue;
      add(block, slot, other, slots);
    }
  };
  searcher_.around(low.x() - widest_m_, low.y() - widest_m_, high.x() + widest_m_,
                   high.y() + widest_m_, visit);
}

uint32_t BroadPhase::times_grown() const {
  uint32_t sum = searcher_.times_grown() + x_.times_grown() + y_.times_grown() + z_.times_grown() +
                 radius_.times_grown() + upright_.times_grown() + small_.times_grown() +
                 large_.times_grown();
  for (const Block& block : blocks_) sum += block.pairs.times_grown();
  return sum;
}

}  // namespace throng
