// Lofting builds closed surfaces through cross-sections.
// Invariant: coordinates are equal to the bit for all compilers: only + - * / and sqrt are used,
// and every coordinate is rounded to 10 micrometres.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "avatars/mesh/mesh.h"

namespace throng {

/// One horizontal cross-section, in metres: four quarter ellipses around a centre.
struct Section {
  double height;                    ///< z of the section
  double x, y;                      ///< its centre
  double front, back, left, right;  ///< half axes towards +x, -x, +y, -y
  double square;  ///< 0: elliptic quarters; 1: nearly rectangular ones (|x|^4 + |y|^4 = 1)
};

/// Returns the section at a height between the rows of a table (heights strictly monotone). Each
/// column is a monotone cubic (Fritsch & Butland 1984), which adds no bulge between rows.
Section section_at(std::span<const Section> table, double height);

using Ring = std::vector<Eigen::Vector3d>;

/// Points of a section from +x over +y. `crowding` in [0, 1) moves them towards the front.
Ring ring_of(const Section& section, int segments, double crowding = 0);

struct Loft {
  std::vector<Section> table;
  int rings = 0;
  int segments = 0;
  int first_cap_rings = 3;  ///< number of `rings` in the rounded end before the first row
  int last_cap_rings = 3;
  double first_cap_m = 0;  ///< length of the rounded end before the first row
  double last_cap_m = 0;
};
std::vector<Ring> rings_of(const Loft& loft);

/// End points of a tube of rings: a pole per end, or null for a flat end face.
struct Poles {
  const Eigen::Vector3d* first = nullptr;
  const Eigen::Vector3d* last = nullptr;
};

/// Returns the closed, outward-oriented surface through rings. Vertices: rings in order, then the
/// first pole, then the last. Rounded to 10 micrometres.
Mesh tube(std::span<const Ring> rings, const Poles& poles);

Mesh lofted(const Loft& loft);

void orient_outwards(Mesh& mesh);

/// Returns the mirror image in the body's midplane, y to -y, still oriented outwards.
Mesh mirrored(const Mesh& mesh);

Mesh relative_to(const Mesh& mesh, const Eigen::Vector3d& origin);

/// Returns the nearest multiple of 10 micrometres, never -0.
Eigen::Vector3f rounded(const Eigen::Vector3d& point);

/// Returns (cos, sin) of `turns` in [-1/2, 1/2] of a full turn; exactly symmetric.
Eigen::Vector2d on_circle(double turns);

}  // namespace throng
