#include "bench/realism/measured_run.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "base/console.h"
#include "recordings/recording_builder.h"
#include "scenes/file/recorded_scene.h"
#include "scenes/run/runner.h"

namespace throng::realism {
namespace {

/// Distance by which bodies may extend beyond their roots.
constexpr double kMargin_m = 2;

}  // namespace

Scene synthetic_scene(const std::string& name, size_t people, double duration_s,
                      const std::function<Eigen::Vector2d(size_t, double)>& place_m) {
  Scene scene;
  scene.name = name;
  scene.step_s = kSyntheticStep_s;
  scene.duration_s = duration_s;
  RecordedPeople& recorded = scene.recorded.emplace();
  recorded.options.file = name;
  recorded.options.tracked_point = TrackedPoint::kCentre;
  RecordingBuilder builder(recorded.options);
  builder.header().kind = name;
  builder.header().per_s = 1 / kSyntheticStep_s;
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  const int64_t frames = frame_count(duration_s, kSyntheticStep_s);
  int64_t place = 0;
  for (size_t person = 0; person < people; ++person)
    for (int64_t frame = 0; frame < frames; ++frame) {
      const Eigen::Vector2d at = place_m(person, static_cast<double>(frame) * kSyntheticStep_s);
      builder.add(static_cast<int64_t>(person),
                  {static_cast<double>(frame), at.x(), at.y(), kNone, kNone}, ++place);
    }
  recorded.recording = builder.finish();
  const Rectangle& bounds = recorded.recording->facts().bounds;
  const Eigen::Vector2d margin = Eigen::Vector2d::Constant(kMargin_m);
  scene.ground = {bounds.min_m - margin, bounds.max_m + margin};
  scene.groups.push_back(recorded_group());
  take_people(*recorded.recording, scene.groups.back());
  return scene;
}

Scene plain_walking(double duration_s) {
  constexpr size_t kSpeeds = 15, kEach = 20;
  constexpr double kMinSpeed_mps = 0.5, kStep_mps = 0.1, kApart_m = 5;
  Scene scene = synthetic_scene(
      "plain walking", kSpeeds * kEach, duration_s, [](size_t person, double time_s) {
        const size_t faster = person / kEach;
        const double speed_mps = kMinSpeed_mps + kStep_mps * static_cast<double>(faster);
        return Eigen::Vector2d(speed_mps * time_s, kApart_m * static_cast<double>(person));
      });
  StyleShares styles;
  styles.fill(1);
  scene.groups.back().gait_styles = styles;
  return scene;
}

Scene open_measured_run(const std::string& name, std::optional<double> seconds) {
  Scene scene;
  if (std::filesystem::is_regular_file(name) && is_recording(name)) {
    RecordingOptions options;
    options.file = name;
    scene = recorded_scene(options);
  } else {
    scene = load_scene(name);
  }
  if (seconds) scene.duration_s = scene.recorded ? std::min(scene.duration_s, *seconds) : *seconds;
  set_switches(scene);
  return scene;
}

void run_measured(Scene scene, int threads, bool culling,
                  const std::function<std::vector<Sink*>(const Simulation&)>& sinks_of) {
  Simulation simulation(std::move(scene), {.threads = threads, .culling = culling});
  for (const std::string& note : simulation.notes())
    print_message("note: {}: {}\n", simulation.scene().name, note);
  const std::vector<Sink*> sinks = sinks_of(simulation);
  run(simulation, sinks);
}

}  // namespace throng::realism
