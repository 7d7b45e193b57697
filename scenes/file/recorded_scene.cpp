#include "scenes/file/recorded_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/errors.h"
#include "base/text.h"
#include "crowd/crowd_plan.h"
#include "scenes/file/polygon_values.h"
#include "scenes/file/scene_keys.h"

namespace throng {
namespace {

constexpr double kMaxStep_s = 1.0 / 60;
/// Margin of the ground around recorded positions, in metres: bodies extend beyond them.
constexpr double kMargin_m = 1;
/// Walls around a walkable area have the height of a storey.
constexpr double kWallHeight_m = 2.5;

double step_of(const RecordingFacts& facts, const RecordedPeople& people,
               const std::string& where) {
  if (facts.fps == 0) {
    if (people.recorded_frames)
      throw InputError(where, "a recording with frames for 'sampling: recorded'",
                       "footsteps, which begin and end at any time");
    return kMaxStep_s;
  }
  if (people.recorded_frames) return 1 / facts.fps;
  const double steps = std::ceil(1 / (facts.fps * kMaxStep_s) - 1e-9);
  return 1 / (facts.fps * std::max(1.0, steps));
}

Rectangle ground_of(const RecordingFacts& facts, const std::vector<Polygon>& floor) {
  const Rectangle ground = floor.empty() ? facts.bounds : facts.bounds.joined(bounds_of(floor));
  return ground.grown(kMargin_m);
}

}  // namespace

Group recorded_group() {
  Group group;
  group.name = "recorded";
  group.model = adult_urdf();
  return group;
}

void take_people(const Recording& recording, Group& group) {
  group.recorded = static_cast<int64_t>(recording.people().size());
  for (const RecordedPerson& person : recording.people()) {
    group.recorded_heights += person.height_m ? 1 : 0;
    group.tallest_recorded_m = std::max(group.tallest_recorded_m, person.height_m.value_or(0));
  }
}

void apply_recording(Scene& scene, bool has_ground, const std::string& where) {
  RecordedPeople& people = *scene.recorded;
  people.recording = read_recording(people.options);
  const RecordingFacts& facts = people.recording->facts();
  scene.step_s = step_of(facts, people, where);
  // A run ends before the frame at its end time; the last recorded frame is a step earlier.
  scene.duration_s = facts.duration_s + scene.step_s;
  if (people.geometry) scene.floor = recorded_area(facts, people.options.file.string()).polygons;
  if (!has_ground) scene.ground = ground_of(facts, scene.floor);
  if (!scene.floor.empty()) add_walls(scene, kWallHeight_m, where);
  take_people(*people.recording, scene.groups.back());
}

Scene recorded_scene(const RecordingOptions& options, bool recorded_frames) {
  Scene scene;
  scene.file = options.file;
  scene.name = name_after(options.file.stem().string());
  scene.recorded.emplace().options = options;
  scene.recorded->recorded_frames = recorded_frames;
  scene.groups.push_back(recorded_group());
  apply_recording(scene, false, options.file.string());
  scene.description = scene.recorded->recording->facts().kind;
  scene.content_hash = content_hash_of(scene);
  return scene;
}

}  // namespace throng
