#include "python/errors.h"

#include <fmt/format.h>

#include <filesystem>
#include <string>
#include <utility>

#include "base/errors.h"

namespace py = pybind11;

namespace throng {
namespace {

/// A name of a file may be no UTF-8.
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

}  // namespace

void register_errors() { py::register_exception_translator(translate); }

}  // namespace throng
