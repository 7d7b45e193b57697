// throng.Simulation and its frames.
#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <memory>
#include <numeric>

#include "base/errors.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/interrupts.h"
#include "python/recorder.h"
#include "python/stepped_run.h"
#include "scenes/run/crowd_change.h"
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
      for (size_t i = 0; i < f.present.size(); ++i)
        if (f.present[i] == 0) out[i] = 0;
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
Eigen::Quaternionf rotation_of(const double* xyzw) {
  Eigen::Quaterniond q(Eigen::Map<const Eigen::Vector4d>{xyzw});
  const double max_component = q.coeffs().cwiseAbs().maxCoeff();
  if (max_component < 1e-6)
    throw InputError("rotations_xyzw", "a quaternion that is not zero",
                     fmt::format("({:g}, {:g}, {:g}, {:g})", q.x(), q.y(), q.z(), q.w()));
  constexpr double kFitsFloat = 1e30;
  if (max_component > kFitsFloat) q.coeffs() /= max_component;
  return q.cast<float>();
}

/// Rows of set_pose(); an array without elements means that the values are not given.
struct PoseArrays {
  Numbers ids;
  DoubleArray positions_m;      ///< N x 2 or N x 3
  DoubleArray rotations_xyzw;   ///< N x 4
  DoubleArray joint_positions;  ///< one avatar after another
  DoubleArray velocities_mps;   ///< N x 2

  size_t count() const { return static_cast<size_t>(ids.size()); }
  bool has_height() const { return static_cast<size_t>(positions_m.size()) == 3 * count(); }
};

Eigen::Vector2d row_of(const DoubleArray& values, size_t row, size_t width) {
  return {values.data()[row * width], values.data()[row * width + 1]};
}

const Model& model_of(const Simulation& simulation, uint32_t avatar) {
  return *simulation.info().models[simulation.info().model_of_avatar[avatar]];
}

std::vector<uint32_t> agent_ids(const Numbers& ids) {
  std::vector<uint32_t> out;
  for (py::ssize_t i = 0; i < ids.size(); ++i) {
    const int64_t id = ids.data()[i];
    if (id < 0 || id > UINT32_MAX)
      throw InputError(fmt::format("ids[{}]", i), "the id of an agent", fmt::format("{}", id));
    out.push_back(static_cast<uint32_t>(id));
  }
  return out;
}

/// Throws InputError unless all are externally controlled and in the scene.
void require_external(const Simulation& simulation, std::span<const uint32_t> ids) {
  for (size_t i = 0; i < ids.size(); ++i) {
    if (simulation.external_pose(ids[i]) == nullptr)
      throw InputError(fmt::format("ids[{}]", i), "an externally controlled avatar",
                       fmt::format("avatar {}", ids[i]));
    if (!simulation.is_present(ids[i]))
      throw InputError(fmt::format("ids[{}]", i), "an avatar that is in the scene",
                       fmt::format("avatar {}, which is not", ids[i]));
  }
}

void check_poses(const Simulation& simulation, const PoseArrays& poses,
                 std::span<const uint32_t> ids, bool gait) {
  size_t joints = 0;
  for (size_t i = 0; i < ids.size(); ++i) {
    joints += static_cast<size_t>(model_of(simulation, ids[i]).kinematics.column_count());
    if (!poses.has_height() && !(gait && simulation.can_walk(ids[i])))
      throw InputError(fmt::format("positions_m[{}]", i),
                       "3 numbers x, y, z for an avatar that does not walk by its gait", "2");
  }
  if (poses.joint_positions.size() != 0 &&
      static_cast<size_t>(poses.joint_positions.size()) != joints)
    throw InputError("joint_positions", fmt::format("none, or {} in all", joints),
                     fmt::format("{}", poses.joint_positions.size()));
  require_finite("positions_m", poses.positions_m);
  require_finite("rotations_xyzw", poses.rotations_xyzw);
  require_finite("joint_positions", poses.joint_positions);
  require_finite("velocities_mps", poses.velocities_mps);
}

int set_pose(SteppedRun& run, const Numbers& ids_in, const DoubleArray& positions_m,
             const DoubleArray& rotations_xyzw, const DoubleArray& joint_positions,
             const DoubleArray& velocities_mps, bool gait) {
  const PoseArrays poses{ids_in, positions_m, rotations_xyzw, joint_positions, velocities_mps};
  Simulation& simulation = run.simulation();
  const std::vector<uint32_t> ids = agent_ids(ids_in);
  require_external(simulation, ids);
  gait = gait && joint_positions.size() == 0;
  check_poses(simulation, poses, ids, gait);
  std::vector<Eigen::Quaternionf> rotations;
  for (size_t i = 0; i < ids.size() && rotations_xyzw.size() > 0; ++i)
    rotations.push_back(rotation_of(rotations_xyzw.data() + 4 * i));
  int clamped = 0;
  const double* joints = joint_positions.data();
  const size_t width = poses.has_height() ? 3 : 2;
  for (size_t i = 0; i < ids.size(); ++i) {
    const Eigen::Vector2d place_m = row_of(positions_m, i, width);
    std::optional<Eigen::Vector2d> velocity_mps, heading;
    if (velocities_mps.size() > 0) velocity_mps = row_of(velocities_mps, i, 2);
    if (gait && simulation.can_walk(ids[i])) {
      if (!rotations.empty())
        heading = (rotations[i].cast<double>().normalized() * Eigen::Vector3d::UnitX())
                      .head<2>()
                      .normalized();
      clamped += simulation.walk_to(ids[i], place_m, heading, velocity_mps);
      continue;
    }
    ExternalPose pose;
    pose.root.position_m << place_m, positions_m.data()[i * width + 2];
    pose.root.world_from_root = rotations.empty() ? Eigen::Quaternionf::Identity() : rotations[i];
    pose.velocity_mps = velocity_mps.value_or(Eigen::Vector2d::Zero());
    if (joint_positions.size() > 0) {
      const auto columns =
          static_cast<size_t>(model_of(simulation, ids[i]).kinematics.column_count());
      pose.joints = {joints, columns};
      joints += columns;
    }
    clamped += simulation.set_pose(ids[i], pose);
  }
  return clamped;
}

/// Throws RuntimeError after the end of the run.
Simulation& changeable(SteppedRun& run) {
  if (run.is_over())
    throw std::runtime_error("this simulation is finished; its people cannot be changed");
  return run.simulation();
}

/// `headings_rad` has no elements if they are not given.
py::array add(SteppedRun& run, const std::string& group, const DoubleArray& positions_m,
              const DoubleArray& headings_rad, const DoubleArray& speeds_mps) {
  std::vector<AgentEntry> entries(static_cast<size_t>(positions_m.size()) / 2);
  require_finite("headings_rad", headings_rad);
  for (size_t i = 0; i < entries.size(); ++i) {
    entries[i].position_m = row_of(positions_m, i, 2);
    entries[i].speed_mps = speeds_mps.data()[i];
    if (headings_rad.size() > 0) entries[i].heading_rad = headings_rad.data()[i];
  }
  const uint32_t first = changeable(run).add(group, entries);
  std::vector<int64_t> ids(entries.size());
  std::iota(ids.begin(), ids.end(), int64_t{first});
  return array_of(std::move(ids));
}

void remove(SteppedRun& run, const Numbers& ids) { changeable(run).remove(agent_ids(ids)); }

void set_goal(SteppedRun& run, const Numbers& ids, const std::string& goal) {
  changeable(run).set_goal(agent_ids(ids), goal);
}

void set_desired_speed(SteppedRun& run, const Numbers& ids, const DoubleArray& mps) {
  changeable(run).set_desired_speed(agent_ids(ids), {mps.data(), static_cast<size_t>(mps.size())});
}

/// Number of people without a path to their goal.
int stranded(SteppedRun& run) {
  int people = 0;
  for (const Stranding& stranding : run.simulation().strandings()) people += stranding.people;
  return people;
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
      .def("add", add)
      .def("remove", remove)
      .def("set_goal", set_goal)
      .def("set_desired_speed", set_desired_speed)
      .def_property_readonly("facts",
                             [](const SteppedRun& run) { return dict_of(facts_of(run.info())); })
      .def_property_readonly("frames", &SteppedRun::frames)
      .def_property_readonly("next_frame", &SteppedRun::next_frame)
      .def_property_readonly("notes", &SteppedRun::notes)
      .def_property_readonly("stranded", stranded)
      .def_property_readonly("writes_files", &SteppedRun::writes_files)
      .def_property_readonly("step_ms", &SteppedRun::step_ms)
      .def_property_readonly("joint_offsets", joint_offsets)
      .def_property_readonly("hash", [](const SteppedRun& run) { return hash_text(run.hash()); });
}

}  // namespace throng
