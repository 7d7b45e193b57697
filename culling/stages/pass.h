// A way from the bodies of a frame to the pairs that touch: the pipeline, the pipeline under a
// deadline, or a strategy of the paper.
// One rule: a pass says which pairs touch and what that took; the hash and what touched before are
// the culler's.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/workers.h"
#include "culling/bodies.h"
#include "culling/culler.h"
#include "culling/event_hash.h"
#include "culling/stages/pair_events.h"

namespace throng {

using BodyTypes = std::span<const std::shared_ptr<const BodyType>>;

/// How far a pass refines what it decides.
inline PairLevel last_level(const CullerOptions& options) {
  if (options.strategy == Strategy::kSphere) return PairLevel::kSphere;
  return options.exact ? PairLevel::kExact : PairLevel::kPartVolume;
}

class Pass {
 public:
  virtual ~Pass() = default;

  /// One frame: its pairs to `events`, its numbers to `counters`, but for the sums over the whole
  /// pass.
  virtual void run(const BodiesView& bodies, const PoseSource& source, PairEvents& events,
                   CullingCounters& counters) = 0;
  /// The run stops: everything ends.
  virtual void finish(PairEvents& events) { events.advance({}); }
  /// What the next frame depends on besides the pairs that touch, which are read before.
  virtual void archive(Archive& /*a*/, std::span<const PairKey> /*touching*/) {}

  /// PairLevel of each of the pairs that touch; empty: last_level().
  virtual std::span<const uint8_t> levels() const { return {}; }
  virtual EventHashKind hash_kind() const { return EventHashKind::kEvents; }
  virtual PartTally part_tally() const { return {}; }
  virtual uint64_t times_grown() const = 0;
};

}  // namespace throng
