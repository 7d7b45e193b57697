// Shapes of legs, feet and arms, left side.
#include <array>

#include "avatars/models/adult_body.h"
#include "avatars/models/loft.h"

namespace throng {
namespace {

/// Half axes of a limb at a height; the centre line is straight from joint to joint.
struct Girth {
  double height, front, back, outer, inner;
};

std::vector<Section> along(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                           std::initializer_list<Girth> girths) {
  std::vector<Section> table;
  for (const Girth& g : girths) {
    const Eigen::Vector3d c = from + (to - from) * ((g.height - from.z()) / (to.z() - from.z()));
    table.push_back({g.height, c.x(), c.y(), g.front, g.back, g.outer, g.inner, 0});
  }
  return table;
}

}  // namespace

Mesh upper_leg_shape() {
  // Thigh 625 mm around (ANSUR II, men).
  const AdultJoints& j = adult_joints();
  Loft loft;
  loft.table = along(j.hip, j.knee,
                     {
                         {0.935, 0.092, 0.100, 0.084, 0.066},
                         {0.880, 0.102, 0.112, 0.093, 0.080},
                         {0.820, 0.106, 0.106, 0.094, 0.085},
                         {0.740, 0.102, 0.094, 0.086, 0.079},
                         {0.660, 0.091, 0.083, 0.075, 0.070},
                         {0.580, 0.076, 0.069, 0.062, 0.060},
                         {0.530, 0.065, 0.060, 0.056, 0.056},
                         {j.knee.z(), 0.060, 0.055, 0.054, 0.054},
                     });
  loft.rings = 22;
  loft.segments = 32;
  loft.first_cap_m = 0.070;
  loft.last_cap_m = 0.050;
  return lofted(loft);
}

Mesh lower_leg_shape() {
  // Calf 392 mm, ankle 229 mm around (ANSUR II, men).
  const AdultJoints& j = adult_joints();
  Loft loft;
  loft.table = along(j.knee, j.ankle,
                     {
                         {j.knee.z(), 0.057, 0.053, 0.053, 0.053},
                         {0.455, 0.054, 0.057, 0.053, 0.053},
                         {0.400, 0.051, 0.074, 0.059, 0.059},
                         {0.350, 0.049, 0.079, 0.061, 0.061},
                         {0.280, 0.045, 0.066, 0.054, 0.054},
                         {0.200, 0.039, 0.048, 0.043, 0.043},
                         {0.130, 0.035, 0.040, 0.035, 0.035},
                         {0.095, 0.036, 0.042, 0.035, 0.035},
                         {j.ankle.z(), 0.038, 0.042, 0.036, 0.037},
                     });
  loft.rings = 22;
  loft.segments = 32;
  loft.first_cap_m = 0.052;
  loft.last_cap_m = 0.030;
  return lofted(loft);
}

Mesh foot_shape() {
  // 271 x 102 mm (ANSUR II, men). Rings stand across x, from the heel to the toes.
  struct Slice {
    double x, outer, inner, top, sole;
  };
  static constexpr std::array<Slice, 10> kSlices = {{
      {-0.056, 0.021, 0.021, 0.046, 0.008},
      {-0.043, 0.031, 0.031, 0.070, 0},
      {-0.020, 0.036, 0.035, 0.092, 0},
      {0.010, 0.038, 0.038, 0.098, 0},
      {0.045, 0.041, 0.040, 0.082, 0},
      {0.085, 0.045, 0.042, 0.062, 0},
      {0.120, 0.051, 0.046, 0.047, 0},
      {0.152, 0.053, 0.047, 0.037, 0},
      {0.182, 0.043, 0.046, 0.028, 0},
      {0.202, 0.018, 0.040, 0.022, 0.003},
  }};
  // Half an outline, top to sole, in shares of half width and height. Flat to stand on.
  static constexpr std::array<std::array<double, 2>, 7> kOutline = {
      {{0, 1}, {0.50, 0.90}, {0.86, 0.62}, {1, 0.34}, {0.96, 0.10}, {0.60, 0}, {0, 0}}};
  const AdultJoints& j = adult_joints();
  const auto point = [&](const Slice& s, int k) {
    const bool outer = k <= 6;
    const auto& [across, up] = kOutline[static_cast<size_t>(outer ? k : 12 - k)];
    return Eigen::Vector3d(j.ankle.x() + s.x, j.ankle.y() + across * (outer ? s.outer : -s.inner),
                           s.sole + up * (s.top - s.sole));
  };
  std::vector<Ring> rings;
  for (const Slice& slice : kSlices) {
    Ring ring;
    for (int k = 0; k < 12; ++k) ring.push_back(point(slice, k));
    rings.push_back(ring);
  }
  const Eigen::Vector3d heel(j.ankle.x() - 0.060, j.ankle.y(), 0.026);
  const Eigen::Vector3d toe(j.ankle.x() + 0.211, j.ankle.y() - 0.014, 0.011);
  return tube(rings, {&heel, &toe});
}

Mesh upper_arm_shape() {
  // Biceps 358 mm around when flexed (ANSUR II, men); drawn relaxed.
  const AdultJoints& j = adult_joints();
  Loft loft;
  loft.table = along(j.shoulder, j.elbow,
                     {
                         {1.425, 0.055, 0.056, 0.056, 0.054},
                         {1.400, 0.059, 0.059, 0.058, 0.053},
                         {1.365, 0.059, 0.058, 0.056, 0.050},
                         {1.320, 0.055, 0.053, 0.050, 0.047},
                         {1.270, 0.057, 0.052, 0.049, 0.047},
                         {1.210, 0.053, 0.048, 0.045, 0.045},
                         {1.150, 0.046, 0.043, 0.043, 0.043},
                         {j.elbow.z(), 0.043, 0.042, 0.044, 0.044},
                     });
  loft.rings = 28;
  loft.segments = 48;
  loft.first_cap_rings = 5;
  loft.last_cap_rings = 4;
  loft.first_cap_m = 0.048;
  loft.last_cap_m = 0.036;
  return lofted(loft);
}

Mesh lower_arm_shape() {
  // Forearm 310 mm, wrist 176 mm around (ANSUR II, men).
  const AdultJoints& j = adult_joints();
  Loft loft;
  loft.table = along(j.elbow, j.wrist,
                     {
                         {j.elbow.z(), 0.038, 0.037, 0.039, 0.039},
                         {1.060, 0.048, 0.044, 0.046, 0.045},
                         {1.030, 0.050, 0.045, 0.047, 0.045},
                         {0.970, 0.043, 0.040, 0.039, 0.038},
                         {0.900, 0.034, 0.032, 0.028, 0.027},
                         {0.860, 0.031, 0.030, 0.023, 0.022},
                         {j.wrist.z(), 0.031, 0.030, 0.022, 0.021},
                     });
  loft.rings = 71;
  loft.segments = 16;
  loft.first_cap_rings = 8;
  loft.last_cap_rings = 5;
  loft.first_cap_m = 0.034;
  loft.last_cap_m = 0.022;
  return lofted(loft);
}

}  // namespace throng
