// A way from the bodies of a frame to the pairs that touch, and what lasts from frame to frame.
// One rule: a pass says which pairs touch and what that took; the hash and what touched before are
// kept by its run.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
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
  return options.exact ? PairLevel::kTriangles : PairLevel::kPartVolume;
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

/// A pass frame by frame, with what touches, the counters and the hash of all events so far.
class PassRun {
 public:
  /// Events have this level, unless the pass gives them others.
  PassRun(std::unique_ptr<Pass> pass, PairLevel level) : pass_(std::move(pass)), events_(level) {}

  /// See AnyCuller. Throws InputError if a scale is one that floats lose pairs with.
  void step(const BodiesView& bodies, const PoseSource& source);
  void finish();
  void archive(Archive& a);
  /// Without distances.
  CullingResult frame() const;

  const Pass& pass() const { return *pass_; }
  const PairEvents& events() const { return events_; }
  const CullingCounters& counters() const { return counters_; }
  CullingCounters& counters() { return counters_; }
  uint64_t hash() const { return hash_.value(); }

 private:
  void hash_events();
  uint64_t times_grown() const { return pass_->times_grown() + events_.times_grown(); }

  std::unique_ptr<Pass> pass_;
  PairEvents events_;
  CullingCounters counters_;
  EventHash hash_;
  uint64_t frame_ = 0;
};

/// Throws InputError if a part of a type has none.
void require_triangles(BodyTypes types);
/// Throws InputError if one is negative or beyond kMaxProximity_m.
void require_margins(const ProximityOptions& proximity);

}  // namespace throng
