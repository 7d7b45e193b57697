#include "python/facts_dict.h"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include "python/arrays.h"

namespace py = pybind11;

namespace throng {

std::string hash_text(uint64_t hash) { return fmt::format("{:016x}", hash); }

py::dict dict_of(RunFacts facts) {
  py::dict out;
  out["scene"] = facts.scene;
  out["seed"] = facts.seed;
  out["run_id"] = hash_text(facts.run_id);
  out["step_s"] = facts.step_s;
  out["groups"] = facts.groups;
  out["models"] = facts.models;
  out["part_names"] = facts.part_names;
  out["obstacles"] = facts.obstacles;
  out["people"] = array_of(std::move(facts.people));
  return out;
}

void add_rows(py::dict& out, RunRecorder& recorder, double step_s) {
  const auto events = std::make_shared<std::vector<EventRow>>(std::move(recorder.events));
  const int64_t end = recorder.end_frame;
  out["events"] = array_over(events);
  out["find_contacts"] = py::cpp_function([events, step_s, end] {
    std::vector<ContactRow> contacts;
    {
      const py::gil_scoped_release others;
      contacts = contacts_of(*events, step_s, end);
    }
    return array_of(std::move(contacts));
  });
  out["trajectories"] = array_of(std::move(recorder.places));
  out["counters"] = array_of(std::move(recorder.frames));
}

}  // namespace throng
