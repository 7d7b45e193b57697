#include "culling/culler.h"

#include <algorithm>
#include <array>
#include <utility>

#include "base/errors.h"
#include "culling/distance/proximity_search.h"
#include "culling/stages/budgeted_pass.h"
#include "culling/stages/pass.h"
#include "culling/stages/pipeline.h"
#include "culling/stages/sphere_check.h"

namespace throng {
namespace {

/// Names in the order of PairSearch.
constexpr std::array<std::string_view, 3> kPairSearches = {"grid", "sweep", "brute"};

void require_tally(const CullerOptions& options) {
  if (options.by_part && options.has_budget())
    throw InputError("counts by part pair", "the pipeline without a budget", "a budget");
}

void require_filter(BodyTypes types, const CullerOptions& options) {
  if (options.filter.is_empty()) return;
  const auto& sides_of_part = options.filter.sides_of_part;
  bool fits = sides_of_part.empty() || sides_of_part.size() == types.size();
  for (size_t type = 0; fits && type < sides_of_part.size(); ++type)
    fits = sides_of_part[type].size() == types[type]->parts().size();
  if (!fits)
    throw InputError("pair filter", "sides of every part of every type", "another number of parts");
}

std::unique_ptr<ProximitySearch> make_proximity_search(BodyTypes types,
                                                       const CullerOptions& options,
                                                       Workers& workers) {
  require_margins(options.proximity);
  if (!options.proximity.needs_search()) return nullptr;
  if (options.proximity.contact_points && !options.exact)
    throw InputError("contact points", "exact contacts (--exact, or culling: {exact: true})",
                     "contacts of part volumes, which have no contact points");
  return std::make_unique<ProximitySearch>(types, options, workers);
}

std::unique_ptr<Pass> make_pass(BodyTypes types, const CullerOptions& options, Workers& workers,
                                ProximitySearch* proximity) {
  if (options.exact) require_triangles(types);
  require_tally(options);
  require_filter(types, options);
  if (options.has_budget()) return std::make_unique<BudgetedPass>(types, options, workers);
  return std::make_unique<Pipeline>(types, options, workers, proximity);
}

}  // namespace

std::string_view name_of(PairSearch search) { return kPairSearches[static_cast<size_t>(search)]; }

std::optional<PairSearch> pair_search_of(std::string_view name) {
  const auto found = std::find(kPairSearches.begin(), kPairSearches.end(), name);
  if (found == kPairSearches.end()) return std::nullopt;
  return static_cast<PairSearch>(found - kPairSearches.begin());
}

std::vector<std::string> pair_search_names() {
  return {kPairSearches.begin(), kPairSearches.end()};
}

struct Culler::State {
  State(std::vector<std::shared_ptr<const BodyType>> body_types, const CullerOptions& options,
        Workers& workers)
      : types(std::move(body_types)),
        proximity(make_proximity_search(types, options, workers)),
        run(make_pass(types, options, workers, proximity.get()), last_level(options)) {
    if (proximity && options.has_budget())
      budgeted_proximity = std::make_unique<BudgetedProximity>(types, options, workers, *proximity);
    if (!options.check_spheres) return;
    require_wide_spheres(types);
    sphere_check.emplace(types, workers);
  }

  uint64_t proximity_times_grown() const {
    return (proximity ? proximity->times_grown() : 0) +
           (budgeted_proximity ? budgeted_proximity->times_grown() : 0);
  }

  std::vector<std::shared_ptr<const BodyType>> types;
  std::unique_ptr<ProximitySearch> proximity;  // null if no distances are requested
  PassRun run;
  std::unique_ptr<BudgetedProximity>
      budgeted_proximity;  // with a budget; otherwise the pass itself computes distances
  std::optional<SphereCheck> sphere_check;
};

Culler::Culler(std::vector<std::shared_ptr<const BodyType>> types, const CullerOptions& options,
               Workers& workers)
    : state_(std::make_unique<State>(std::move(types), options, workers)) {}

Culler::~Culler() = default;

void Culler::step(const BodiesView& bodies, const PoseSource& poses) {
  State& s = *state_;
  require_scales(bodies.scales);
  if (s.sphere_check) s.sphere_check->run(bodies, poses);
  const uint64_t grown_before = s.proximity_times_grown();
  s.run.step(bodies, poses);
  CullingCounters& counters = s.run.counters();
  if (s.budgeted_proximity) {
    s.budgeted_proximity->run(bodies, poses, counters.proximity);
    s.proximity->keep_contact_points(s.run.events().touching());
  }
  counters.buffers_grown += s.proximity_times_grown() - grown_before;
}

void Culler::finish() { state_->run.finish(); }

void Culler::archive(Archive& a) {
  state_->run.archive(a);
  if (state_->proximity) state_->proximity->archive(a);
}

CullingResult Culler::frame() const {
  CullingResult frame = state_->run.frame();
  frame.proximity_pairs = proximity_pairs();
  frame.closest_parts = closest_parts();
  frame.contact_points = contact_points();
  frame.proximity_hash = proximity_hash();
  return frame;
}

std::span<const PairKey> Culler::pairs() const { return state_->run.events().touching(); }
std::span<const PairEvent> Culler::events() const { return state_->run.events().events(); }
std::span<const uint8_t> Culler::levels() const { return state_->run.pass().levels(); }
ProximityRows Culler::proximity_pairs() const {
  return state_->proximity ? state_->proximity->pairs() : ProximityRows();
}
ProximityRows Culler::closest_parts() const {
  return state_->proximity ? state_->proximity->bodies() : ProximityRows();
}
std::span<const ContactPoint> Culler::contact_points() const {
  return state_->proximity ? state_->proximity->contact_points() : std::span<const ContactPoint>();
}
uint64_t Culler::proximity_hash() const {
  return state_->proximity ? state_->proximity->hash() : 0;
}
uint64_t Culler::persisting() const { return state_->run.events().persisting(); }
const CullingCounters& Culler::counters() const { return state_->run.counters(); }
uint64_t Culler::hash() const { return state_->run.hash(); }
PartTally Culler::part_tally() const { return state_->run.pass().part_tally(); }

}  // namespace throng
