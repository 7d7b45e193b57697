// touching_by_brute_force() lists the touching pairs of a random world.
#pragma once

#include <vector>

#include "culling/triangles/triangle_bvh.h"
#include "tests/culling/random_bodies.h"

namespace throng::test {

/// Pairs of parts of different bodies whose solids touch, by testing all.
inline std::vector<PairKey> touching_by_brute_force(const RandomBodies& world) {
  std::vector<std::vector<TriangleBvh>> surfaces;
  for (const auto& type : world.types) {
    surfaces.emplace_back();
    for (const PartShape& part : type->parts())
      surfaces.back().emplace_back(part.points, part.triangles);
  }
  std::vector<PairKey> out;
  TriangleCounters counters;
  for (size_t a = 0; a < world.ids.size(); ++a) {
    for (size_t b = a + 1; b < world.ids.size(); ++b) {
      if (world.types[world.type_of[a]]->is_static() && world.types[world.type_of[b]]->is_static())
        continue;
      const Eigen::Vector3f shift =
          (world.roots[b].position_m - world.roots[a].position_m).cast<float>();
      if (shift.norm() > 20) continue;  // farther than the two largest bodies reach
      const auto& surfaces_a = surfaces[world.type_of[a]];
      const auto& surfaces_b = surfaces[world.type_of[b]];
      for (size_t pa = 0; pa < surfaces_a.size(); ++pa)
        for (size_t pb = 0; pb < surfaces_b.size(); ++pb)
          if (solids_touch(surfaces_a[pa], world.pose(a, pa), world.scales[a], surfaces_b[pb],
                           world.pose(b, pb), world.scales[b], shift, counters))
            out.emplace_back(world.ids[a], world.ids[b], static_cast<uint32_t>(pa),
                             static_cast<uint32_t>(pb));
    }
  }
  return out;
}

}  // namespace throng::test
