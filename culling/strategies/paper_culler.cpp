#include "culling/strategies/paper_culler.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "base/errors.h"
#include "base/memory.h"
#include "base/stopwatch.h"
#include "culling/stages/pass.h"
#include "culling/strategies/paper_search.h"

namespace throng {
namespace {

/// Runs a strategy as a pass. Converts body indices, valid in a frame, to lasting ids.
class PaperPass final : public Pass {
 public:
  PaperPass(BodyTypes types, Strategy strategy, const CullerOptions& options, PairLevel last_level)
      : last_level_(last_level), search_(PaperSearch::make(strategy, options, types)) {}

  void run(const BodiesView& bodies, const PoseSource& source, PairEvents& events,
           CullingCounters& counters) override {
    search_->run(bodies, source);
    Stopwatch watch;
    const std::span<const PairKey> found = search_->pairs();
    pairs_.resize(found.size());
    for (size_t i = 0; i < found.size(); ++i)
      pairs_[i] = PairKey(bodies.ids[found[i].a()], bodies.ids[found[i].b()], found[i].part_a(),
                          found[i].part_b());
    events.advance({pairs_.data(), found.size()});
    level(found.size());
    counters.events_ns = watch.lap_ns();
    counters.body_sphere = search_->spheres();
    counters.body_box = counters.part_box = {.volume = "off"};
    counters.part_volume = search_->volumes();
    counters.triangles = search_->triangles();
    counters.primitive_tests = search_->primitive_tests();
    counters.posed_bodies = search_->posed_bodies();
    counters.levels = {};
    counters.levels[static_cast<size_t>(last_level_)] = found.size();
  }
  void finish(PairEvents& events) override {
    events.advance({});
    level(0);
  }
  void archive(Archive& a, std::span<const PairKey> touching) override {
    if (a.is_reading()) level(touching.size());
  }
  std::span<const uint8_t> levels() const override { return {levels_.data(), level_count_}; }
  uint64_t times_grown() const override {
    return search_->times_grown() + pairs_.times_grown() + levels_.times_grown();
  }

 private:
  /// Sets the level of all pairs for spheres alone: readers assume parts if there is none.
  void level(size_t pairs) {
    if (last_level_ != PairLevel::kSphere) return;
    level_count_ = pairs;
    levels_.resize(pairs);
    std::fill_n(levels_.data(), pairs, static_cast<uint8_t>(PairLevel::kSphere));
  }

  PairLevel last_level_;
  std::unique_ptr<PaperSearch> search_;
  GrowBuffer<PairKey> pairs_;
  GrowBuffer<uint8_t> levels_;  // zeros, for spheres alone
  size_t level_count_ = 0;
};

PairLevel last_level_of(Strategy strategy, const CullerOptions& options) {
  return strategy == Strategy::kSphere ? PairLevel::kSphere : last_level(options);
}

void require_possible(BodyTypes types, Strategy strategy, const CullerOptions& options) {
  require_margins(options.proximity);
  if (options.proximity.needs_search())
    throw InputError(options.proximity.is_enabled() ? "margins" : "contact points", "the pipeline",
                     "a strategy of the paper, which has no distances");
  if (options.exact) {
    require_triangles(types);
    if (strategy == Strategy::kSphere)
      throw InputError("exact contacts", "a strategy that tests parts", "spheres of bodies only");
  }
  if (options.by_part)
    throw InputError("counts by part pair", "the pipeline without a budget", name_of(strategy));
  for (const auto& type : types)
    for (const PartShape& part : type->parts())
      if (part.volume)
        throw InputError("volumes of single parts", "the pipeline", name_of(strategy));
  if (!options.filter.is_empty()) throw InputError("a filter", "the pipeline", name_of(strategy));
  assert(!options.has_budget());
}

std::unique_ptr<Pass> make_pass(BodyTypes types, Strategy strategy, const CullerOptions& options) {
  require_possible(types, strategy, options);
  return std::make_unique<PaperPass>(types, strategy, options, last_level_of(strategy, options));
}

}  // namespace

struct PaperCuller::State {
  State(std::vector<std::shared_ptr<const BodyType>> body_types, Strategy strategy,
        const CullerOptions& options)
      : types(std::move(body_types)),
        run(make_pass(types, strategy, options), last_level_of(strategy, options)) {}

  std::vector<std::shared_ptr<const BodyType>> types;
  PassRun run;
};

PaperCuller::PaperCuller(std::vector<std::shared_ptr<const BodyType>> types, Strategy strategy,
                         const CullerOptions& options)
    : state_(std::make_unique<State>(std::move(types), strategy, options)) {}
PaperCuller::~PaperCuller() = default;

void PaperCuller::step(const BodiesView& bodies, const PoseSource& poses) {
  state_->run.step(bodies, poses);
}
void PaperCuller::finish() { state_->run.finish(); }
void PaperCuller::archive(Archive& a) { state_->run.archive(a); }
CullingResult PaperCuller::frame() const { return state_->run.frame(); }

std::unique_ptr<AnyCuller> make_culler(std::vector<std::shared_ptr<const BodyType>> types,
                                       Strategy strategy, const CullerOptions& options,
                                       Workers& workers) {
  if (strategy == Strategy::kPipeline)
    return std::make_unique<Culler>(std::move(types), options, workers);
  return std::make_unique<PaperCuller>(std::move(types), strategy, options);
}

}  // namespace throng
