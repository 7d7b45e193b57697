// throng.Simulation and its frames.
#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <memory>

#include "base/errors.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/interrupts.h"
#include "python/recorder.h"
#include "python/stepped_run.h"
#include "scenes/run/sink.h"

namespace py = pybind11;

namespace throng {
namespace {

using Numbers = py::array_t<int64_t, py::array::c_style | py::array::forcecast>;

/// One frame of a run, valid while it is the latest.
struct FrameView {
  std::shared_ptr<SteppedRun> run;
  int64_t number = 0;

  const Frame& frame() const { return run->frame(number); }

  py::array positions() const {
    const Frame& f = frame();
    return run->positions.array(number, 3, [&](std::vector<double>& out) {
      out.resize(3 * f.roots.size());
      double* to = out.data();
      for (const RootPose& root : f.roots) to = std::copy_n(root.position_m.data(), 3, to);
    });
  }
  py::array rotations() const {
    const Frame& f = frame();
    return run->rotations.array(number, 4, [&](std::vector<float>& out) {
      out.resize(4 * f.roots.size());
      float* to = out.data();
      for (const RootPose& root : f.roots)
        to = std::copy_n(root.world_from_root.coeffs().data(), 4, to);
    });
  }
  py::array headings() const {
    const Frame& f = frame();
    return run->headings.array(number, 0, [&](std::vector<float>& out) {
      out.clear();
      for (const RootPose& root : f.roots) out.push_back(heading_of(root));
    });
  }
  py::array speeds() const {
    const Frame& f = frame();
    return run->speeds.array(number, 0, [&](std::vector<float>& out) {
      out.assign(f.speeds_mps.begin(), f.speeds_mps.end());
    });
  }
  py::array present() const {
    const Frame& f = frame();
    py::array bytes = run->present.array(number, 0, [&](std::vector<uint8_t>& out) {
      out.assign(f.roots.size(), 1);
      for (size_t i = 0; i < f.present.size(); ++i) out[i] = f.present[i] != 0;
    });
    return bytes.attr("view")("bool");
  }
  py::array joint_positions() const {
    const Frame& f = frame();
    if (!run->has_postures())
      throw std::runtime_error("this simulation was made with joint_positions=False; it has none");
    return run->postures.array(number, 0, [&](std::vector<float>& out) {
      out.assign(f.postures.begin(), f.postures.end());
    });
  }
  py::array pairs() const {
    const Frame& f = frame();
    return run->pairs.array(number, 0, [&](std::vector<PairRow>& out) {
      out.clear();
      for (const PairKey& pair : f.pairs)
        out.push_back({pair.a(), pair.b(), static_cast<uint8_t>(pair.part_a()),
                       static_cast<uint8_t>(pair.part_b())});
    });
  }
  py::array events() const {
    const Frame& f = frame();
    return run->events.array(number, 0, [&](std::vector<EventRow>& out) {
      out.clear();
      for (const PairEvent& event : f.events) out.push_back(event_row(number, event));
    });
  }
  py::array proximity() const {
    const Frame& f = frame();
    require(run->scene().proximity_m > 0, "without proximity=M, and its scene has no proximity_m");
    return array_of(proximity_rows(number, f.proximity_pairs));
  }
  py::array contact_points() const {
    const Frame& f = frame();
    require(run->scene().contact_points,
            "without contact_points=True, and its scene has no contact_points");
    return array_of(contact_point_rows(number, f.contact_points));
  }
  py::array closest_parts() const {
    const Frame& f = frame();
    require(run->scene().closest_parts_m > 0,
            "without closest_parts=M, and its scene has no closest_parts_m");
    return array_of(proximity_rows(number, f.closest_parts));
  }
  py::array part_poses(const Numbers& people) const;
  py::tuple distance(uint32_t a, const PartChoice& part_a, uint32_t b,
                     const PartChoice& part_b) const {
    frame();
    return tuple_of(run->distance(a, part_a, b, part_b));
  }

  /// Throws if a table was not requested; an empty one would mean that no pair was found.
  static void require(bool is_there, const char* what) {
    if (!is_there)
      throw std::runtime_error(fmt::format("this simulation was made {}: there is no table", what));
  }
};

/// Offsets of the joint positions of each avatar.
py::array joint_offsets(const SteppedRun& run) {
  const RunInfo& info = run.info();
  std::vector<int64_t> offsets{0};
  for (const uint16_t model : info.model_of_avatar)
    offsets.push_back(offsets.back() + info.models[model]->kinematics.column_count());
  return array_of(std::move(offsets));
}

py::array FrameView::part_poses(const Numbers& people) const {
  const Frame& f = frame();
  if (!run->has_postures())
    throw std::runtime_error(
        "this simulation was made with joint_positions=False; part poses need them");
  const RunInfo& info = run->info();
  const auto known = static_cast<int64_t>(info.model_of_avatar.size());
  std::vector<uint32_t> ids;
  size_t parts = 0;
  for (py::ssize_t i = 0; i < people.size(); ++i) {
    const int64_t id = people.data()[i];
    if (id < 0 || id >= known)
      throw InputError(fmt::format("people[{}]", i), fmt::format("an id from 0 to {}", known - 1),
                       fmt::format("{}", id));
    const Model& model = *info.models[info.model_of_avatar[static_cast<size_t>(id)]];
    const auto count = static_cast<size_t>(model.part_count());
    if (i > 0 && count != parts)
      throw InputError(fmt::format("people[{}]", i), "people of one model", "another one");
    parts = count;
    ids.push_back(static_cast<uint32_t>(id));
  }
  std::vector<double> out(ids.size() * parts * 16);
  std::vector<PartPose> poses(parts);
  for (size_t i = 0; i < ids.size(); ++i) {
    throng::part_poses(info, f, ids[i], poses);
    for (size_t part = 0; part < parts; ++part)
      put_matrix(poses[part], f.roots[ids[i]].position_m, &out[(i * parts + part) * 16]);
  }
  const auto n = static_cast<py::ssize_t>(ids.size());
  return array_of(std::move(out), {n, static_cast<py::ssize_t>(parts), 4, 4});
}

std::shared_ptr<SteppedRun> opened(const py::dict& options) {
  return result_from_thread<std::shared_ptr<SteppedRun>>(
      [request = request_of(options)] { return std::make_shared<SteppedRun>(request); });
}

void require_finite(const char* name, const DoubleArray& values) {
  for (py::ssize_t i = 0; i < values.size(); ++i)
    if (!std::isfinite(values.data()[i]))
      throw InputError(name, "finite numbers", fmt::format("{}", values.data()[i]));
}

/// Not normalised if float can hold it, so that a pose of a frame can be set again bit for bit.
Eigen::Quaternionf rotation_of(const DoubleArray& xyzw) {
  Eigen::Quaterniond q(Eigen::Map<const Eigen::Vector4d>(xyzw.data()));
  const double max_component = q.coeffs().cwiseAbs().maxCoeff();
  if (max_component < 1e-6)
    throw InputError("rotation_xyzw", "a quaternion that is not zero",
                     fmt::format("({:g}, {:g}, {:g}, {:g})", q.x(), q.y(), q.z(), q.w()));
  constexpr double kFitsFloat = 1e30;
  if (max_component > kFitsFloat) q.coeffs() /= max_component;
  return q.cast<float>();
}

int set_pose(SteppedRun& run, uint32_t avatar, const DoubleArray& position_m,
             const DoubleArray& rotation_xyzw, const DoubleArray& joint_positions,
             const DoubleArray& velocity_mps) {
  if (position_m.size() != 3 || rotation_xyzw.size() != 4 || velocity_mps.size() != 2)
    throw InputError(
        "set_pose", "a position of 3, a rotation of 4 and a velocity of 2 numbers",
        fmt::format("{}, {} and {}", position_m.size(), rotation_xyzw.size(), velocity_mps.size()));
  if (!run.is_external(avatar))
    throw InputError("avatar", "an externally controlled avatar", fmt::format("avatar {}", avatar));
  const Model& model = *run.info().models[run.info().model_of_avatar[avatar]];
  if (joint_positions.size() != 0 && joint_positions.size() != model.kinematics.column_count())
    throw InputError(
        "joint_positions",
        fmt::format("none, or {} of '{}'", model.kinematics.column_count(), model.name),
        fmt::format("{}", joint_positions.size()));
  require_finite("position_m", position_m);
  require_finite("rotation_xyzw", rotation_xyzw);
  require_finite("joint_positions", joint_positions);
  require_finite("velocity_mps", velocity_mps);
  ExternalPose pose;
  pose.root.position_m = Eigen::Map<const Eigen::Vector3d>(position_m.data());
  pose.root.world_from_root = rotation_of(rotation_xyzw);
  pose.velocity_mps = Eigen::Map<const Eigen::Vector2d>(velocity_mps.data());
  pose.joints = {joint_positions.data(), static_cast<size_t>(joint_positions.size())};
  return run.set_pose(avatar, pose);
}

}  // namespace

void bind_simulation(py::module_& module) {
  py::class_<FrameView>(module, "Frame")
      .def_readonly("number", &FrameView::number)
      .def_property_readonly(
          "time_s",
          [](const FrameView& f) { return static_cast<double>(f.frame().utime_us) * 1e-6; })
      .def_property_readonly("positions_m", &FrameView::positions)
      .def_property_readonly("rotations_xyzw", &FrameView::rotations)
      .def_property_readonly("headings_rad", &FrameView::headings)
      .def_property_readonly("speeds_mps", &FrameView::speeds)
      .def_property_readonly("present", &FrameView::present)
      .def_property_readonly("joint_positions", &FrameView::joint_positions)
      .def_property_readonly("pairs", &FrameView::pairs)
      .def_property_readonly("events", &FrameView::events)
      .def_property_readonly("proximity", &FrameView::proximity)
      .def_property_readonly("closest_parts", &FrameView::closest_parts)
      .def_property_readonly("contact_points", &FrameView::contact_points)
      .def_property_readonly("hash", [](const FrameView& f) { return hash_text(f.frame().hash); })
      .def("part_poses", &FrameView::part_poses, py::arg("people"))
      .def("distance", &FrameView::distance, py::arg("a"), py::arg("part_a"), py::arg("b"),
           py::arg("part_b"));
  py::class_<SteppedRun, std::shared_ptr<SteppedRun>>(module, "Simulation")
      .def(py::init(&opened), py::arg("options"))
      .def("step",
           [](const std::shared_ptr<SteppedRun>& run) {
             const int64_t number = SteppedRun::step(run);
             return FrameView{run, number};
           })
      .def("finish",
           [](SteppedRun& run) {
             run.finish();
             return array_of(run.last_ends());
           })
      .def("save",
           [](SteppedRun& run) {
             const std::vector<uint8_t> state = run.saved();
             return py::bytes(reinterpret_cast<const char*>(state.data()), state.size());
           })
      .def("resume",
           [](SteppedRun& run, const py::bytes& state) {
             const std::string_view text(state);
             run.resume({reinterpret_cast<const uint8_t*>(text.data()), text.size()});
           })
      .def("set_pose", set_pose)
      .def_property_readonly("facts",
                             [](const SteppedRun& run) { return dict_of(facts_of(run.info())); })
      .def_property_readonly("frames", &SteppedRun::frames)
      .def_property_readonly("next_frame", &SteppedRun::next_frame)
      .def_property_readonly("notes", &SteppedRun::notes)
      .def_property_readonly("step_ms", &SteppedRun::step_ms)
      .def_property_readonly("joint_offsets", joint_offsets)
      .def_property_readonly("hash", [](const SteppedRun& run) { return hash_text(run.hash()); });
}

}  // namespace throng
