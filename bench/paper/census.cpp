#include "bench/paper/census.h"

namespace throng::paper {
namespace {

/// The motion of one run: the pose of each object in each tested frame.
struct Motion {
  size_t objects = 0;
  size_t frames = 0;
  float margin_m = 0;
  std::vector<PartPose> poses;  ///< frame by frame
};

Motion record(const std::vector<Object>& objects, int frames, uint64_t seed) {
  BoxDynamics world = world_of(objects, objects.size(), 0, part_one_box(objects, seed));
  Motion motion{objects.size(), static_cast<size_t>(frames - 1), margin_m(objects, world), {}};
  motion.poses.reserve(motion.objects * motion.frames);
  for (size_t frame = 0; frame < motion.frames; ++frame) {
    world.step();
    for (size_t i = 0; i < world.size(); ++i) motion.poses.push_back(world.pose(i));
  }
  return motion;
}

template <typename Method>
Census run_method(const std::vector<Object>& objects, const Motion& motion,
                  std::vector<uint8_t>& found) {
  const auto fitted = fit_all<Method>(objects);
  std::vector<typename Method::Placed> placed;
  placed.reserve(objects.size());
  Census census;
  TriangleCounters primitives;
  uint64_t collisions = 0;
  size_t mark = 0;
  found.clear();
  for (size_t frame = 0; frame < motion.frames; ++frame) {
    placed.clear();
    for (size_t i = 0; i < objects.size(); ++i, ++census.updates)
      placed.push_back(
          Method::update(fitted[i], objects[i], motion.poses[frame * motion.objects + i]));
    for (size_t a = 0; a < objects.size(); ++a)
      for (size_t b = a + 1; b < objects.size(); ++b, ++census.tests) {
        const bool hit = Method::test(placed[a], placed[b], motion.margin_m, primitives);
        found.push_back(hit);
        collisions += hit;
      }
    // "After 100 of 500 frames" includes the 99th tested frame.
    while (mark < kMarks && (frame + 2) * kMarks >= (motion.frames + 1) * (mark + 1))
      census.collisions[mark++] = collisions;
  }
  census.primitives = primitives.node_tests + primitives.triangle_tests;
  return census;
}

void compare(Census& census, const std::vector<uint8_t>& found, const std::vector<uint8_t>& truth) {
  for (size_t i = 0; i < truth.size(); ++i) {
    census.missed += truth[i] != 0 && found[i] == 0;
    census.false_positives += truth[i] == 0 && found[i] != 0;
  }
}

}  // namespace

CensusTable take_census(const std::vector<Object>& objects, int frames, uint64_t seed) {
  const Motion motion = record(objects, frames, seed);
  CensusTable table;
  std::vector<uint8_t> truth, found;
  table[kExactMethod] = run_method<Triangles>(objects, motion, truth);
  for_each_method([&](size_t index, auto method) {
    if (index == kExactMethod) return;
    table[index] = run_method<decltype(method)>(objects, motion, found);
    compare(table[index], found, truth);
  });
  return table;
}

std::vector<CensusTable> take_censuses(const std::vector<Object>& objects, int frames,
                                       uint64_t first_seed, int seeds, Workers& workers) {
  std::vector<CensusTable> tables(static_cast<size_t>(seeds));
  workers.for_blocks(seeds, [&](int block, int) {
    tables[static_cast<size_t>(block)] =
        take_census(objects, frames, first_seed + static_cast<uint64_t>(block));
  });
  return tables;
}

}  // namespace throng::paper
