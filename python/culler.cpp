// throng.Culler: culling of custom bodies in custom poses.
#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>

#include "avatars/model/model.h"
#include "base/errors.h"
#include "base/limits.h"
#include "culling/part_distance.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/interrupts.h"
#include "python/posed_parts.h"
#include "python/recorder.h"
#include "python/run_request.h"
#include "scenes/file/part_words.h"

namespace py = pybind11;

namespace throng {
namespace {

using ShapePtr = std::shared_ptr<BodyShape>;

PartShape shape_of(const Mesh& mesh) { return {mesh.vertices, mesh.triangles}; }

ShapePtr shape_of_model(const Model& model) {
  auto shape = std::make_shared<BodyShape>();
  for (const Part& part : model.parts) {
    shape->parts.push_back(shape_of(part.mesh));
    shape->part_names.push_back(part.name);
  }
  return shape;
}

PartShape part_of(
    size_t number, const DoubleArray& points,
    const std::optional<py::array_t<int64_t, py::array::c_style | py::array::forcecast>>&
        triangles) {
  const std::string where = fmt::format("parts[{}]", number);
  if (points.ndim() != 2 || points.shape(1) != 3 || points.shape(0) == 0)
    throw InputError(where, "N x 3 coordinates in metres, N at least 1", "another shape");
  PartShape part;
  for (py::ssize_t i = 0; i < points.shape(0); ++i) {
    for (int axis = 0; axis < 3; ++axis)
      if (const double at_m = points.data()[3 * i + axis]; !(std::abs(at_m) <= kMaxDescribed))
        throw InputError(where, fmt::format("coordinates of at most {:g} m", kMaxDescribed),
                         fmt::format("{:g} at point {}", at_m, i));
    part.points.push_back(Eigen::Map<const Eigen::Vector3d>(points.data() + 3 * i).cast<float>());
  }
  if (!triangles) return part;
  if (triangles->ndim() != 2 || triangles->shape(1) != 3)
    throw InputError(where, "M x 3 indices of points", "triangles of another shape");
  for (py::ssize_t i = 0; i < triangles->shape(0); ++i) {
    const int64_t* corner = triangles->data() + 3 * i;
    for (int c = 0; c < 3; ++c)
      if (corner[c] < 0 || corner[c] >= points.shape(0))
        throw InputError(where, fmt::format("indices from 0 to {}", points.shape(0) - 1),
                         fmt::format("{} in triangle {}", corner[c], i));
    part.triangles.emplace_back(static_cast<int>(corner[0]), static_cast<int>(corner[1]),
                                static_cast<int>(corner[2]));
  }
  return part;
}

ShapePtr shape_of_parts(const py::list& parts, std::vector<std::string> names, bool is_static) {
  auto shape = std::make_shared<BodyShape>();
  shape->is_static = is_static;
  shape->part_names = std::move(names);
  for (size_t i = 0; i < parts.size(); ++i) {
    const auto pair = parts[i].cast<py::tuple>();
    using Corners = py::array_t<int64_t, py::array::c_style | py::array::forcecast>;
    shape->parts.push_back(
        part_of(i, pair[0].cast<DoubleArray>(), pair[1].cast<std::optional<Corners>>()));
  }
  if (shape->parts.empty() || shape->parts.size() > BodyType::kMaxParts)
    throw InputError("parts", fmt::format("1 to {} parts", BodyType::kMaxParts),
                     fmt::format("{}", shape->parts.size()));
  return shape;
}

/// PosedCuller culls bodies in any pose. If a body reaches farther than before, it rebuilds the
/// culler with larger spheres and transfers the state.
class PosedCuller {
 public:
  PosedCuller(std::vector<ShapePtr> shapes, const PartVolumes& volumes,
              const CullerOptions& options, int threads)
      : shapes_(shapes.begin(), shapes.end()),
        volumes_(volumes),
        options_(options),
        workers_(threads),
        parts_(shapes_),
        next_parts_(shapes_),
        reach_m_(shapes_.size(), 0) {
    make();  // reports invalid shapes at once
  }

  /// Bodies of a step: their ids, types and scales.
  struct Bodies {
    std::vector<uint32_t> ids;
    std::vector<uint16_t> types;
    std::vector<float> scales;
  };

  /// Without effect if it throws.
  void step(std::span<const double> matrices, size_t stride, Bodies bodies) {
    next_parts_.set(matrices, stride, bodies.types, bodies.scales);
    std::swap(parts_, next_parts_);
    bodies_ = std::move(bodies);  // the spans of parts_ remain valid
    if (grow()) {
      Archive state;
      culler_->archive(state);
      make();
      Archive again(state.bytes(), "culler");
      culler_->archive(again);
    }
    culler_->step({bodies_.ids, bodies_.types, bodies_.scales, parts_.roots()}, parts_);
    store_events();
    ++frame_;
  }
  void finish() {
    culler_->finish();
    store_events();
  }

  /// Distance of bodies of the latest step. Throws InputError.
  PartDistance distance(uint32_t a, const PartChoice& part_a, uint32_t b,
                        const PartChoice& part_b) const {
    const uint32_t at_a = index_of(a, "a"), at_b = index_of(b, "b");
    if (a == b) throw InputError("b", "another body than a", fmt::format("{}", b));
    const std::vector<uint8_t> parts_a = chosen_parts(part_a, part_names(at_a), "part_a"),
                               parts_b = chosen_parts(part_b, part_names(at_b), "part_b");
    std::vector<PartPose> poses_a, poses_b;
    return part_distance(types_, posed(at_a, parts_a, poses_a), posed(at_b, parts_b, poses_b));
  }

  const Culler& culler() const { return *culler_; }
  const std::vector<EventRow>& events() const { return events_; }
  size_t latest() const { return latest_; }
  int64_t frame() const { return frame_; }
  const std::vector<std::shared_ptr<const BodyShape>>& shapes() const { return shapes_; }

  double step_s = std::numeric_limits<double>::infinity();
  /// A step is running, in another thread or after Ctrl-C.
  std::atomic<bool> is_busy{false};
  void expect_idle() const {
    if (is_busy)
      throw std::runtime_error(
          "a step of this culler is still running, in another thread or interrupted; use one "
          "thread at a time");
  }

 private:
  uint32_t index_of(uint32_t id, const char* where) const {
    const auto at = std::lower_bound(bodies_.ids.begin(), bodies_.ids.end(), id);
    if (at == bodies_.ids.end() || *at != id)
      throw InputError(where, "the id of a body of the last step", fmt::format("{}", id));
    return static_cast<uint32_t>(at - bodies_.ids.begin());
  }
  const std::vector<std::string>& part_names(uint32_t body) const {
    return shapes_[bodies_.types[body]]->part_names;
  }
  BodyInPose posed(uint32_t body, std::span<const uint8_t> parts,
                   std::vector<PartPose>& poses) const {
    poses.resize(part_names(body).size());
    parts_.poses({&body, 1}, poses);
    return {bodies_.ids[body],
            bodies_.types[body],
            bodies_.scales[body],
            parts_.roots()[body].position_m,
            poses,
            parts};
  }
  bool grow() {
    constexpr float kGrowth = 1.5F;
    bool grows = false;
    for (size_t type = 0; type < reach_m_.size(); ++type) {
      if (parts_.reach_m()[type] * 1.0001F <= reach_m_[type]) continue;
      reach_m_[type] = parts_.reach_m()[type] * (reach_m_[type] > 0 ? kGrowth : 1.05F);
      grows = true;
    }
    return grows;
  }
  void make() {
    std::vector<std::shared_ptr<const BodyType>> types;
    for (size_t type = 0; type < shapes_.size(); ++type) {
      RootSphere sphere;
      sphere.radius_m = reach_m_[type];
      std::vector<PartShape> parts = shapes_[type]->parts;
      for (size_t part = 0; part < parts.size() && !volumes_.named.empty(); ++part)
        parts[part].volume = volumes_.of(shapes_[type]->part_names[part]);
      types.push_back(
          std::make_shared<BodyType>(std::move(parts), sphere, shapes_[type]->is_static));
    }
    types_ = types;
    culler_ = std::make_unique<Culler>(std::move(types), options_, workers_);
  }
  void store_events() {
    latest_ = events_.size();
    for (const PairEvent& event : culler_->events()) events_.push_back(event_row(frame_, event));
  }

  std::vector<std::shared_ptr<const BodyShape>> shapes_;
  PartVolumes volumes_;
  CullerOptions options_;
  Workers workers_;
  PosedParts parts_, next_parts_;  // of the latest step, and of the next one while it is checked
  Bodies bodies_;
  std::vector<float> reach_m_;
  std::vector<std::shared_ptr<const BodyType>> types_;
  std::unique_ptr<Culler> culler_;
  std::vector<EventRow> events_;
  size_t latest_ = 0;
  int64_t frame_ = 0;
};

template <typename T>
using Numbers = py::array_t<T, py::array::c_style | py::array::forcecast>;

void require_bodies(const PosedCuller& culler, const Numbers<int64_t>& ids,
                    const Numbers<int64_t>& types, const DoubleArray& scales) {
  if (ids.size() != types.size() || ids.size() != scales.size())
    throw InputError("ids, types, scales", "one of each per body",
                     fmt::format("{}, {} and {}", ids.size(), types.size(), scales.size()));
  for (py::ssize_t i = 0; i < ids.size(); ++i) {
    const int64_t id = ids.data()[i], type = types.data()[i];
    if (id < 0 || id > PairKey::kMaxId || (i > 0 && id <= ids.data()[i - 1]))
      throw InputError(fmt::format("ids[{}]", i),
                       fmt::format("ascending numbers up to {}", PairKey::kMaxId),
                       fmt::format("{}", id));
    if (type < 0 || type >= static_cast<int64_t>(culler.shapes().size()))
      throw InputError(fmt::format("types[{}]", i),
                       fmt::format("0 to {}", culler.shapes().size() - 1), fmt::format("{}", type));
    // The same check as in the culler, made before its bodies are posed.
    if (!(scales.data()[i] >= 1 / kMaxDescribed && scales.data()[i] <= kMaxDescribed))
      throw InputError(fmt::format("scales[{}]", i),
                       fmt::format("a number from {:g} to {:g}", 1 / kMaxDescribed, kMaxDescribed),
                       fmt::format("{:g}", scales.data()[i]));
  }
}

std::vector<EventRow> latest_events(const PosedCuller& culler) {
  const auto from = culler.events().begin() + static_cast<std::ptrdiff_t>(culler.latest());
  return {from, culler.events().end()};
}

using CullerPtr = std::shared_ptr<PosedCuller>;

/// A step of so few bodies takes about as long as the last one, in any pose.
constexpr size_t kFewBodies = 100;
constexpr double kShort_s = 1e-3;

/// Marks the culler as busy while the interpreter's lock is released.
class BusyGuard {
 public:
  explicit BusyGuard(CullerPtr culler) : culler_(std::move(culler)) {
    culler_->expect_idle();
    culler_->is_busy = true;
  }
  ~BusyGuard() { culler_->is_busy = false; }
  BusyGuard(const BusyGuard&) = delete;
  BusyGuard& operator=(const BusyGuard&) = delete;

  PosedCuller& culler() const { return *culler_; }

 private:
  CullerPtr culler_;
};

/// Data of a step, which may complete after the caller has stopped waiting.
struct StepWork {
  explicit StepWork(const CullerPtr& culler) : guard(culler) {}
  BusyGuard guard;
  std::vector<double> matrices;
  size_t stride = 0;
  PosedCuller::Bodies bodies;
};

py::array step(const CullerPtr& culler, const DoubleArray& matrices, const Numbers<int64_t>& ids,
               const Numbers<int64_t>& types, const DoubleArray& scales) {
  culler->expect_idle();
  require_bodies(*culler, ids, types, scales);
  const auto rows = matrices.ndim() == 3 ? matrices.shape(1) : 0;
  if (matrices.ndim() != 3 || (rows != 3 && rows != 4) || matrices.shape(2) != 4)
    throw InputError("poses", "matrices of 3 or 4 rows and 4 columns", "another shape");
  auto work = std::make_shared<StepWork>(culler);
  work->matrices.assign(matrices.data(), matrices.data() + matrices.size());
  work->stride = static_cast<size_t>(rows) * 4;
  work->bodies.ids.assign(ids.data(), ids.data() + ids.size());
  work->bodies.types.assign(types.data(), types.data() + types.size());
  work->bodies.scales.assign(scales.data(), scales.data() + scales.size());
  // Copied within the step, because the next one may begin directly after it.
  const auto events = std::make_shared<std::vector<EventRow>>();
  const bool is_short = work->bodies.ids.size() <= kFewBodies && culler->step_s < kShort_s;
  std::function<void(WorkState&)> stepping = [shared = std::move(work), events](WorkState&) {
    PosedCuller& posed = shared->guard.culler();
    const auto start = std::chrono::steady_clock::now();
    posed.step(shared->matrices, shared->stride, std::move(shared->bodies));
    posed.step_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    *events = latest_events(posed);
  };
  if (is_short)
    run_inline(stepping);
  else
    run_in_thread(std::move(stepping), py::none(), AbandonPolicy::kJoinBriefly);
  return array_over(events);
}

CullerPtr new_culler(std::vector<ShapePtr> shapes, py::dict options_dict) {
  if (shapes.empty()) throw InputError("bodies", "at least one kind of body", "none");
  const auto taken = [&options_dict](const char* name) {
    return options_dict.attr("pop")(name).cast<double>();
  };
  const double closest_margin_m = taken("closest_parts");
  const double step_s = taken("step_s");
  const double max_m = static_cast<double>(kMaxProximity_m);
  require_number("closest_parts", closest_margin_m, 0, max_m, false,
                 fmt::format("metres from 0 to {}", max_m));
  require_number("step_s", step_s, 0, 1e6, true, "a number of seconds above 0");
  const RunRequest request = request_of(options_dict);
  const PartVolumes volumes = request.options.part_volume.value_or(PartVolumes());
  std::vector<std::string> part_names;
  for (const ShapePtr& shape : shapes)
    part_names.insert(part_names.end(), shape->part_names.begin(), shape->part_names.end());
  require_parts(volumes, std::move(part_names));
  CullerOptions options = request.simulation.culler;
  options.proximity = {static_cast<float>(request.options.proximity_m.value_or(0)),
                       static_cast<float>(closest_margin_m), step_s,
                       request.options.contact_points};
  options.part_volume = volumes.fallback;
  options.exact = request.options.exact;
  options.check_spheres = false;  // PosedCuller sets the spheres to the reach of the poses
  const int threads = request.simulation.threads;
  return result_from_thread<CullerPtr>([shapes = std::move(shapes), volumes, options, threads] {
    return std::make_shared<PosedCuller>(shapes, volumes, options, threads);
  });
}

/// Wraps a function that requires an idle culler.
template <typename Function>
auto idle(const Function& function) {
  return [function](const PosedCuller& culler) {
    culler.expect_idle();
    return function(culler);
  };
}

}  // namespace

void bind_culler(py::module_& module) {
  py::class_<BodyShape, ShapePtr>(module, "Body")
      .def_readonly("part_names", &BodyShape::part_names)
      .def_property_readonly("part_count",
                             [](const BodyShape& shape) { return shape.parts.size(); });
  module.def("body_of_model", shape_of_model);
  module.def("body_of_parts", shape_of_parts);
  py::class_<PosedCuller, CullerPtr>(module, "Culler")
      .def(py::init(&new_culler), py::arg("bodies"), py::arg("options"))
      .def("contact_points", idle([](const PosedCuller& culler) {
             return array_of(
                 contact_point_rows(culler.frame() - 1, culler.culler().contact_points()));
           }))
      .def("proximity", idle([](const PosedCuller& culler) {
             return array_of(proximity_rows(culler.frame() - 1, culler.culler().proximity_pairs()));
           }))
      .def("closest_parts", idle([](const PosedCuller& culler) {
             return array_of(proximity_rows(culler.frame() - 1, culler.culler().closest_parts()));
           }))
      .def(
          "distance",
          [](const PosedCuller& culler, uint32_t a, const PartChoice& part_a, uint32_t b,
             const PartChoice& part_b) {
            culler.expect_idle();
            return tuple_of(culler.distance(a, part_a, b, part_b));
          },
          py::arg("a"), py::arg("part_a"), py::arg("b"), py::arg("part_b"))
      .def("step", step)
      .def("finish",
           [](const CullerPtr& culler) {
             const BusyGuard guard(culler);
             culler->finish();
             return array_of(latest_events(*culler));
           })
      .def("pairs", idle([](const PosedCuller& culler) {
             std::vector<PairRow> rows;
             for (const PairKey& pair : culler.culler().pairs())
               rows.push_back({pair.a(), pair.b(), static_cast<uint8_t>(pair.part_a()),
                               static_cast<uint8_t>(pair.part_b())});
             return array_of(std::move(rows));
           }))
      .def("events", idle([](const PosedCuller& culler) { return array_of(culler.events()); }))
      .def("contacts",
           [](const PosedCuller& culler, double step_s) {
             culler.expect_idle();
             return array_of(contacts_of(culler.events(), step_s, culler.frame()));
           })
      .def_property_readonly("frame",
                             idle([](const PosedCuller& culler) { return culler.frame(); }))
      .def_property_readonly("hash", idle([](const PosedCuller& culler) {
                               return hash_text(culler.culler().hash());
                             }));
}

}  // namespace throng
