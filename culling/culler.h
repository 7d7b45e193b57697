// Culler detects contacts: spheres of bodies, then volumes of parts, then triangles on request.
// Invariant: a pair whose triangles intersect is always reported, regardless of the options.
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

/// "grid", "sweep" or "brute".
std::string_view name_of(PairSearch search);
std::optional<PairSearch> pair_search_of(std::string_view name);
std::vector<std::string> pair_search_names();

struct CullerOptions {
  VolumeKind part_volume = VolumeKind::kOrdop26;
  bool exact = false;  ///< test the triangles of the surviving pairs
  PairSearch pair_search = PairSearch::kGrid;
  SimdTarget simd = SimdTarget::kBest;
  /// Budgets per frame; both may be set. Pairs not refined within them are reported at the level
  /// they reached. With budget_ms, the time of a whole pass in ms, results are not repeatable.
  std::optional<double> budget_ms{};
  std::optional<uint64_t> budget_tests{};  ///< tests of boxes, volumes and triangles
  /// Count per pair of parts, and test with triangles the contacts that part volumes report; see
  /// part_tally(). Never changes a result. Not available with a budget.
  bool by_part = false;
  /// Distances in addition to contacts; by triangles with `exact`. They have a separate budget of
  /// the same size. Undecided pairs are listed with the bounds from their volumes.
  ProximityOptions proximity{};
  /// Pairs to report, as events and as distances.
  PairFilter filter{};

  bool has_budget() const { return budget_ms || budget_tests; }
};

/// Latest frame of a culler, as the functions of Culler. Spans are valid until the next step.
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

/// Interface of all cullers, for callers that choose one at run time.
class AnyCuller {
 public:
  virtual ~AnyCuller() = default;
  /// Processes one frame. Invalidates spans returned earlier.
  virtual void step(const BodiesView& bodies, const PoseSource& poses) = 0;
  /// Ends all current contacts at the end of a run; events() then holds the end events.
  virtual void finish() = 0;
  /// Reads or writes the state that later events depend on: the current contacts and the hash.
  virtual void archive(Archive& a) = 0;
  virtual CullingResult frame() const = 0;
  /// Counts of all frames so far, per pair of parts; empty without CullerOptions::by_part.
  virtual PartTally part_tally() const { return {}; }
};

class Culler final : public AnyCuller {
 public:
  /// Keeps a reference to `workers`. Throws InputError for negative or too large margins, and for a
  /// filter that does not match `types`. Also throws for `exact` with a type without triangles,
  /// `by_part` with a budget, and contact points without `exact`.
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
  /// PairLevel of each of pairs(). Empty without a budget: all pairs are then decided.
  std::span<const uint8_t> levels() const;
  uint64_t persisting() const;
  /// Pairs of parts within `proximity.margin_m`, and the closest parts of each two bodies within
  /// `proximity.closest_margin_m`; sorted.
  ProximityRows proximity_pairs() const;
  ProximityRows closest_parts() const;
  /// One point for each of pairs() if `proximity.contact_points`; none for undecided pairs.
  std::span<const ContactPoint> contact_points() const;
  const CullingCounters& counters() const;
  /// Hash of all events so far (see event_hash.h); with a budget it includes levels.
  uint64_t hash() const;
  /// Hash of all proximity rows so far (pair, distance bounds, level). Does not affect hash().
  uint64_t proximity_hash() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace throng
