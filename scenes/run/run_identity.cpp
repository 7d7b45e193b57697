#include "scenes/run/run_identity.h"

#include <random>

#include "base/hasher.h"

namespace throng {
namespace {

uint64_t random_instance() {
  std::random_device device;
  return (uint64_t{device()} << 32) | device();
}

}  // namespace

void identify_run(const Scene& scene, const SimulationOptions& options, RunInfo& info) {
  // Threads, SIMD, pair search and outputs stay out: they change no frame.
  Hasher name;
  name.add("throng run 1").add(scene.content_hash);
  if (options.deadline_ms) name.add("deadline, ms").add(*options.deadline_ms);
  if (options.deadline_tests) name.add("deadline, tests").add(*options.deadline_tests);
  if (options.strategy != Strategy::kPipeline) name.add("strategy").add(name_of(options.strategy));
  info.run_id = name.value();
  info.instance = random_instance();
  info.culling = options.culling;
  info.strategy = options.strategy;
  info.deadline_ms = options.deadline_ms;
  info.deadline_tests = options.deadline_tests;
}

}  // namespace throng
