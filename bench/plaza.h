// The bench crowd with steering: the people of the bundled scene `plaza`, who avoid each other.
// One rule: they walk as `throng run plaza` lets them walk; obstacles are left out, because the
// other engines are given people only.
#pragma once

#include "bench/crowd.h"
#include "scenes/run/simulation.h"

namespace throng::bench {

class PlazaCrowd : public Crowd {
 public:
  /// `avatars` people, the square enlarged as --avatars does; fewer if not all find a place.
  PlazaCrowd(int avatars, uint64_t seed, int threads);

  void advance() override;
  double per_m2() const { return per_m2_; }

 private:
  explicit PlazaCrowd(std::unique_ptr<Simulation> simulation);
  void take(const Frame& frame);

  std::unique_ptr<Simulation> simulation_;
  std::vector<RootPose> before_;
  double per_m2_ = 0;
};

}  // namespace throng::bench
