// PaperCuller finds contacts by a strategy of the paper: on one thread, without deadline,
// distances, filter or volumes of single parts.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "culling/culler.h"
#include "culling/strategies/strategy.h"

namespace throng {

class PaperCuller final : public AnyCuller {
 public:
  /// `strategy` is not kPipeline and options have no deadline (asserted); pair_search counts for
  /// kTwoPass and kSphere only. Throws InputError if exact is asked of a type without triangles or
  /// of spheres alone; if a part has a volume of its own; if counts by part, margins, contact
  /// points or a filter are asked.
  PaperCuller(std::vector<std::shared_ptr<const BodyType>> types, Strategy strategy,
              const CullerOptions& options);
  ~PaperCuller() override;

  void step(const BodiesView& bodies, const PoseSource& poses) override;
  void finish() override;
  void archive(Archive& a) override;
  /// Of kSphere every pair has the level kSphere, and its parts are kWholeBody.
  CullingResult frame() const override;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The culler of a strategy: a Culler of kPipeline, else a PaperCuller. Throws what these throw.
std::unique_ptr<AnyCuller> make_culler(std::vector<std::shared_ptr<const BodyType>> types,
                                       Strategy strategy, const CullerOptions& options,
                                       Workers& workers);

}  // namespace throng
