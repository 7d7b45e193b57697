#include "bench/workbench/figure_three.h"

#include <fmt/format.h>

#include "base/figure.h"
#include "culling/exact/triangle_bvh.h"

namespace throng::bench {
namespace {

struct Motion {
  std::vector<PartShape> shapes;
  std::vector<PartPlace> places;  ///< shuffled
  std::vector<PlacedPair> pairs;  ///< shuffled
  std::vector<uint8_t> touching;  ///< by pair
};

Motion record(const std::vector<paper::Object>& objects, int frames, uint64_t seed) {
  BoxWorld world = paper::world_of(objects, objects.size(), 0, paper::part_one_box(objects, seed));
  const float margin = paper::margin_m(objects, world);
  const auto count = static_cast<uint32_t>(objects.size());
  Motion motion;
  std::vector<uint32_t> where(size_t{count} * static_cast<size_t>(frames - 1));
  for (uint32_t i = 0; i < where.size(); ++i) where[i] = i;
  shuffle(where, seed);
  motion.places.resize(where.size());
  for (uint32_t first = 0; first < where.size(); first += count) {
    world.step();
    for (uint32_t a = 0; a < count; ++a) {
      motion.places[where[first + a]] = {a, world.pose(a), 1};
      for (uint32_t b = a + 1; b < count; ++b)
        motion.pairs.push_back(
            {where[first + a], where[first + b], Eigen::Vector3f::Zero(), margin});
    }
  }
  shuffle(motion.pairs, seed);
  std::vector<TriangleBvh> surfaces;
  for (const paper::Object& object : objects) {
    motion.shapes.push_back(object.shape);
    surfaces.emplace_back(object.shape.points, object.shape.triangles);
  }
  ExactCounters counters;
  for (const PlacedPair& pair : motion.pairs) {
    const PartPlace &a = motion.places[pair.a], &b = motion.places[pair.b];
    motion.touching.push_back(solids_touch(surfaces[a.shape], a.pose, 1, surfaces[b.shape], b.pose,
                                           1, pair.a_to_b_m, counters));
  }
  return motion;
}

}  // namespace

std::vector<SimpleAndAccurate> place_in_figure_3(const std::vector<paper::Object>& objects,
                                                 VolumeList volumes, int frames, uint64_t seed) {
  const Motion motion = record(objects, frames, seed);
  const auto count = static_cast<double>(objects.size());
  std::vector<uint8_t> overlaps(motion.pairs.size());
  std::vector<SimpleAndAccurate> out;
  for (const TestedVolume* volume : volumes) {
    const std::unique_ptr<FittedVolume> fitted = volume->fit(motion.shapes);
    fitted->test(motion.places, motion.pairs, overlaps);
    SimpleAndAccurate row{.name = volume->name()};
    uint64_t touching = 0;
    for (size_t i = 0; i < overlaps.size(); ++i) {
      row.found += overlaps[i] != 0;
      touching += overlaps[i] != 0 && motion.touching[i] != 0;
    }
    if (row.found > 0)
      row.true_share = static_cast<double>(touching) / static_cast<double>(row.found);
    const MotionCost cost = fitted->cost(motion.places, motion.pairs);
    row.fit_ns = volume->fit_cost(motion.shapes).median_ns;
    row.update_ns = cost.update.median_ns;
    row.test_ns = cost.test.median_ns;
    row.frame_ns = count * row.update_ns + count * (count - 1) / 2 * row.test_ns;
    out.push_back(std::move(row));
  }
  return out;
}

std::string figure_3_script(std::span<const LabelledPoint> points, const std::string& what,
                            const std::string& highlighted) {
  std::string ours, theirs;
  for (const LabelledPoint& point : points)
    (point.label == highlighted ? theirs : ours) +=
        fmt::format("\"{}\" {} {}\n", point.label, point.frame_ns, 100 * point.true_share);
  const auto series = [](const char* data, const char* colour) {
    return fmt::format(
        "{0} using 2:3 with points pointtype 7 linecolor rgb '{1}', {0} using 2:3:1 with labels "
        "left offset 0.8,0 font ',9' textcolor rgb '{1}' noenhanced",
        data, colour);
  };
  std::string script = "$data << EOD\n" + ours + "EOD\n";
  if (!theirs.empty()) script += "$own << EOD\n" + theirs + "EOD\n";
  script += "set logscale x\nset grid\nset xlabel 'ns a frame (" + what +
            ")'\nset ylabel 'pairs found that touch, %'\nset yrange [0:108]\nset offsets graph "
            "0.1, graph 0.15, 0, 0\nunset key\nplot " +
            series("$data", kFigureColours[0]);
  if (!theirs.empty()) script += ", " + series("$own", kFigureColours[1]);
  return script + "\n";
}

}  // namespace throng::bench
