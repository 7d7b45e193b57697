// Shapes, poses and oracles shared by the tests of culling.
// Invariant: all random numbers come from a seed that the test prints.
#pragma once

#include <string>
#include <vector>

#include "bench/workbench/random_pairs.h"

namespace throng::test {

using bench::both;
using bench::box_solid;
using bench::bumpy_ellipsoid;
using bench::Draw;
using bench::inside_out;
using bench::mixed_part;
using bench::MixedPart;
using bench::placed_exactly;
using bench::reach_of;
using bench::Solid;
using bench::winding_number;

struct Shape {
  std::string name;
  std::vector<Eigen::Vector3f> points;
};

/// Point clouds of special kinds of parts: flat, linear, repeated, large, far away.
inline std::vector<Shape> special_shapes(uint64_t seed) {
  Draw draw(seed, 1);
  const auto cloud = [&](int count, const Eigen::Vector3d& size, const Eigen::Vector3d& offset) {
    std::vector<Eigen::Vector3f> points;
    for (int i = 0; i < count; ++i)
      points.push_back((draw.in_box(1).cwiseProduct(size) + offset).cast<float>());
    return points;
  };
  std::vector<Eigen::Vector3f> tilted_flat, ball, cube;
  const Eigen::Matrix3d turn = draw.rotation().toRotationMatrix();
  for (const Eigen::Vector3f& p : cloud(60, {0.3, 0.2, 0}, {0, 0, 0}))
    tilted_flat.push_back((turn * p.cast<double>()).cast<float>());
  for (int i = 0; i < 300; ++i)
    ball.push_back((0.2 * draw.direction() + Eigen::Vector3d(0, 0.1, 0)).cast<float>());
  for (int i = 0; i < 8; ++i)
    cube.push_back({(i & 1) ? 0.5f : -0.5f, (i & 2) ? 0.5f : -0.5f, (i & 4) ? 0.5f : -0.5f});
  return {{"one point", cloud(1, {1, 1, 1}, {0, 0, 0})},
          {"a point at the origin", {Eigen::Vector3f::Zero()}},
          {"two points", cloud(2, {0.3, 0.3, 0.3}, {0, 0, 0})},
          {"the same point twice", {{0.1f, 0.2f, 0.3f}, {0.1f, 0.2f, 0.3f}}},
          {"points on a line", {{0, 0, 0}, {0.1f, 0.1f, 0.1f}, {0.3f, 0.3f, 0.3f}}},
          {"flat", cloud(60, {0.3, 0.2, 0}, {0, 0, 0})},
          {"flat and tilted", tilted_flat},
          {"needle", cloud(40, {1e-5, 1e-5, 1}, {0, 0, 0})},
          {"limb", cloud(150, {0.05, 0.06, 0.25}, {0, 0, -0.2})},
          {"ball", ball},
          {"cube", cube},
          {"huge", cloud(80, {300, 200, 100}, {10, 20, 30})},
          {"tiny", cloud(80, {1e-4, 2e-4, 1e-4}, {0, 0, 0})},
          {"far from its origin", cloud(80, {0.1, 0.2, 0.3}, {40, -30, 20})}};
}

}  // namespace throng::test
