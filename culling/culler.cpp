#include "culling/culler.h"

#include <algorithm>
#include <array>
#include <utility>

#include "base/errors.h"
#include "culling/distance/near_search.h"
#include "culling/stages/deadline.h"
#include "culling/stages/pass.h"
#include "culling/stages/pipeline.h"

namespace throng {
namespace {

/// By PairSearch.
constexpr std::array<std::string_view, 3> kPairSearches = {"grid", "sweep", "brute"};

void require_tally(const CullerOptions& options) {
  if (options.by_part && options.has_deadline())
    throw InputError("counts by part", "the pipeline without a deadline", "a deadline");
}

void require_filter(BodyTypes types, const CullerOptions& options) {
  if (options.filter.is_empty()) return;
  const auto& of_part = options.filter.of_part;
  bool fits = of_part.empty() || of_part.size() == types.size();
  for (size_t type = 0; fits && type < of_part.size(); ++type)
    fits = of_part[type].size() == types[type]->parts().size();
  if (!fits) throw InputError("a filter", "sides of every part of every type", "others");
}

std::unique_ptr<NearSearch> make_near(BodyTypes types, const CullerOptions& options,
                                      Workers& workers) {
  require_margins(options.near);
  if (!options.near.needs_search()) return nullptr;
  if (options.near.contact_points && !options.exact)
    throw InputError("contact points", "exact contacts (--exact, or culling: {exact: true})",
                     "contacts of volumes, which have none");
  return std::make_unique<NearSearch>(types, options, workers);
}

std::unique_ptr<Pass> make_pass(BodyTypes types, const CullerOptions& options, Workers& workers,
                                NearSearch* near) {
  if (options.exact) require_triangles(types);
  require_tally(options);
  require_filter(types, options);
  if (options.has_deadline()) return std::make_unique<Deadline>(types, options, workers);
  return std::make_unique<Pipeline>(types, options, workers, near);
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
        near(make_near(types, options, workers)),
        run(make_pass(types, options, workers, near.get()), last_level(options)) {
    if (near && options.has_deadline())
      near_alone = std::make_unique<NearAlone>(types, options, workers, *near);
  }

  uint64_t near_grown() const {
    return (near ? near->times_grown() : 0) + (near_alone ? near_alone->times_grown() : 0);
  }

  std::vector<std::shared_ptr<const BodyType>> types;
  std::unique_ptr<NearSearch> near;  // null where no distance is asked
  PassRun run;
  std::unique_ptr<NearAlone> near_alone;  // under a deadline; else the pass finds distances, too
};

Culler::Culler(std::vector<std::shared_ptr<const BodyType>> types, const CullerOptions& options,
               Workers& workers)
    : state_(std::make_unique<State>(std::move(types), options, workers)) {}

Culler::~Culler() = default;

void Culler::step(const BodiesView& bodies, const PoseSource& poses) {
  State& s = *state_;
  const uint64_t grown_before = s.near_grown();
  s.run.step(bodies, poses);
  CullingCounters& counters = s.run.counters();
  if (s.near_alone) {
    s.near_alone->run(bodies, poses, counters.near);
    s.near->keep_contact_points(s.run.events().touching());
  }
  counters.allocations_grown += s.near_grown() - grown_before;
}

void Culler::finish() { state_->run.finish(); }

void Culler::archive(Archive& a) {
  state_->run.archive(a);
  if (state_->near) state_->near->archive(a);
}

CullingResult Culler::frame() const {
  CullingResult frame = state_->run.frame();
  frame.near_pairs = near_pairs();
  frame.near_bodies = near_bodies();
  frame.contact_points = contact_points();
  frame.near_hash = near_hash();
  return frame;
}

std::span<const PairKey> Culler::pairs() const { return state_->run.events().touching(); }
std::span<const PairEvent> Culler::events() const { return state_->run.events().events(); }
std::span<const uint8_t> Culler::levels() const { return state_->run.pass().levels(); }
NearRows Culler::near_pairs() const { return state_->near ? state_->near->pairs() : NearRows(); }
NearRows Culler::near_bodies() const { return state_->near ? state_->near->bodies() : NearRows(); }
std::span<const ContactPoint> Culler::contact_points() const {
  return state_->near ? state_->near->contact_points() : std::span<const ContactPoint>();
}
uint64_t Culler::near_hash() const { return state_->near ? state_->near->hash() : 0; }
uint64_t Culler::persisting() const { return state_->run.events().persisting(); }
const CullingCounters& Culler::counters() const { return state_->run.counters(); }
uint64_t Culler::hash() const { return state_->run.hash(); }
PartTally Culler::part_tally() const { return state_->run.pass().part_tally(); }

}  // namespace throng
