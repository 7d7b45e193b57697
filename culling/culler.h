// Culler detects contacts between parts of different bodies: by spheres of the bodies, then by
// bounding volumes of the parts, then by triangles on request.
// Invariant: a pair whose triangles intersect is always reported, regardless of the options, unless
// the filter excludes it.
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

/// Search for candidate pairs of bodies: a uniform grid, sort and sweep, or all pairs. It changes
/// speed and counters, never a result.
enum class PairSearch { kGrid, kSweep, kBrute };

/// "grid", "sweep" or "brute".
std::string_view name_of(PairSearch search);
/// The inverse of name_of(); empty for other names.
std::optional<PairSearch> pair_search_of(std::string_view name);
std::vector<std::string> pair_search_names();

struct CullerOptions {
  /// Bounding volume of parts whose PartShape names none.
  VolumeKind part_volume = VolumeKind::kOrdop26;
  /// True: two parts are in contact if their triangles intersect. False: if their volumes overlap.
  bool exact = false;
  PairSearch pair_search = PairSearch::kGrid;
  SimdTarget simd = SimdTarget::kBest;
  /// Budgets per frame, none by default; both may be set. Pairs not refined within them are
  /// reported at the PairLevel they reached. budget_ms is the wall time of a whole pass in
  /// milliseconds; with it, results are not repeatable.
  std::optional<double> budget_ms{};
  std::optional<uint64_t> budget_tests{};  ///< number of tests of boxes, volumes and triangles
  /// Count tests per pair of parts, for part_tally(). Contacts that part volumes report are counted
  /// by triangles. Never changes a result. Not available with a budget.
  bool by_part = false;
  /// Distances in addition to contacts; by triangles with `exact`. They have a separate budget of
  /// the same size. Undecided pairs are listed with the bounds from their volumes.
  ProximityOptions proximity{};
  /// Pairs to report, as events and as distances; all by default.
  PairFilter filter{};
  /// Check that all parts lie within the RootSphere of their body, which otherwise loses pairs.
  /// Each step then poses all bodies once more; disable it once the poses are known to fit.
  bool check_spheres = true;

  bool has_budget() const { return budget_ms || budget_tests; }
};

/// Results of a culler for the latest frame. Fields are explained at the functions of Culler with
/// their names. Spans and `counters` are valid until the next step.
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
  /// Finds the contacts of one frame: of `bodies`, with part poses from `poses`. Bodies may differ
  /// from frame to frame; contacts of a missing body end. Invalidates spans returned earlier. One
  /// thread at a time may use a culler.
  virtual void step(const BodiesView& bodies, const PoseSource& poses) = 0;
  /// Ends all current contacts at the end of a run; the events are then these end events.
  virtual void finish() = 0;
  /// Reads or writes the state that later events depend on: the current contacts and the hash.
  virtual void archive(Archive& a) = 0;
  /// Returns the results of the latest step() or finish().
  virtual CullingResult frame() const = 0;
  /// Returns the counts of all frames so far, per pair of parts. Empty without
  /// CullerOptions::by_part.
  virtual PartTally part_tally() const { return {}; }
};

/// The culler of Throng: pair search, then boxes and part volumes, then triangles. step() allocates
/// memory only for a frame that is larger than all before. All results are for the latest step() or
/// finish(), unless stated otherwise.
class Culler final : public AnyCuller {
 public:
  /// `types` are the kinds of bodies; BodiesView::types are indices into them. Keeps a reference to
  /// `workers`, which must outlive the culler. Throws InputError for margins outside 0 to
  /// kMaxProximity_m and for a filter that does not match `types`. Also throws for `exact` with a
  /// type without triangles, `by_part` with a budget, contact points without `exact`, and, with
  /// `check_spheres`, a sphere that is smaller than a part.
  Culler(std::vector<std::shared_ptr<const BodyType>> types, const CullerOptions& options,
         Workers& workers);
  ~Culler() override;

  /// See AnyCuller. With `check_spheres` it throws InputError for a part outside the sphere of its
  /// body; the culler is then unchanged.
  void step(const BodiesView& bodies, const PoseSource& poses) override;
  void finish() override;
  void archive(Archive& a) override;
  CullingResult frame() const override;
  PartTally part_tally() const override;

  /// Pairs of parts in contact, sorted.
  std::span<const PairKey> pairs() const;
  /// Contacts that began or ended since the frame before, sorted by pair.
  std::span<const PairEvent> events() const;
  /// PairLevel of each of pairs(). Empty without a budget: all pairs are then decided.
  std::span<const uint8_t> levels() const;
  /// Number of contacts that were there in the frame before as well.
  uint64_t persisting() const;
  /// Pairs of parts within `proximity.margin_m`, sorted; empty if it is 0.
  ProximityRows proximity_pairs() const;
  /// Closest parts of each two moving bodies within `proximity.closest_margin_m`, sorted; empty if
  /// it is 0.
  ProximityRows closest_parts() const;
  /// One point for each of pairs() except undecided ones, sorted; empty without
  /// `proximity.contact_points`.
  std::span<const ContactPoint> contact_points() const;
  /// Tests and times of the latest step().
  const CullingCounters& counters() const;
  /// Hash of all events since construction (see event_hash.h); with a budget it includes levels.
  uint64_t hash() const;
  /// Hash of all proximity rows since construction (pair, distance bounds, level).
  uint64_t proximity_hash() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace throng
