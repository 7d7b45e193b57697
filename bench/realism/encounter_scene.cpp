#include "bench/realism/encounter_scene.h"

#include <limits>
#include <vector>

#include "scenes/dressing/recorded_world.h"
#include "scenes/file/recorded_scene.h"
#include "scenes/recorded/recording_builder.h"
#include "scenes/run/posing.h"
#include "scenes/run/runner.h"

namespace throng::realism {
namespace {

constexpr double kStep_s = 1.0 / 60;
constexpr double kApart_m = 20;
constexpr uint64_t kColumns = 32;
constexpr uint64_t kPlaces = kColumns * kColumns;

std::shared_ptr<const Recording> recording_of(std::span<const Encounter> encounters,
                                              const RecordingOptions& options) {
  RecordingBuilder builder(options);
  builder.head().kind = "encounters";
  builder.head().per_s = 1 / kStep_s;
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  const int64_t frames = frame_count(Encounter::kDuration_s, kStep_s);
  int64_t place = 0;
  for (size_t i = 0; i < encounters.size(); ++i)
    for (size_t person = 0; person < 2; ++person)
      for (int64_t frame = 0; frame < frames; ++frame) {
        const Eigen::Vector2d at =
            middle_of(encounters[i]) +
            encounters[i].place_m(person, static_cast<double>(frame) * kStep_s);
        builder.add(static_cast<int64_t>(2 * i + person),
                    {static_cast<double>(frame), at.x(), at.y(), kNone, kNone}, ++place);
      }
  return builder.finish();
}

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
  return kApart_m * Eigen::Vector2d(static_cast<double>(place % kColumns),
                                    static_cast<double>(place / kColumns));
}

Scene encounter_scene(std::span<const Encounter> encounters) {
  Scene scene;
  scene.name = "encounters";
  scene.description = "pairs of people who meet";
  scene.step_s = kStep_s;
  scene.duration_s = Encounter::kDuration_s;
  scene.exact = true;
  RecordedPeople& people = scene.recorded.emplace();
  people.options.file = "encounters";
  people.options.tracks = TrackedPoint::kCentre;
  people.recording = recording_of(encounters, people.options);
  const Eigen::Vector2d half = Eigen::Vector2d::Constant(0.5 * kApart_m);
  scene.ground = {middle_of(encounters.front()) - half, middle_of(encounters.front()) + half};
  for (const Encounter& encounter : encounters) {
    scene.ground.min_m = scene.ground.min_m.cwiseMin(middle_of(encounter) - half);
    scene.ground.max_m = scene.ground.max_m.cwiseMax(middle_of(encounter) + half);
  }
  scene.groups.push_back(recorded_group());
  scene.groups.back().recorded = static_cast<int64_t>(people.recording->people().size());
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
