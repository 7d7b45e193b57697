// Broad phase: one sphere a body, and the pairs of slots that may touch.
// One rule: bodies of usual size go through the pair search; the few large ones (walls, stands)
// meet the crowd with their boxes, because their spheres would touch everybody.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/workers.h"
#include "culling/culler.h"
#include "culling/pair_search.h"
#include "culling/slots.h"

namespace throng {

class BroadPhase {
 public:
  BroadPhase(std::span<const std::shared_ptr<const BodyType>> types, const Kernels& kernels,
             Workers& workers, PairSearch kind);

  /// Places the spheres, fills `slots` in the order of the search, lists the pairs and marks their
  /// bodies as needed. Poses large bodies on the way.
  void run(const BodiesView& bodies, const PoseSource& source, Slots& slots);

  size_t block_count() const { return block_count_; }
  std::span<const SlotPair> block(size_t i) const {
    return {blocks_[i].pairs.data(), blocks_[i].count};
  }

  /// How deep two bodies of a listed pair overlap by what listed them: their spheres, or a large
  /// body's box. Not negative beyond rounding.
  float depth_m(const SlotPair& pair, const Slots& slots) const;

  const StageCounters& counters() const { return counters_; }
  uint32_t times_grown() const;

 private:
  struct Block {
    GrowBuffer<SlotPair> pairs;
    size_t count = 0;
    uint64_t tests = 0;
  };

  void place_spheres(const BodiesView& bodies);
  void split_by_size(const BodiesView& bodies);
  void search_small(Slots& slots);
  void search_large(Slots& slots);
  void box_of(size_t slot, const Slots& slots, Eigen::Vector3f& low, Eigen::Vector3f& high) const;
  void meet_crowd(size_t slot, const Eigen::Vector3f& low, const Eigen::Vector3f& high,
                  Slots& slots, Block& block);
  void add(Block& block, size_t a, size_t b, Slots& slots);

  std::span<const std::shared_ptr<const BodyType>> types_;
  const Kernels& kernels_;
  Workers& workers_;
  PairSearch kind_;
  Eigen::Vector3d origin_m_ = Eigen::Vector3d::Zero();  // of the sphere coordinates
  GrowBuffer<float> x_, y_, z_, radius_, upright_;      // by body
  GrowBuffer<uint32_t> small_, large_;                  // bodies, ascending
  size_t small_count_ = 0, large_count_ = 0;
  float widest_m_ = 0;  // the largest sphere among the small bodies
  PairSearcher searcher_;
  std::vector<Block> blocks_;  // of the pair search; the last holds the pairs with large bodies
  size_t block_count_ = 0;
  StageCounters counters_;
};

}  // namespace throng
