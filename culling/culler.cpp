#include "culling/culler.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <functional>
#include <utility>

#include "base/errors.h"
#include "base/limits.h"
#include "base/stopwatch.h"
#include "culling/deadline/deadline.h"
#include "culling/distance/near_alone.h"
#include "culling/distance/near_search.h"
#include "culling/event_hash.h"
#include "culling/stages/pass.h"
#include "culling/stages/pipeline.h"
#include "culling/strategies/recipe_pass.h"

namespace throng {
namespace {

void require_triangles(BodyTypes types, const CullerOptions& options) {
  if (!options.exact) return;
  for (const auto& type : types)
    if (!type->has_triangles())
      throw InputError("exact contacts", "triangles in every part", "a point cloud");
  if (options.strategy == Strategy::kSphere)
    throw InputError("exact contacts", "a strategy that tests parts", "spheres alone");
}

/// What only the pipeline does is not left out in silence.
void require_pipeline(BodyTypes types, const CullerOptions& options) {
  const bool is_pipeline = options.strategy == Strategy::kPipeline;
  if (options.by_part && (!is_pipeline || options.has_deadline()))
    throw InputError("counts by part", "the pipeline without a deadline",
                     is_pipeline ? "a deadline" : name_of(options.strategy));
  for (const auto& type : types)
    for (const PartShape& part : type->parts())
      if (part.volume && !is_pipeline)
        throw InputError("volumes of single parts", "the pipeline", name_of(options.strategy));
}

void require_filter(BodyTypes types, const CullerOptions& options) {
  if (options.filter.is_empty()) return;
  if (options.strategy != Strategy::kPipeline)
    throw InputError("a filter", "the pipeline", name_of(options.strategy));
  const auto& of_part = options.filter.of_part;
  bool fits = of_part.empty() || of_part.size() == types.size();
  for (size_t type = 0; fits && type < of_part.size(); ++type)
    fits = of_part[type].size() == types[type]->parts().size();
  if (!fits) throw InputError("a filter", "sides of every part of every type", "others");
}

/// Beyond, places and volumes over a scale leave what a float holds, and pairs would be lost.
void require_scales(std::span<const float> scales) {
  constexpr auto kMost = static_cast<float>(kMaxDescribed);
  for (size_t i = 0; i < scales.size(); ++i)
    if (!(scales[i] >= 1 / kMost && scales[i] <= kMost))
      throw InputError(fmt::format("scales[{}]", i),
                       fmt::format("a number from {:g} to {:g}", 1 / kMost, kMost),
                       fmt::format("{:g}", scales[i]));
}

std::unique_ptr<NearSearch> make_near(BodyTypes types, const CullerOptions& options,
                                      Workers& workers) {
  for (const float margin_m : {options.near.near_m, options.near.body_near_m})
    if (!(margin_m >= 0 && margin_m <= kMostNear_m))
      throw InputError("margin", fmt::format("0 to {} m", kMostNear_m),
                       fmt::format("{}", margin_m));
  if (!options.near.needs_search()) return nullptr;
  if (options.strategy != Strategy::kPipeline)
    throw InputError(options.near.is_asked() ? "margins" : "contact points", "the pipeline",
                     "a strategy of the paper, which knows no distances");
  if (options.near.contact_points && !options.exact)
    throw InputError("contact points", "exact contacts (--exact, or culling: {exact: true})",
                     "contacts of volumes, which have none");
  return std::make_unique<NearSearch>(types, options, workers);
}

std::unique_ptr<Pass> make_pass(BodyTypes types, const CullerOptions& options, Workers& workers,
                                NearSearch* near) {
  require_triangles(types, options);
  require_pipeline(types, options);
  require_filter(types, options);
  if (options.strategy != Strategy::kPipeline) {
    assert(!options.has_deadline());
    return std::make_unique<RecipePass>(types, options);
  }
  if (options.has_deadline()) return std::make_unique<Deadline>(types, options, workers);
  return std::make_unique<Pipeline>(types, options, workers, near);
}

}  // namespace

struct Culler::State {
  State(std::vector<std::shared_ptr<const BodyType>> body_types, const CullerOptions& options,
        Workers& workers)
      : types(std::move(body_types)),
        near(make_near(types, options, workers)),
        pass(make_pass(types, options, workers, near.get())),
        events(last_level(options)) {
    if (near && options.has_deadline())
      near_alone = std::make_unique<NearAlone>(types, options, workers, *near);
  }

  void hash_events() {
    EventSum sum;
    sum.add(events.events(), pass->hash_kind());
    hash.add_frame(frame++, sum);
  }
  uint64_t times_grown() const {
    return pass->times_grown() + events.times_grown() + (near ? near->times_grown() : 0) +
           (near_alone ? near_alone->times_grown() : 0);
  }

  std::vector<std::shared_ptr<const BodyType>> types;
  std::unique_ptr<NearSearch> near;  // null where no distance is asked
  std::unique_ptr<Pass> pass;
  std::unique_ptr<NearAlone> near_alone;  // under a deadline; else the pass finds distances, too
  PairEvents events;
  CullingCounters counters;
  EventHash hash;
  uint64_t frame = 0;
};

Culler::Culler(std::vector<std::shared_ptr<const BodyType>> types, const CullerOptions& options,
               Workers& workers)
    : state_(std::make_unique<State>(std::move(types), options, workers)) {}

Culler::~Culler() = default;

void Culler::step(const BodiesView& bodies, const PoseSource& poses) {
  State& s = *state_;
  assert(bodies.types.size() == bodies.ids.size() && bodies.scales.size() == bodies.ids.size() &&
         bodies.roots.size() == bodies.ids.size());
  assert(std::adjacent_find(bodies.ids.begin(), bodies.ids.end(), std::greater_equal<>()) ==
         bodies.ids.end());
  assert(bodies.ids.empty() || bodies.ids.back() <= PairKey::kMaxId);
  require_scales(bodies.scales);
  const uint64_t grown_before = s.times_grown();
  Stopwatch whole;
  s.pass->run(bodies, poses, s.events, s.counters);
  Stopwatch hashing;
  s.hash_events();
  s.counters.events_ns += hashing.lap_ns();
  s.counters.wall_ns = whole.lap_ns();
  if (s.near_alone) {
    s.near_alone->run(bodies, poses, s.counters.near);
    s.near->keep_contact_points(s.events.touching());
  }
  s.counters.allocations_grown = s.times_grown() - grown_before;
}

void Culler::finish() {
  state_->pass->finish(state_->events);
  state_->hash_events();
}

void Culler::archive(Archive& a) {
  State& s = *state_;
  uint64_t hash = s.hash.value();
  a(s.frame, hash);
  s.hash = EventHash(hash);
  const std::span<const PairKey> now = s.events.touching();
  std::vector<PairKey> touching(now.begin(), now.end());
  a.resized(touching, SIZE_MAX);
  if (a.is_reading()) {
    if (std::adjacent_find(touching.begin(), touching.end(), std::greater_equal<>()) !=
        touching.end())
      a.refuse("pairs in order", "pairs in disorder");
    for (const PairKey& key : touching)
      if (key.a() >= key.b()) a.refuse("pairs of two bodies", "a body with itself");
    s.events.resume(touching);
  }
  s.pass->archive(a, touching);
  if (s.near) s.near->archive(a);
}

std::span<const PairKey> Culler::pairs() const { return state_->events.touching(); }
std::span<const PairEvent> Culler::events() const { return state_->events.events(); }
std::span<const uint8_t> Culler::levels() const { return state_->pass->levels(); }
NearRows Culler::near_pairs() const { return state_->near ? state_->near->pairs() : NearRows(); }
NearRows Culler::near_bodies() const { return state_->near ? state_->near->bodies() : NearRows(); }
std::span<const ContactPoint> Culler::contact_points() const {
  return state_->near ? state_->near->contact_points() : std::span<const ContactPoint>();
}
uint64_t Culler::near_hash() const { return state_->near ? state_->near->hash() : 0; }
uint64_t Culler::persisting() const { return state_->events.persisting(); }
const CullingCounters& Culler::counters() const { return state_->counters; }
uint64_t Culler::hash() const { return state_->hash.value(); }
PartTally Culler::part_tally() const { return state_->pass->part_tally(); }

}  // namespace throng
