// The paper's strategies over the bodies of a frame: spheres of bodies, volumes of parts, on one
// thread and without any of our short cuts.
// One rule: strategies that end in the same volume find the same pairs, but for what spheres rule
// out; updates and tests are counted where they happen.
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

  /// `strategy` is not kPipeline (asserted). options.pair_search counts for kTwoPass and
  /// kSphere only; kBrute is the paper's. Keeps a reference to `types`.
  static std::unique_ptr<PaperSearch> make(Strategy strategy, const CullerOptions& options,
                                           BodyTypes types);

  /// One frame.
  virtual void run(const BodiesView& bodies, const PoseSource& source) = 0;

  /// Sorted; a() and b() are body indices. Of kSphere the parts are kWholeBody.
  virtual std::span<const PairKey> pairs() const = 0;
  /// Of the frame: spheres over bodies; volumes over parts. Where one is tested right after the
  /// other their time stands under the spheres.
  virtual const StageCounters& spheres() const = 0;
  virtual const StageCounters& volumes() const = 0;
  virtual const StageCounters& triangles() const = 0;
  virtual uint64_t primitive_tests() const = 0;
  virtual uint64_t posed_bodies() const = 0;
  virtual uint64_t times_grown() const = 0;
};

}  // namespace throng
