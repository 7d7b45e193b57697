// Errors of the libraries as exceptions of Python: throng.InputError, throng.EnvironmentFault.
// One rule: what an error knows (its message, file and line) gets through; only names of options
// are written as Python has them.
#pragma once

#include <pybind11/pybind11.h>

namespace throng {

/// From here on what the module's functions throw becomes the classes of throng/_errors.py.
void register_errors();

}  // namespace throng
