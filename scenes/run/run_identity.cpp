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

void identify_run(const Scene& scene, const SimulationOptions& options, uint64_t world_hash,
                  RunInfo& info) {
  // Threads, SIMD, pair search and outputs stay out: they change no frame.
  Hasher name;
  name.add("throng run 1").add(scene.content_hash);
  if (world_hash != 0) name.add("world").add(world_hash);
  const CullerOptions& culler = options.culler;
  if (culler.deadline_ms) name.add("deadline, ms").add(*culler.deadline_ms);
  if (culler.deadline_tests) name.add("deadline, tests").add(*culler.deadline_tests);
  if (culler.strategy != Strategy::kPipeline) name.add("strategy").add(name_of(culler.strategy));
  if (!options.culling) name.add("no culling");
  info.run_id = name.value();
  info.instance = random_instance();
  info.culler = options.culler;
  info.culling = options.culling;
}

}  // namespace throng
