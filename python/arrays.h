// Arrays of numpy over memory that C++ filled.
// One rule: an array owns what it shows, or shares it with others that do: none can outlive its
// memory.
#pragma once

#include <pybind11/numpy.h>

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "base/pose.h"

namespace throng {

/// Shows the values without copying them; they live as long as the array, or a part of it.
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

/// Nobody writes into an array that others may hold, too.
inline void forbid_writing(pybind11::array& array) {
  array.attr("flags").attr("writeable") = false;
}

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
