// Lofting: closed surfaces swept through cross-sections, the way a ship's hull is drawn.
// One rule: the same coordinates to the bit from any compiler, so only + - * / and sqrt, and every
// coordinate rounded to 10 micrometres.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "avatars/mesh/mesh.h"

namespace throng {

/// One horizontal cross-section of a body part that stands upright: four quarter ellipses around a
/// centre. Metres.
struct Section {
  double height;                    ///< z of the section
  double x, y;                      ///< its centre
  double front, back, left, right;  ///< half axes towards +x, -x, +y, -y
  double square;  ///< 0: elliptic quarters; 1: nearly rectangular ones (|x|^4 + |y|^4 = 1)
};

/// The section at a height between the rows of a table (heights strictly monotone): each column a
/// monotone cubic (Fritsch & Butland 1984), so that no bulge appears between the rows.
Section section_at(std::span<const Section> table, double height);

using Ring = std::vector<Eigen::Vector3d>;

/// Points of a section from +x over +y. `crowding` in [0, 1) draws them towards the front.
Ring ring_of(const Section& section, int segments, double crowding = 0);

/// A loft along a table of sections with rounded ends.
struct Loft {
  std::vector<Section> table;
  int rings = 0;
  int segments = 0;
  int first_cap_rings = 3;  ///< of `rings`, in the rounded end before the first row
  int last_cap_rings = 3;
  double first_cap_m = 0;  ///< how far the rounded end reaches beyond the first row
  double last_cap_m = 0;
};
std::vector<Ring> rings_of(const Loft& loft);

/// What closes the two ends of a tube of rings: a pole each, or, where absent, the flat end face.
struct Poles {
  const Eigen::Vector3d* first = nullptr;
  const Eigen::Vector3d* last = nullptr;
};

/// The closed, outward-oriented surface through rings. Vertices: rings in order, then
/// the first pole, then the last. Rounded to 10 micrometres.
Mesh tube(std::span<const Ring> rings, const Poles& poles);

/// The tube of a loft with a pole at the far end of each rounded end.
Mesh lofted(const Loft& loft);

/// Turns the mesh inside out if its volume is negative.
void orient_outwards(Mesh& mesh);

/// The mirror image in the body's midplane, y to -y, still oriented outwards.
Mesh mirrored(const Mesh& mesh);

/// The mesh seen from a frame whose origin lies at `origin`.
Mesh relative_to(const Mesh& mesh, const Eigen::Vector3d& origin);

/// The nearest multiple of 10 micrometres, never -0.
Eigen::Vector3f rounded(const Eigen::Vector3d& point);

/// The unit circle at `turns` of a full turn in [-1/2, 1/2]; (cos, sin), odd and even exactly.
Eigen::Vector2d on_circle(double turns);

}  // namespace throng
