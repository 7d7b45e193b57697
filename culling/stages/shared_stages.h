// SharedStages places and searches bodies, and keeps the type data that refinement reads.
#pragma once

#include <cstdint>
#include <vector>

#include "base/workers.h"
#include "culling/kernels/kernels.h"
#include "culling/stages/broad_phase.h"
#include "culling/stages/mid_phase.h"
#include "culling/stages/pass.h"
#include "culling/stages/posed_bodies.h"
#include "culling/stages/slots.h"

namespace throng {

class SharedStages {
 public:
  /// Keeps references to `types` and `workers`. Also searches bodies within the margins.
  SharedStages(BodyTypes types, const CullerOptions& options, Workers& workers,
               const Margins& margins = {});

  /// Places the bodies of a frame and lists the pairs that may touch.
  void search(const BodiesView& bodies, const PoseSource& source) {
    broad_.run(bodies, source, slots_);
  }
  const Slots& slots() const { return slots_; }
  const BroadPhase& broad() const { return broad_; }

  PosedBodies::Frame posing(const PoseSource& source) const {
    return {types_, kernels_, slots_, source};
  }
  MidPhaseFrame parts() const {
    return {types_,   shape_type_, type_first_shape_,   type_parts_, &kernels_,
            &filter_, volume_,     volumes_.size() > 1, exact_};
  }
  void count(const MidPhaseCounters& parts, const PosedBodies::Counters& posed,
             CullingCounters& counters) const;
  uint64_t times_grown() const { return uint64_t{slots_.times_grown()} + broad_.times_grown(); }

 private:
  BodyTypes types_;
  const Kernels& kernels_;
  VolumeKind volume_;
  std::vector<VolumeKind> volumes_;  // volumes of all parts, without duplicates
  bool exact_;
  PairFilter filter_;
  // By type or by shape: data that kernels read instead of BodyType.
  std::vector<uint16_t> type_parts_, type_first_shape_, shape_type_;
  Slots slots_;
  BroadPhase broad_;
};

}  // namespace throng
