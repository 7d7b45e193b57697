#include "scenes/motion/motion_source.h"

#include "scenes/motion/box_motion.h"
#include "scenes/motion/crowd_motion.h"
#include "scenes/retargeting/recorded_motion.h"

namespace throng {

const std::vector<std::string>& MotionSource::notes() const {
  static const std::vector<std::string> none;
  return none;
}

const SteeringCounters& MotionSource::steering() const {
  static const SteeringCounters zero;
  return zero;
}

const PopulationCounters& MotionSource::population() const {
  static const PopulationCounters zero;
  return zero;
}

std::unique_ptr<MotionSource> make_motion(const Scene& scene, SimdTarget simd, Workers& workers) {
  if (scene.box) return std::make_unique<BoxMotion>(scene);
  if (scene.recorded) return std::make_unique<RecordedMotion>(scene, simd, workers);
  return std::make_unique<CrowdMotion>(scene, simd, workers);
}

}  // namespace throng
