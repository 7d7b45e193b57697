// The compiled half of the module `throng`; the other half, python/throng, gives it the shape that
// users see, with docstrings.
#include <pybind11/pybind11.h>

#include "base/version.h"
#include "python/bindings.h"
#include "python/errors.h"
#include "python/interrupts.h"
#include "python/rows.h"

namespace py = pybind11;

PYBIND11_MODULE(_core, module) {
  module.doc() = "The libraries of Throng; see the package throng.";
  module.attr("version") = std::string(throng::version());
  module.attr("commit") = std::string(throng::commit());
  throng::register_errors();
  throng::register_rows();
  throng::bind_run(module);
  throng::bind_simulation(module);
  throng::bind_model(module);
  throng::bind_culler(module);
  throng::bind_log(module);
  throng::bind_recording(module);
  py::module_::import("atexit").attr("register")(py::cpp_function(throng::join_left));
}
