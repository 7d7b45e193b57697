// Arrays of numpy over memory that C++ filled.
// One rule: an array owns what it shows, or shares it with others that do: none can outlive its
// memory.
#pragma once

#include <pybind11/numpy.h>

#include <memory>
#include <utility>
#include <vector>

namespace throng {

/// Shows the values without copying them; they live as long as the array, or a part of it.
template <typename T>
pybind11::array_t<T> array_over(std::shared_ptr<std::vector<T>> values,
                                std::vector<pybind11::ssize_t> shape = {}) {
  if (shape.empty()) shape = {static_cast<pybind11::ssize_t>(values->size())};
  T* const data = values->data();
  auto* const share = new std::shared_ptr<std::vector<T>>(std::move(values));
  const pybind11::capsule owner(
      share, [](void* held) { delete static_cast<std::shared_ptr<std::vector<T>>*>(held); });
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

}  // namespace throng
