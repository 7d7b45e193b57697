// PaperSearch runs the paper's strategies on one thread: spheres of bodies, volumes of parts.
// Invariant: strategies with the same final volume differ only in pairs that spheres exclude.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "culling/stages/pass.h"
#include "culling/strategies/strategy.h"

namespace throng {

class PaperSearch {
 public:
  virtual ~PaperSearch() = default;

  /// `strategy` is not kPipeline (asserted). options.pair_search applies to kTwoPass and kSphere
  /// only; kBrute is the paper's. Keeps a reference to `types`.
  static std::unique_ptr<PaperSearch> make(Strategy strategy, const CullerOptions& options,
                                           BodyTypes types);

  virtual void run(const BodiesView& bodies, const PoseSource& source) = 0;

  /// Sorted; a() and b() are body indices. For kSphere the parts are kWholeBody.
  virtual std::span<const PairKey> pairs() const = 0;
  /// Counters of the frame: spheres of bodies; volumes of parts. If a strategy tests both pair by
  /// pair, their time is counted as spheres.
  virtual const StageCounters& spheres() const = 0;
  virtual const StageCounters& volumes() const = 0;
  virtual const StageCounters& triangles() const = 0;
  virtual uint64_t primitive_tests() const = 0;
  virtual uint64_t posed_bodies() const = 0;
  virtual uint64_t times_grown() const = 0;
};

}  // namespace throng
