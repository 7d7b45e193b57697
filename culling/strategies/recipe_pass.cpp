#include "culling/strategies/recipe_pass.h"

#include <algorithm>

#include "base/stopwatch.h"

namespace throng {

RecipePass::RecipePass(BodyTypes types, const CullerOptions& options)
    : last_level_(last_level(options)), recipe_(Recipe::make(options, types)) {}

void RecipePass::run(const BodiesView& bodies, const PoseSource& source, PairEvents& events,
                     CullingCounters& counters) {
  recipe_->run(bodies, source);
  Stopwatch watch;
  const std::span<const PairKey> found = recipe_->pairs();
  pairs_.resize(found.size());
  for (size_t i = 0; i < found.size(); ++i)
    pairs_[i] = PairKey(bodies.ids[found[i].a()], bodies.ids[found[i].b()], found[i].part_a(),
                        found[i].part_b());
  events.advance({pairs_.data(), found.size()});
  level(found.size());
  counters.events_ns = watch.lap_ns();
  counters.avatar = recipe_->spheres();
  counters.body_box = counters.box = {.volume = "off"};
  counters.part = recipe_->volumes();
  counters.exact = recipe_->triangles();
  counters.primitive_tests = recipe_->primitive_tests();
  counters.posed_bodies = recipe_->posed_bodies();
  counters.levels = {};
  counters.levels[static_cast<size_t>(last_level_)] = found.size();
}

/// Of spheres alone every pair says so: a reader expects parts of whatever has no level.
void RecipePass::level(size_t pairs) {
  if (last_level_ != PairLevel::kSphere) return;
  level_count_ = pairs;
  levels_.resize(pairs);
  std::fill_n(levels_.data(), pairs, static_cast<uint8_t>(PairLevel::kSphere));
}

void RecipePass::finish(PairEvents& events) {
  events.advance({});
  level(0);
}

void RecipePass::archive(Archive& a, std::span<const PairKey> touching) {
  if (a.is_reading()) level(touching.size());
}

uint64_t RecipePass::times_grown() const {
  return recipe_->times_grown() + pairs_.times_grown() + levels_.times_grown();
}

}  // namespace throng
