// One culling pass: spheres over bodies, then volumes over parts, then triangles where asked.
// One rule: a pair whose triangles intersect is always reported, whatever the options.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "base/files/archive.h"
#include "base/pose.h"
#include "base/simd.h"
#include "base/workers.h"
#include "culling/body_type.h"
#include "culling/pair_level.h"
#include "culling/stages/pair_events.h"
#include "culling/strategies/strategy.h"
#include "culling/volumes/volume_kind.h"

namespace throng {

/// The bodies of a frame, structure of arrays, all of the same length.
struct BodiesView {
  std::span<const uint32_t> ids;    ///< strictly ascending, at most PairKey::kMaxId
  std::span<const uint16_t> types;  ///< index into the culler's body types
  std::span<const float> scales;
  std::span<const RootPose> roots;
};

/// Poses the parts of bodies on demand: only bodies in a surviving pair are ever asked for.
class PoseSource {
 public:
  virtual ~PoseSource() = default;
  /// Writes part_count poses for each of `bodies` (indices into the BodiesView, all of one type, at
  /// most kMaxBatch), body-major. Called from several threads at once.
  virtual void poses(std::span<const uint32_t> bodies, std::span<PartPose> out) const = 0;
  /// Writes a box for each of `bodies` (of any type, at most kMaxBatch) that holds every point of
  /// the body in the pose that poses() would give it now: far cheaper than posing it, far tighter
  /// than the sphere of all postures. A box left unknown costs nothing but time. Called from
  /// several threads at once.
  virtual void bounds(std::span<const uint32_t> /*bodies*/, std::span<RootBox> out) const {
    std::fill(out.begin(), out.end(), RootBox{});
  }
  static constexpr int kMaxBatch = 128;
};

enum class PairSearch { kGrid, kSweep, kBrute };

struct CullerOptions {
  VolumeKind part_volume = VolumeKind::kOrdop26;
  bool exact = false;  ///< decide the surviving pairs by their triangles
  PairSearch pair_search = PairSearch::kGrid;
  SimdTarget simd = SimdTarget::kBest;
  /// A frame's budget after the pair search: when it is up, what is not refined is reported at the
  /// level it reached. Both may be given.
  std::optional<double> deadline_ms{};       ///< of a whole pass, by the clock: not repeatable
  std::optional<uint64_t> deadline_tests{};  ///< of boxes, part volumes and triangles together
  /// The paper's recipes run on one thread and know no deadline (asserted).
  Strategy strategy = Strategy::kPipeline;
};

/// One stage's N and time: the paper's N_u, C_u, N_v, C_v (N_p, C_p for triangles).
struct StageCounters {
  std::string_view volume;  ///< "sphere", "aabb", "ordop26", "triangles"
  uint64_t updates = 0;
  uint64_t tests = 0;
  uint64_t passed = 0;
  double update_ns = 0;  ///< summed over threads
  double test_ns = 0;
};

struct CullingCounters {
  StageCounters avatar;          ///< spheres over bodies
  StageCounters body_box;        ///< what bounds() says of a body, then its box in its pose
  StageCounters box;             ///< boxes over the parts of pairs whose body boxes overlap
  StageCounters part;            ///< the part volume over surviving parts
  StageCounters exact;           ///< triangles
  uint64_t primitive_tests = 0;  ///< boxes and triangles inside the exact stage: the paper's N_p
  std::array<uint64_t, kPairLevels> levels{};  ///< pairs reported at each PairLevel
  uint64_t posed_bodies = 0;
  double pose_ns = 0;  ///< time inside PoseSource, summed over threads
  double events_ns = 0;
  double wall_ns = 0;              ///< the whole pass
  uint64_t allocations_grown = 0;  ///< buffers that had to grow in this pass
};

class Culler {
 public:
  /// Keeps a reference to `workers`. Throws InputError if exact is asked of a type without
  /// triangles, or of spheres alone.
  Culler(std::vector<std::shared_ptr<const BodyType>> types, const CullerOptions& options,
         Workers& workers);
  ~Culler();

  /// One frame. Spans returned earlier become invalid.
  void step(const BodiesView& bodies, const PoseSource& poses);
  /// Ends every pair that still touches (the run stops): events() then holds the ends.
  void finish();

  /// What touches and the hash so far: all that later events depend on. Everything else is scratch.
  void archive(Archive& a);

  std::span<const PairKey> pairs() const;
  std::span<const PairEvent> events() const;
  /// PairLevel of each of pairs(), and of each of events() (an end: at which it was last reported).
  /// Empty where everything is decided: without a deadline, unless spheres alone are tested.
  std::span<const uint8_t> levels() const;
  std::span<const uint8_t> event_levels() const;
  uint64_t persisting() const;
  const CullingCounters& counters() const;
  /// Of every event so far (see event_hash.h); with a deadline, levels count.
  uint64_t hash() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace throng
