// Runs a scene, logs it and culls the log again.
#pragma once

#include <functional>
#include <set>
#include <string>
#include <vector>

#include "lcm_io/log/log_sink.h"
#include "lcm_io/replay/log_motion.h"
#include "scenes/run/simulation.h"
#include "tests/lcm_io/synthetic_run.h"

namespace throng {

struct CulledFrame {
  std::vector<RootPose> roots;
  std::vector<float> postures;
  std::vector<uint8_t> present;
  std::vector<PairKey> pairs;
  uint64_t hash = 0;
};

inline CulledFrame culled_frame_of(const Frame& frame) {
  return {{frame.roots.begin(), frame.roots.end()},
          {frame.postures.begin(), frame.postures.end()},
          {frame.present.begin(), frame.present.end()},
          {frame.pairs.begin(), frame.pairs.end()},
          frame.hash};
}

/// A bundled scene, small enough for triangle tests of all pairs.
inline Scene small_scene(const std::string& name, uint64_t seed, int avatars = 80) {
  Scene scene = load_scene(name);
  std::vector<std::string> notes;
  scale_to(scene, avatars, notes);
  scene.seed = seed;
  scene.exact = true;
  return scene;
}

using MoveAvatars = std::function<void(Simulation&)>;

inline std::vector<CulledFrame> logged(const Scene& scene, int frames,
                                       const std::filesystem::path& log,
                                       const LogOptions& options = {},
                                       const MoveAvatars& move_avatars = {}) {
  Simulation simulation(scene, {});
  LogSink sink(log, options);
  sink.begin(simulation.info());
  std::vector<CulledFrame> moments;
  for (int i = 0; i < frames; ++i) {
    if (move_avatars) move_avatars(simulation);
    const Frame& frame = simulation.step();
    sink.frame(simulation.info(), frame);
    moments.push_back(culled_frame_of(frame));
  }
  sink.end(simulation.info(), simulation.finish());
  return moments;
}

inline SimulationOptions options_of(const LogRun& run, int threads = 1) {
  SimulationOptions options;
  options.threads = threads;
  options.motion = run.motion;
  return options;
}

inline std::vector<CulledFrame> culled_again(const std::filesystem::path& log, int threads = 1) {
  const LogRun run = read_log_run(log);
  Simulation simulation(run.scene, options_of(run, threads));
  std::vector<CulledFrame> moments;
  for (int64_t i = 0; i < run.facts.frames; ++i)
    moments.push_back(culled_frame_of(simulation.step()));
  return moments;
}

}  // namespace throng
