// Poses of parts as 4 x 4 matrices of doubles, world_from_part, and back.
#pragma once

#include <pybind11/numpy.h>

#include <cstdint>

#include "base/pose.h"

namespace throng {

/// 16 numbers, row by row. `scale` is the body's: it is not part of the matrix.
inline void put_matrix(const PartPose& pose, const Eigen::Vector3d& root_m, double* out) {
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 4; ++c) out[4 * r + c] = static_cast<double>(pose.rows[r][c]);
    out[4 * r + 3] += root_m[r];
  }
  out[12] = out[13] = out[14] = 0;
  out[15] = 1;
}

/// An array of numbers of any type, as doubles in rows one after another.
using DoubleArray =
    pybind11::array_t<double, pybind11::array::c_style | pybind11::array::forcecast>;

}  // namespace throng
