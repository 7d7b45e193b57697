// One culling pass: spheres over bodies, then volumes over parts, then triangles where asked.
// One rule: a pair whose triangles intersect is always reported, whatever the options.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/simd.h"
#include "base/workers.h"
#include "culling/bodies.h"
#include "culling/body_type.h"
#include "culling/counters.h"
#include "culling/pair.h"
#include "culling/pair_filter.h"
#include "culling/part_tally.h"
#include "culling/proximity.h"
#include "culling/volumes/volume_kind.h"

namespace throng {

enum class PairSearch { kGrid, kSweep, kBrute };

/// "grid", "sweep", "brute".
std::string_view name_of(PairSearch search);
std::optional<PairSearch> pair_search_of(std::string_view name);
std::vector<std::string> pair_search_names();

struct CullerOptions {
  VolumeKind part_volume = VolumeKind::kOrdop26;
  bool exact = false;  ///< decide the surviving pairs by their triangles
  PairSearch pair_search = PairSearch::kGrid;
  SimdTarget simd = SimdTarget::kBest;
  /// A frame's budget after the pair search: when it is up, what is not refined is reported at the
  /// level it reached. Both may be given.
  std::optional<double> budget_ms{};       ///< of a whole pass, by the clock: not repeatable
  std::optional<uint64_t> budget_tests{};  ///< of boxes, part volumes and triangles together
  /// Counts by pair of parts, too, and judges by triangles what the part volumes report; see
  /// part_tally(). Never changes a result. Only without a deadline.
  bool by_part = false;
  /// Distances beside what touches; by triangles with `exact`. A deadline counts for them again, by
  /// itself: what it leaves undecided is listed with what its volumes prove.
  ProximityOptions proximity{};
  /// What is asked for, of events and of distances alike.
  PairFilter filter{};

  bool has_budget() const { return budget_ms || budget_tests; }
};

/// The latest frame of a culler; see the functions of Culler of the same names. Spans are valid
/// until the next step.
struct CullingResult {
  std::span<const PairKey> pairs;
  std::span<const PairEvent> events;
  std::span<const uint8_t> levels;
  uint64_t persisting = 0;
  ProximityRows proximity_pairs, closest_parts;
  std::span<const ContactPoint> contact_points;
  const CullingCounters* counters = nullptr;
  uint64_t hash = 0;
  uint64_t proximity_hash = 0;
};

/// What all cullers do, for callers that choose one at run time.
class AnyCuller {
 public:
  virtual ~AnyCuller() = default;
  /// One frame. Spans returned earlier become invalid.
  virtual void step(const BodiesView& bodies, const PoseSource& poses) = 0;
  /// Ends every pair that still touches (the run stops): events() then holds the ends.
  virtual void finish() = 0;
  /// What touches and the hash so far: all that later events depend on. Everything else is scratch.
  virtual void archive(Archive& a) = 0;
  virtual CullingResult frame() const = 0;
  /// All frames so far, by pair of parts; empty without CullerOptions::by_part.
  virtual PartTally part_tally() const { return {}; }
};

class Culler final : public AnyCuller {
 public:
  /// Keeps a reference to `workers`. Throws InputError if exact is asked of a type without
  /// triangles; if by_part is asked under a deadline; if margins are negative or infinite; if
  /// contact points are asked without exact; if the types and parts of a filter are not those of
  /// `types`.
  Culler(std::vector<std::shared_ptr<const BodyType>> types, const CullerOptions& options,
         Workers& workers);
  ~Culler() override;

  void step(const BodiesView& bodies, const PoseSource& poses) override;
  void finish() override;
  void archive(Archive& a) override;
  CullingResult frame() const override;
  PartTally part_tally() const override;

  std::span<const PairKey> pairs() const;
  std::span<const PairEvent> events() const;
  /// PairLevel of each of pairs(). Empty where everything is decided: without a deadline.
  std::span<const uint8_t> levels() const;
  uint64_t persisting() const;
  /// The pairs of parts within `proximity.margin_m`, and of each two bodies within
  /// `proximity.closest_margin_m` the nearest pair; sorted.
  ProximityRows proximity_pairs() const;
  ProximityRows closest_parts() const;
  /// One for each of pairs(), where `proximity.contact_points` asks for them; under a deadline none
  /// of what it leaves undecided.
  std::span<const ContactPoint> contact_points() const;
  const CullingCounters& counters() const;
  /// Of every event so far (see event_hash.h); with a deadline, levels count.
  uint64_t hash() const;
  /// Of every near row so far: its pair, interval and level. hash() is the same with and without
  /// margins.
  uint64_t proximity_hash() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace throng
