#include "scenes/motion/world.h"

#include "scenes/motion/box_world.h"
#include "scenes/motion/crowd_world.h"
#include "scenes/retargeting/recorded_world.h"

namespace throng {

const std::vector<std::string>& World::notes() const {
  static const std::vector<std::string> none;
  return none;
}

const SteeringCounters& World::steering() const {
  static const SteeringCounters zero;
  return zero;
}

const TrafficCounters& World::traffic() const {
  static const TrafficCounters zero;
  return zero;
}

std::unique_ptr<World> make_world(const Scene& scene, SimdTarget simd, Workers& workers) {
  if (scene.box) return std::make_unique<PartsWorld>(scene);
  if (scene.recorded) return std::make_unique<RecordedWorld>(scene, simd, workers);
  return std::make_unique<CrowdWorld>(scene, simd, workers);
}

}  // namespace throng
