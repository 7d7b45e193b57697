// BroadPhase places every body and lists pairs of slots that may touch. Few large bodies (walls,
// stands) are tested with their boxes, because their spheres would overlap all others.
// Invariant: the large bodies, and the pairs listed for one margin, do not depend on other margins.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/workers.h"
#include "culling/culler.h"
#include "culling/stages/pair_search.h"
#include "culling/stages/posed_bodies.h"
#include "culling/stages/slots.h"

namespace throng {

/// Distances within which bodies and parts are listed.
struct Margins {
  float reach_m = 0;
  /// The smaller of two margins; 0 if fewer than two are set.
  float inner_m = 0;
};

class BroadPhase {
 public:
  /// Also lists bodies within the margins. Keeps references to `workers` and `filter`.
  BroadPhase(std::span<const std::shared_ptr<const BodyType>> types, const Kernels& kernels,
             Workers& workers, PairSearch kind, const PairFilter& filter, const Margins& margins);

  /// Places the bodies, fills `slots` in search order and lists the pairs.
  void run(const BodiesView& bodies, const PoseSource& source, Slots& slots);

  /// Pairs by the slot of the body that is not large; last, pairs of two large bodies.
  size_t block_count() const { return block_count_; }
  std::span<const SlotPair> block(size_t i) const {
    return {blocks_[i].pairs.data(), blocks_[i].count};
  }

  /// Flag per pair of the block: also listed for the inner margin. Empty without an inner margin.
  std::span<const uint8_t> inner(size_t i) const {
    return {blocks_[i].inner.data(), has_inner_ ? blocks_[i].count : 0};
  }

  /// Overlap of the two bodies of a listed pair by the test that listed them: spheres, or a large
  /// body's box. Not negative except for rounding.
  float depth_m(const SlotPair& pair, const Slots& slots) const;

  const StageCounters& counters() const { return counters_; }
  /// Pairs with overlapping spheres whose bounds() boxes do not overlap.
  uint64_t apart_by_bounds() const { return counters_.passed - listed_; }
  uint32_t times_grown() const;

 private:
  struct Block {
    GrowBuffer<SlotPair> pairs;
    GrowBuffer<uint8_t> inner;
    size_t count = 0;
    PairSearcher::BlockCounts found;
  };
  struct TypeSize {
    Eigen::Vector3f centre_m;
    float radius_m, upright_m, margin_m;
    bool is_static;
  };
  struct Sizes {
    double radii = 0;  ///< sum of radii of moving bodies, without a margin
    size_t moving = 0;
    float widest_m = 0;  ///< largest radius of all bodies, without a margin
  };

  void place(const BodiesView& bodies, const PoseSource& source);
  void place_body(const RootPose& root, float scale, const TypeSize& type, const RootBox& bounds,
                  float half_margin_m, PlacedBody& out) const;
  float own_radius(size_t body, const BodiesView& bodies) const;
  void split_by_size(const BodiesView& bodies);
  void search_small(const Slots& slots);
  void search_large(const PoseSource& source, const Slots& slots);
  void find_inner(const Slots& slots);
  bool is_inner(const SlotPair& pair, const Slots& slots) const;
  void box_of(size_t slot, const Slots& slots, float half_margin_m, Eigen::Vector3f& low,
              Eigen::Vector3f& high) const;
  void test_against_small(size_t slot, const Eigen::Vector3f& low, const Eigen::Vector3f& high,
                          const Slots& slots);
  void add(Block& block, size_t a, size_t b);
  bool passes_filter(size_t slot_a, size_t slot_b, const Slots& slots) const;

  std::span<const std::shared_ptr<const BodyType>> types_;
  const Kernels& kernels_;
  Workers& workers_;
  PairSearch kind_;
  const PairFilter& filter_;
  float half_margin_m_;  // added to the radius of every body
  bool has_inner_;
  float half_inner_m_;  // the same for the inner margin
  std::vector<TypeSize> sizes_of_type_;
  bool any_static_ = false;
  Eigen::Vector3d origin_m_ = Eigen::Vector3d::Zero();  // origin of the coordinates of placed_
  size_t body_count_ = 0;
  GrowBuffer<PlacedBody> placed_;        // by body
  GrowBuffer<PlacedBody> placed_inner_;  // by body, for the inner margin
  GrowBuffer<Sizes> sizes_;              // by task of place()
  GrowBuffer<uint32_t> small_, large_;   // bodies, ascending
  size_t small_count_ = 0, large_count_ = 0;
  float widest_m_ = 0;  // upper bound of the small bodies' radii
  PairSearcher searcher_;
  PosedBodies posed_large_;
  // by block of the pair search; the last holds pairs of two large bodies
  std::vector<Block> blocks_;
  size_t block_count_ = 0;
  uint64_t listed_ = 0;
  StageCounters counters_;
};

}  // namespace throng
