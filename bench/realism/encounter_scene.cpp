#include "bench/realism/encounter_scene.h"

#include <vector>

#include "bench/realism/made_scene.h"
#include "scenes/retargeting/recorded_world.h"
#include "scenes/run/posing.h"

namespace throng::realism {
namespace {

constexpr double kApart_m = 20;
constexpr uint64_t kColumns = 32;
constexpr uint64_t kPlaces = kColumns * kColumns;

class EncounterWorld final : public RecordedWorld {
 public:
  EncounterWorld(const Scene& scene, SimdTarget simd, Workers& workers, std::vector<Passer> passers)
      : RecordedWorld(scene, simd, workers), passers_(std::move(passers)) {}

  void place(BodyStates& bodies) override {
    RecordedWorld::place(bodies);
    const double own_m = static_cast<double>(models().front()->height_m);
    for (size_t id = 0; id < passers_.size(); ++id) {
      bodies.scales[id] = static_cast<float>(passers_[id].height_m / own_m);
      bodies.phases[id] = static_cast<float>(passers_[id].phase);
      bodies.styles[id] = passers_[id].style;
    }
  }

 private:
  std::vector<Passer> passers_;
};

}  // namespace

Eigen::Vector2d middle_of(const Encounter& encounter) {
  const uint64_t place = encounter.number() % kPlaces;
  const uint64_t column = place % kColumns, row = place / kColumns;
  return kApart_m * Eigen::Vector2d(static_cast<double>(column), static_cast<double>(row));
}

Scene encounter_scene(std::span<const Encounter> encounters) {
  Scene scene = made_scene(
      "encounters", 2 * encounters.size(), Encounter::kDuration_s,
      [&](size_t person, double time_s) {
        const Encounter& encounter = encounters[person / 2];
        return Eigen::Vector2d(middle_of(encounter) + encounter.place_m(person % 2, time_s));
      });
  scene.ground.min_m.setConstant(-0.5 * kApart_m);
  scene.ground.max_m.setConstant((static_cast<double>(kColumns) - 0.5) * kApart_m);
  return scene;
}

WorldFactory encounter_world(std::span<const Encounter> encounters) {
  std::vector<Passer> passers;
  for (const Encounter& encounter : encounters)
    passers.insert(passers.end(), encounter.people().begin(), encounter.people().end());
  return [passers](const Scene& scene, SimdTarget simd, Workers& workers) {
    return std::make_unique<EncounterWorld>(scene, simd, workers, passers);
  };
}

}  // namespace throng::realism
