#include "python/run_request.h"

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>

#include "analysis/trajectories/walkable_area.h"
#include "base/errors.h"
#include "base/text.h"

namespace py = pybind11;

namespace throng {
namespace {

/// Takes known values out of a dictionary and reports unknown ones.
class Arguments {
 public:
  explicit Arguments(const py::dict& arguments) : arguments_(arguments) {}

  /// Throws TypeError for another type, InputError for integers with too many bits.
  template <typename T>
  std::optional<T> take(const char* name, const char* what) {
    known_names_.emplace_back(name);
    if (!arguments_.contains(name) || arguments_[name].is_none()) return {};
    const py::object value = arguments_[name];
    try {
      return value.cast<T>();
    } catch (const py::cast_error&) {
      if constexpr (std::is_same_v<T, int64_t> || std::is_same_v<T, double>)
        if (py::isinstance<py::int_>(value) || py::hasattr(value, "__index__"))
          throw InputError(name, what, written(py::int_(value)));
      throw py::type_error(
          fmt::format("{}: expected {}, found {}", name, what, std::string(py::repr(value))));
    }
  }
  template <typename T>
  void take(const char* name, const char* what, T& out) {
    if (std::optional<T> value = take<T>(name, what)) out = std::move(*value);
  }
  void number(const char* name, double low, double high, bool open, const std::string& what,
              std::optional<double>& out) {
    out = take<double>(name, what.c_str());
    if (out) require_number(name, *out, low, high, open, what);
  }
  void option(const RunOption& row, RunOptions& out) {
    const std::optional<std::string> text = text_of(row);
    if (text) row.read(*text, row.name, out);
  }

  /// Throws TypeError for unknown names, as Python functions do.
  void expect_all_known() const {
    for (const auto& [key, value] : arguments_) {
      const auto name = key.cast<std::string>();
      if (std::find(known_names_.begin(), known_names_.end(), name) == known_names_.end())
        throw py::type_error(
            fmt::format("unexpected option '{}'{}", name, did_you_mean(name, known_names_)));
    }
  }

 private:
  /// Returns the value as text of a command line.
  std::optional<std::string> text_of(const RunOption& row) {
    const char* const name = row.name.c_str();
    switch (row.kind) {
      case RunOption::Kind::kFlag: {
        const std::optional<bool> value = take<bool>(name, "True or False");
        return value ? std::optional<std::string>(*value ? "true" : "false") : std::nullopt;
      }
      case RunOption::Kind::kWhole: {
        const std::optional<int64_t> value = take<int64_t>(name, row.expected.c_str());
        return value ? std::optional(fmt::format("{}", *value)) : std::nullopt;
      }
      case RunOption::Kind::kNumber: {
        const std::optional<double> value = take<double>(name, row.expected.c_str());
        return value ? std::optional(fmt::format("{}", *value)) : std::nullopt;
      }
      case RunOption::Kind::kWord:
      case RunOption::Kind::kText:
        return take<std::string>(name, row.expected.c_str());
    }
    return std::nullopt;
  }

  /// Python does not convert integers of more than 4300 digits to text.
  static std::string written(const py::int_& number) {
    constexpr size_t kMaxBits = 256;
    const auto bits = number.attr("bit_length")().cast<size_t>();
    return bits > kMaxBits ? fmt::format("one of {} bits", bits)
                           : py::str(py::handle(number)).cast<std::string>();
  }

  const py::dict& arguments_;
  std::vector<std::string> known_names_;
};

}  // namespace

void require_number(const char* option, double value, double low, double high, bool open,
                    const std::string& what) {
  const std::string text = fmt::format("{}", value);
  if (!number_option(low, high, open, what)(text).empty()) throw InputError(option, what, text);
}

RunRequest request_of(const py::dict& dict) {
  Arguments arguments(dict);
  RunRequest request;
  arguments.take("source", "a name or a path", request.source);
  arguments.take("scene_text", "the text of a scene file", request.scene_text);
  for (const RunOption& row : run_options()) arguments.option(row, request.options);
  request.simulation = simulation_options(request.options);
  arguments.take("culling", "True or False", request.simulation.culling);
  arguments.take("joint_positions", "True or False", request.simulation.postures);
  arguments.number("trajectory_fps", 0, 1e4, true, "a number of frames per second above 0",
                   request.trajectory_fps);
  arguments.take("trajectories", "True or False", request.trajectories);
  arguments.take("log", "a path", request.log);
  arguments.take("html", "a path", request.html);
  arguments.take("contacts", "a folder", request.contacts);
  arguments.take("separation", "a folder", request.separation);
  arguments.take("trace_hash", "a path", request.trace_hash);
  arguments.take("trajectory", "a list of paths", request.trajectory);
  std::string area;
  arguments.take("trajectory_area", "'largest' or a whole number from 1", area);
  request.trajectory_piece = trajectory_piece(area);
  if (!area.empty() && !request.trajectory_piece)
    throw InputError("trajectory_area", "'largest' or a whole number from 1",
                     fmt::format("'{}'", area));
  arguments.expect_all_known();
  return request;
}

RunSource open_source(const RunRequest& request) {
  return request.scene_text.empty()
             ? open_run_source(request.source, request.options)
             : open_scene_text(request.scene_text, request.source, request.options);
}

}  // namespace throng
