// Numpy arrays over memory filled by C++.
// Invariant: an array owns or shares its memory, so no array outlives it.
#pragma once

#include <pybind11/numpy.h>

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "base/pose.h"
#include "culling/part_distance.h"

namespace throng {

/// Wraps the values without a copy; they live as long as the array or a view of it.
template <typename T>
pybind11::array_t<T> array_over(std::shared_ptr<std::vector<T>> values,
                                std::vector<pybind11::ssize_t> shape = {}) {
  if (shape.empty()) shape = {static_cast<pybind11::ssize_t>(values->size())};
  T* const data = values->data();
  auto* const share = new std::shared_ptr<std::vector<T>>(std::move(values));
  const pybind11::capsule owner(
      share, [](void* shared) { delete static_cast<std::shared_ptr<std::vector<T>>*>(shared); });
  return pybind11::array_t<T>(std::move(shape), data, owner);
}

template <typename T>
pybind11::array_t<T> array_of(std::vector<T> values, std::vector<pybind11::ssize_t> shape = {}) {
  return array_over(std::make_shared<std::vector<T>>(std::move(values)), std::move(shape));
}

/// Makes an array read-only, because others may share its memory.
inline void forbid_writing(pybind11::array& array) {
  array.attr("flags").attr("writeable") = false;
}

/// Writes 16 numbers, row by row. The matrix does not include the body's scale.
inline void put_matrix(const PartPose& pose, const Eigen::Vector3d& root_m, double* out) {
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 4; ++c) out[4 * r + c] = static_cast<double>(pose.rows[r][c]);
    out[4 * r + 3] += root_m[r];
  }
  out[12] = out[13] = out[14] = 0;
  out[15] = 1;
}

/// (lo_m, hi_m, point_a_m, point_b_m, normal, part_a, part_b, depth_m), see throng.Distance.
inline pybind11::tuple tuple_of(const PartDistance& distance) {
  const auto array = [](const auto& values) {
    return array_of(std::vector(values.begin(), values.end()));
  };
  return pybind11::make_tuple(distance.lo_m, distance.hi_m, array(distance.point_a_m),
                              array(distance.point_b_m), array(distance.normal), distance.part_a,
                              distance.part_b, distance.depth_m);
}

/// An array of any number type, converted to doubles in row-major order.
using DoubleArray =
    pybind11::array_t<double, pybind11::array::c_style | pybind11::array::forcecast>;

}  // namespace throng
