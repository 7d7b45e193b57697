// Functions that bind the parts of the module; each file of the folder defines its own.
#pragma once

#include <pybind11/pybind11.h>

namespace throng {

void bind_run(pybind11::module_& module);
void bind_simulation(pybind11::module_& module);
void bind_model(pybind11::module_& module);
void bind_culler(pybind11::module_& module);
void bind_log(pybind11::module_& module);
void bind_recording(pybind11::module_& module);
void bind_study(pybind11::module_& module);

}  // namespace throng
