// Pass finds the pairs in contact in a frame; PassRun keeps contacts, counters and hash of a run.
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

/// Level of decided pairs.
inline PairLevel last_level(const CullerOptions& options) {
  return options.exact ? PairLevel::kTriangles : PairLevel::kPartVolume;
}

class Pass {
 public:
  virtual ~Pass() = default;

  /// Processes a frame: pairs to `events`, numbers (without those of the whole pass) to `counters`.
  virtual void run(const BodiesView& bodies, const PoseSource& source, PairEvents& events,
                   CullingCounters& counters) = 0;
  /// Ends all contacts at the end of the run.
  virtual void finish(PairEvents& events) { events.advance({}); }
  /// State that the next frame depends on, in addition to `touching`, which is read before.
  virtual void archive(Archive& /*a*/, std::span<const PairKey> /*touching*/) {}

  /// PairLevel of each pair in contact; empty: last_level() for all.
  virtual std::span<const uint8_t> levels() const { return {}; }
  virtual EventHashKind hash_kind() const { return EventHashKind::kEvents; }
  virtual PartTally part_tally() const { return {}; }
  virtual uint64_t times_grown() const = 0;
};

/// Runs a pass frame by frame and keeps the contacts, the counters and the hash of all events.
class PassRun {
 public:
  /// `level`: level of events that the pass does not set.
  PassRun(std::unique_ptr<Pass> pass, PairLevel level) : pass_(std::move(pass)), events_(level) {}

  /// See AnyCuller. Throws InputError if a scale is outside the supported range.
  void step(const BodiesView& bodies, const PoseSource& source);
  void finish();
  void archive(Archive& a);
  /// Latest frame without distances.
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

/// Throws InputError if a scale is outside the supported range.
void require_scales(std::span<const float> scales);
/// Throws InputError if a part has no triangles.
void require_triangles(BodyTypes types);
/// Throws InputError if a margin is negative or above kMaxProximity_m.
void require_margins(const ProximityOptions& proximity);

}  // namespace throng
