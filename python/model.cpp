// throng.Model: a URDF with meshes, and kinematics of many postures at once.
#include "avatars/model/model.h"

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <memory>

#include "avatars/mesh/mesh_file.h"
#include "base/errors.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/interrupts.h"

namespace py = pybind11;

namespace throng {
namespace {

using ModelPtr = std::shared_ptr<Model>;  // never modified: pybind11 holds no pointers to const

std::shared_ptr<Model> opened(const std::filesystem::path& urdf) {
  const std::filesystem::path file = urdf == "adult" ? adult_urdf() : urdf;
  return std::const_pointer_cast<Model>(
      result_from_thread<std::shared_ptr<const Model>>([file] { return load_model(file); }));
}

std::vector<std::string> joint_names(const Model& model) {
  std::vector<std::string> names;
  for (const JointColumn& column : model.kinematics.columns()) names.push_back(column.name);
  return names;
}

std::vector<std::string> part_names(const Model& model) {
  std::vector<std::string> names;
  for (const Part& part : model.parts) names.push_back(part.name);
  return names;
}

template <typename Field>
py::array limits(const Model& model, Field field) {
  std::vector<double> values;
  for (const JointColumn& column : model.kinematics.columns())
    values.push_back(static_cast<double>(column.*field));
  return array_of(std::move(values));
}

const Part& part_of(const Model& model, size_t part) {
  if (part >= model.parts.size())
    throw py::index_error(
        fmt::format("part: expected 0 to {}, found {}", model.parts.size() - 1, part));
  return model.parts[part];
}

py::array vertices(const Mesh& mesh) {
  std::vector<float> values;
  for (const Eigen::Vector3f& v : mesh.vertices)
    values.insert(values.end(), v.data(), v.data() + 3);
  return array_of(std::move(values), {static_cast<py::ssize_t>(mesh.vertices.size()), 3});
}

py::array triangles(const Mesh& mesh) {
  std::vector<int32_t> values;
  for (const Eigen::Vector3i& t : mesh.triangles)
    values.insert(values.end(), t.data(), t.data() + 3);
  return array_of(std::move(values), {static_cast<py::ssize_t>(mesh.triangles.size()), 3});
}

/// Throws InputError unless the array has that many rows and columns.
void require_rows(const char* name, const DoubleArray& array, py::ssize_t rows,
                  py::ssize_t columns) {
  const bool fits = columns == 0
                        ? array.ndim() == 1 && array.shape(0) == rows
                        : array.ndim() == 2 && array.shape(0) == rows && array.shape(1) == columns;
  if (fits) return;
  std::string found;
  for (py::ssize_t i = 0; i < array.ndim(); ++i)
    found += fmt::format("{}{}", i > 0 ? " x " : "", array.shape(i));
  throw InputError(name,
                   columns == 0 ? fmt::format("{} numbers", rows)
                                : fmt::format("{} x {} numbers", rows, columns),
                   found.empty() ? "a single one" : found);
}

void require_finite(const char* name, const DoubleArray& array) {
  for (py::ssize_t i = 0; i < array.size(); ++i)
    if (!std::isfinite(static_cast<float>(array.data()[i])))  // stored as float
      throw InputError(name, "finite numbers", fmt::format("{} at place {}", array.data()[i], i));
}

std::vector<RootFrame> roots_of(py::ssize_t rows, const std::optional<DoubleArray>& rotations_xyzw,
                                const std::optional<DoubleArray>& scales) {
  std::vector<RootFrame> roots(static_cast<size_t>(rows));
  if (rotations_xyzw) {
    require_rows("rotations_xyzw", *rotations_xyzw, rows, 4);
    require_finite("rotations_xyzw", *rotations_xyzw);
    for (size_t i = 0; i < roots.size(); ++i) {
      const Eigen::Quaterniond q(Eigen::Map<const Eigen::Vector4d>(rotations_xyzw->data() + 4 * i));
      if (q.norm() < 1e-6)
        throw InputError(fmt::format("rotations_xyzw[{}]", i), "a quaternion (x, y, z, w)",
                         "zeros");
      roots[i].world_from_root = q.normalized().cast<float>();
    }
  }
  if (scales) {
    require_rows("scales", *scales, rows, 0);
    for (size_t i = 0; i < roots.size(); ++i) {
      const double scale = scales->data()[i];
      if (!(scale > 0 && scale < 1e6))
        throw InputError(fmt::format("scales[{}]", i), "a number above 0",
                         fmt::format("{}", scale));
      roots[i].scale = static_cast<float>(scale);
    }
  }
  return roots;
}

/// Data of the kinematics of many postures, which may complete after the caller has stopped
/// waiting.
struct PoseWork {
  ModelPtr model;
  std::vector<float> postures;
  std::vector<double> positions_m;  ///< three per root, or empty
  std::vector<RootFrame> roots;

  std::vector<double> matrices() const {
    const auto parts = static_cast<size_t>(model->part_count());
    std::vector<PartPose> poses(roots.size() * parts);
    forward_kinematics(model->kinematics, postures, roots, poses);
    std::vector<double> out(16 * poses.size());
    for (size_t i = 0; i < poses.size(); ++i)
      put_matrix(
          poses[i],
          positions_m.empty()
              ? Eigen::Vector3d(0, 0, 0)
              : Eigen::Vector3d(Eigen::Map<const Eigen::Vector3d>(&positions_m[i / parts * 3])),
          &out[16 * i]);
    return out;
  }
};

py::array poses(const ModelPtr& model, const DoubleArray& joints,
                const std::optional<DoubleArray>& positions_m,
                const std::optional<DoubleArray>& rotations_xyzw,
                const std::optional<DoubleArray>& scales) {
  const py::ssize_t rows = joints.ndim() == 2 ? joints.shape(0) : 1;
  if (joints.ndim() != 1 || joints.shape(0) != model->kinematics.column_count())
    require_rows("joint_positions", joints, rows, model->kinematics.column_count());
  require_finite("joint_positions", joints);
  if (positions_m) {
    require_rows("positions_m", *positions_m, rows, 3);
    require_finite("positions_m", *positions_m);
  }
  const std::vector<RootFrame> roots = roots_of(rows, rotations_xyzw, scales);
  const auto parts = static_cast<size_t>(model->part_count());
  const auto work = std::make_shared<PoseWork>();
  work->model = model;
  work->postures.assign(joints.data(), joints.data() + joints.size());
  if (positions_m)
    work->positions_m.assign(positions_m->data(), positions_m->data() + positions_m->size());
  work->roots = roots_of(rows, rotations_xyzw, scales);
  constexpr size_t kFew = 10'000;  // takes 1 to 2 ms, too short for a separate thread
  std::vector<double> out =
      work->roots.size() * parts < kFew
          ? work->matrices()
          : result_from_thread<std::vector<double>>([work] { return work->matrices(); });
  return array_of(std::move(out), {rows, static_cast<py::ssize_t>(parts), 4, 4});
}

py::tuple mesh_arrays(const std::filesystem::path& file) {
  using Read = std::pair<Mesh, std::vector<std::string>>;
  const auto [mesh, notes] = result_from_thread<Read>([file] {
    Read read;
    read.first = read_mesh(file, {}, &read.second);
    return read;
  });
  return py::make_tuple(vertices(mesh), triangles(mesh), notes);
}

}  // namespace

void bind_model(py::module_& module) {
  py::class_<Model, ModelPtr>(module, "Model")
      .def(py::init(&opened), py::arg("urdf"))
      .def_readonly("name", &Model::name)
      .def_readonly("height_m", &Model::height_m)
      .def_readonly("is_person", &Model::is_person)
      .def_property_readonly("reach_m", [](const Model& model) { return reach_of(model); })
      .def_property_readonly("notes", [](const Model& model) { return model.assumptions; })
      .def_property_readonly("joint_names", joint_names)
      .def_property_readonly("part_names", part_names)
      .def_property_readonly("joint_lower",
                             [](const Model& m) { return limits(m, &JointColumn::lower); })
      .def_property_readonly("joint_upper",
                             [](const Model& m) { return limits(m, &JointColumn::upper); })
      .def(
          "vertices_m", [](const Model& m, size_t part) { return vertices(part_of(m, part).mesh); },
          py::arg("part"))
      .def(
          "triangles", [](const Model& m, size_t part) { return triangles(part_of(m, part).mesh); },
          py::arg("part"))
      .def("poses", poses, py::arg("joint_positions"), py::arg("positions_m"),
           py::arg("rotations_xyzw"), py::arg("scales"));
  module.def("read_mesh", mesh_arrays, py::arg("file"));
}

}  // namespace throng
