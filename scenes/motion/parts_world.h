// The world of a scene with a box: loose parts of one body, in turn, that fly in it.
// One rule: parts have no joints, walk nowhere and are always there.
#pragma once

#include <memory>
#include <vector>

#include "scenes/motion/box_world.h"
#include "scenes/motion/world.h"

namespace throng {

class PartsWorld final : public World {
 public:
  /// Throws InputError if a part does not fit.
  explicit PartsWorld(const Scene& scene);

  const std::vector<std::shared_ptr<const Model>>& models() const override { return parts_; }
  void place(BodyStates& bodies) override;
  void describe(RunInfo& info) const override;
  void step() override { box_.step(); }
  void update(const Posing& posing, BodyStates& bodies, std::span<float> speeds_mps) override;
  void archive(Archive& a) override { box_.archive(a); }

 private:
  std::vector<std::shared_ptr<const Model>> parts_;
  BoxWorld box_;
};

}  // namespace throng
