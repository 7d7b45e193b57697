// One of the paper's strategies as a pass.
// One rule: a recipe knows body indices, which are a frame's; pairs leave with ids, which last.
#pragma once

#include <cstdint>
#include <memory>

#include "culling/stages/pass.h"
#include "culling/strategies/recipe.h"

namespace throng {

class RecipePass final : public Pass {
 public:
  /// options.strategy is not kPipeline (asserted). Keeps a reference to `types`.
  RecipePass(BodyTypes types, const CullerOptions& options);

  void run(const BodiesView& bodies, const PoseSource& source, PairEvents& events,
           CullingCounters& counters) override;
  void finish(PairEvents& events) override;
  void archive(Archive& a, std::span<const PairKey> touching) override;
  std::span<const uint8_t> levels() const override { return {levels_.data(), level_count_}; }
  uint64_t times_grown() const override;

 private:
  void level(size_t pairs);

  PairLevel last_level_;
  std::unique_ptr<Recipe> recipe_;
  GrowBuffer<PairKey> pairs_;
  GrowBuffer<uint8_t> levels_;  // zeros, of spheres alone
  size_t level_count_ = 0;
};

}  // namespace throng
