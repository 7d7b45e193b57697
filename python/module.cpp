// The compiled part of the module `throng`; python/throng defines the public interface with
// docstrings.
#include <fmt/format.h>
#include <pybind11/pybind11.h>

#include <filesystem>
#include <string>
#include <utility>

#include "base/errors.h"
#include "base/version.h"
#include "python/bindings.h"
#include "python/interrupts.h"
#include "python/rows.h"

namespace py = pybind11;

namespace throng {
namespace {

/// File names need not be UTF-8.
py::object text_of(const std::string& text) {
  return py::reinterpret_steal<py::object>(
      PyUnicode_DecodeUTF8(text.data(), static_cast<Py_ssize_t>(text.size()), "replace"));
}

void raise(const char* name, const std::string& message, const std::string& where) {
  const py::object type = py::module_::import("throng._errors").attr(name);
  const py::object error = type(text_of(message), text_of(where));
  PyErr_SetObject(type.ptr(), error.ptr());
}

void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(std::move(thrown));
  } catch (const InputError& error) {
    raise("InputError", error.what(), error.where());
  } catch (const EnvironmentError& error) {
    raise("EnvironmentFault", error.what(), "");
  } catch (const std::filesystem::filesystem_error& error) {
    raise("EnvironmentFault", fmt::format("{}: {}", error.path1().string(), error.code().message()),
          "");
  }
}

/// Converts C++ exceptions of the module to the classes of throng/_errors.py, with message, file
/// and line.
void register_errors() { py::register_exception_translator(translate); }

}  // namespace
}  // namespace throng

PYBIND11_MODULE(_core, module) {
  module.doc() = "Compiled part of the package throng.";
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
  throng::bind_study(module);
  py::module_::import("atexit").attr("register")(py::cpp_function(throng::join_abandoned_jobs));
}
