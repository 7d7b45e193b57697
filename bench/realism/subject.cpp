#include "bench/realism/subject.h"

#include <algorithm>
#include <filesystem>

#include "base/say.h"
#include "bench/realism/scene_switches.h"
#include "scenes/file/recorded_scene.h"
#include "scenes/run/runner.h"

namespace throng::realism {

Scene open_subject(const std::string& name, std::optional<double> seconds) {
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

void run_subject(Scene scene, int threads, bool culling,
                 const std::function<std::vector<Sink*>(const Simulation&)>& sinks_of) {
  Simulation simulation(std::move(scene), {.threads = threads, .culling = culling});
  for (const std::string& note : simulation.notes())
    say("note: {}: {}\n", simulation.scene().name, note);
  const std::vector<Sink*> sinks = sinks_of(simulation);
  run(simulation, sinks);
}

}  // namespace throng::realism
