#include "bench/plaza.h"

#include <cmath>
#include <utility>

#include "base/errors.h"
#include "scenes/file/scene.h"

namespace throng::bench {
namespace {

std::unique_ptr<Simulation> simulation_of(int avatars, uint64_t seed, int threads) {
  Scene scene = load_scene("plaza");
  scene.seed = seed;
  std::vector<std::string> notes;
  scale_to(scene, avatars, notes);
  SimulationOptions options;
  options.threads = threads;
  options.postures = false;
  return std::make_unique<Simulation>(std::move(scene), options);
}

}  // namespace

PlazaCrowd::PlazaCrowd(int avatars, uint64_t seed, int threads)
    : PlazaCrowd(simulation_of(avatars, seed, threads)) {}

PlazaCrowd::PlazaCrowd(std::unique_ptr<Simulation> simulation)
    : Crowd(simulation->info().models.front(),
            {.avatars = simulation->info().avatar_count(), .seed = simulation->scene().seed}),
      simulation_(std::move(simulation)) {
  if (simulation_->info().models.size() != 1)
    throw InputError("plaza", "one model for everybody", "several");
  scales_ = simulation_->info().scale_of_avatar;
  per_m2_ = count() / simulation_->scene().ground.area_m2();
  take(simulation_->step());
}

void PlazaCrowd::advance() {
  before_ = roots_;
  take(simulation_->step());
  for (size_t i = 0; i < roots_.size(); ++i) {
    const auto walked_m = static_cast<float>((roots_[i].position_m - before_[i].position_m).norm());
    const float phase = phases_[i] + walked_m / gait_.stride_length_m(speeds_[i], scales_[i]);
    phases_[i] = phase - std::floor(phase);
    if (phases_[i] >= 1) phases_[i] = 0;
  }
}

void PlazaCrowd::take(const Frame& frame) {
  roots_.assign(frame.roots.begin(), frame.roots.end());
  speeds_.assign(frame.speeds_mps.begin(), frame.speeds_mps.begin() + count());
}

}  // namespace throng::bench
