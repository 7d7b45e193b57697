// Shapes of head, torso and pelvis: the parts on the midline.
#include <array>

#include "avatars/models/adult_body.h"
#include "avatars/models/loft.h"

namespace throng {
namespace {

Section on_midline(double height, double x, double front, double back, double half, double square) {
  return {height, x, 0, front, back, half, half, square};
}

/// Relief of the face in millimetres. Rows: rings from the bottom; columns: from the midline.
constexpr int kReliefColumns = 5;
constexpr std::array<std::array<double, kReliefColumns>, 18> kRelief = {{
    {},                  // neck
    {},                  //
    {},                  //
    {},                  //
    {-4, -3, -1},        // under the chin
    {7, 6, 2},           // chin
    {-2, -2, 0},         // below the lower lip
    {6, 4, 1},           // mouth
    {12, 5, 1, 0},       // upper lip and base of the nose
    {26, 9, -1, 1, 1},   // tip of the nose
    {17, 5, -3, 1, 3},   // bridge of the nose, cheek bones
    {6, -4, -9, -7, 0},  // eyes
    {4, 5, 4, 3, 1},     // brow
}};

/// Ears: rings 9 to 12, where the dense segments reach the side of the head.
constexpr int kEarSegment = 10;
constexpr std::array<double, 4> kEar_mm = {5, 12, 15, 12};
constexpr int kEarRing = 9;

}  // namespace

Mesh head_shape() {
  // Head 154 mm wide and 200 mm long, neck 398 mm around (ANSUR II, men).
  const std::vector<Section> sections = {
      on_midline(1.425, -0.005, 0.055, 0.052, 0.056, 0),
      on_midline(1.455, -0.008, 0.057, 0.058, 0.057, 0),
      on_midline(1.485, -0.006, 0.059, 0.062, 0.056, 0),
      on_midline(1.508, 0.000, 0.063, 0.065, 0.055, 0),
      on_midline(1.522, 0.013, 0.082, 0.074, 0.053, 0),
      on_midline(1.532, 0.020, 0.093, 0.079, 0.054, 0),
      on_midline(1.548, 0.022, 0.096, 0.085, 0.060, 0),
      on_midline(1.564, 0.022, 0.097, 0.091, 0.066, 0),
      on_midline(1.580, 0.022, 0.097, 0.095, 0.070, 0),
      on_midline(1.597, 0.022, 0.095, 0.098, 0.073, 0),
      on_midline(1.615, 0.022, 0.095, 0.100, 0.0745, 0),
      on_midline(1.632, 0.022, 0.094, 0.101, 0.0755, 0),
      on_midline(1.650, 0.022, 0.096, 0.101, 0.0765, 0),
      on_midline(1.674, 0.022, 0.096, 0.099, 0.0770, 0),
      on_midline(1.700, 0.021, 0.090, 0.094, 0.0730, 0),
      on_midline(1.721, 0.020, 0.076, 0.081, 0.0630, 0),
      on_midline(1.738, 0.018, 0.054, 0.060, 0.0460, 0),
      on_midline(1.747, 0.016, 0.027, 0.031, 0.0240, 0),
  };
  constexpr int kSegments = 30;
  std::vector<Ring> rings;
  for (size_t r = 0; r < sections.size(); ++r) {
    Ring ring = ring_of(sections[r], kSegments, 0.35);
    for (int k = 0; k < kReliefColumns; ++k) {
      const double out_m = kRelief[r][static_cast<size_t>(k)] * 1e-3;
      ring[static_cast<size_t>(k)].x() += out_m;
      if (k > 0) ring[static_cast<size_t>(kSegments - k)].x() += out_m;
    }
    const int ear = static_cast<int>(r) - kEarRing;
    if (ear >= 0 && ear < static_cast<int>(kEar_mm.size())) {
      const double out_m = kEar_mm[static_cast<size_t>(ear)] * 1e-3;
      ring[kEarSegment] += Eigen::Vector3d(-0.3, 1, 0) * out_m;
      ring[kSegments - kEarSegment] += Eigen::Vector3d(-0.3, -1, 0) * out_m;
    }
    rings.push_back(ring);
  }
  const Eigen::Vector3d bottom(-0.005, 0, 1.412);
  const Eigen::Vector3d crown(0.015, 0, kAdultHeight_m);
  return tube(rings, {&bottom, &crown});
}

Mesh torso_shape() {
  // Chest 289 x 254 mm (ANSUR II, men). The waist is rounder than the measured 326 x 238 mm. Below
  // it the trunk narrows to hide its lower end at any rotation on the pelvis.
  const std::vector<Section> table = {
      on_midline(1.000, 0.000, 0.096, 0.096, 0.104, 0),
      on_midline(1.0187, 0.000, 0.114, 0.111, 0.134, 0),
      on_midline(1.0374, 0.000, 0.118, 0.112, 0.142, 0.03),
      on_midline(1.060, 0.000, 0.119, 0.109, 0.145, 0.10),
      on_midline(1.130, 0.000, 0.119, 0.102, 0.149, 0.30),
      on_midline(1.200, 0.000, 0.120, 0.110, 0.151, 0.30),
      on_midline(1.270, 0.000, 0.124, 0.122, 0.154, 0.35),
      on_midline(1.330, 0.000, 0.118, 0.126, 0.158, 0.35),
      on_midline(1.380, 0.000, 0.102, 0.122, 0.170, 0.35),
      on_midline(1.415, 0.000, 0.084, 0.112, 0.184, 0.25),
      on_midline(1.440, 0.000, 0.068, 0.102, 0.184, 0.10),
      on_midline(1.460, 0.000, 0.056, 0.094, 0.150, 0),
      on_midline(1.480, 0.000, 0.048, 0.084, 0.098, 0),
      on_midline(1.505, 0.000, 0.040, 0.070, 0.058, 0),
  };
  constexpr int kRings = 28;
  std::vector<Ring> rings;
  for (int i = 0; i < kRings; ++i)
    rings.push_back(ring_of(section_at(table, 1.000 + (1.505 - 1.000) * i / (kRings - 1)), 30));
  const Eigen::Vector3d top(-0.012, 0, 1.512);
  return tube(rings, {nullptr, &top});
}

Mesh pelvis_shape() {
  // Hip breadth 346 mm, buttock depth 246 mm (ANSUR II, men). Table 1 gives it 74 vertices, mostly
  // where it enters the torso. There it narrows to a circle: no rotation turns a corner outwards.
  struct PelvisRing {
    Section section;
    int segments;
  };
  std::vector<Ring> rings;
  for (const auto& [section, segments] : {
           PelvisRing{on_midline(0.868, -0.005, 0.078, 0.094, 0.112, 0.2), 12},
           PelvisRing{on_midline(0.910, -0.005, 0.108, 0.130, 0.162, 0.3), 12},
           PelvisRing{on_midline(0.953, -0.003, 0.113, 0.136, 0.174, 0.3), 12},
           PelvisRing{on_midline(1.007, 0.000, 0.114, 0.122, 0.154, 0.05), 18},
           PelvisRing{on_midline(1.055, 0.000, 0.094, 0.093, 0.096, 0), 18},
       })
    rings.push_back(ring_of(section, segments));
  const Eigen::Vector3d crotch(0, 0, 0.840);
  const Eigen::Vector3d top(0, 0, 1.070);
  return tube(rings, {&crotch, &top});
}

}  // namespace throng
