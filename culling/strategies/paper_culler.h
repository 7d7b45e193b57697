// PaperCuller finds contacts by a strategy of the paper: on one thread, without budget, distances,
// filter or volumes of single parts.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "culling/culler.h"
#include "culling/strategies/strategy.h"

namespace throng {

class PaperCuller final : public AnyCuller {
 public:
  /// `strategy` is not kPipeline and options have no budget (asserted). pair_search applies to
  /// kTwoPass and kSphere only. Throws InputError for `exact` with kSphere or a type without
  /// triangles, parts with their own volume, counts by part pair, margins, contact points and
  /// filters.
  PaperCuller(std::vector<std::shared_ptr<const BodyType>> types, Strategy strategy,
              const CullerOptions& options);
  ~PaperCuller() override;

  void step(const BodiesView& bodies, const PoseSource& poses) override;
  void finish() override;
  void archive(Archive& a) override;
  /// For kSphere every pair has the level kSphere, and its parts are kWholeBody.
  CullingResult frame() const override;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Creates a Culler for kPipeline, otherwise a PaperCuller. Throws the same errors.
std::unique_ptr<AnyCuller> make_culler(std::vector<std::shared_ptr<const BodyType>> types,
                                       Strategy strategy, const CullerOptions& options,
                                       Workers& workers);

}  // namespace throng
