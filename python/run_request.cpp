#include "python/run_request.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <set>
#include <thread>

#include "analysis/trajectories/walkable_area.h"
#include "base/errors.h"
#include "base/option_checks.h"

namespace py = pybind11;

namespace throng {
namespace {

constexpr std::pair<const char*, PairSearch> kPairSearches[] = {
    {"grid", PairSearch::kGrid}, {"sweep", PairSearch::kSweep}, {"brute", PairSearch::kBrute}};

/// Takes values out of a dictionary, so that what is left is what nobody knows.
class Given {
 public:
  explicit Given(const py::dict& given) : given_(given) {}

  /// Throws TypeError for what is of another type, InputError for whole numbers of too many bits.
  template <typename T>
  std::optional<T> take(const char* name, const char* what) {
    known_.emplace_back(name);
    if (!given_.contains(name) || given_[name].is_none()) return {};
    const py::object value = given_[name];
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
  template <typename T>
  void whole(const char* name, int64_t low, int64_t high, std::optional<T>& out) {
    const std::string what = fmt::format("a whole number from {} to {}", low, high);
    const std::optional<int64_t> value = take<int64_t>(name, what.c_str());
    if (!value) return;
    if (*value < low || *value > high) throw InputError(name, what, fmt::format("{}", *value));
    out = static_cast<T>(*value);
  }
  std::string name(const char* name, const std::vector<std::string>& names) {
    std::string value;
    take(name, "a name", value);
    if (!value.empty() && std::find(names.begin(), names.end(), value) == names.end())
      throw InputError(name, fmt::format("one of {}", fmt::join(names, ", ")),
                       fmt::format("'{}'{}", value, did_you_mean(value, names)));
    return value;
  }

  /// Throws TypeError where something is left, as a function of Python does.
  void expect_all_known() const {
    for (const auto& [key, value] : given_) {
      const auto name = key.cast<std::string>();
      if (std::find(known_.begin(), known_.end(), name) == known_.end())
        throw py::type_error(
            fmt::format("unexpected option '{}'{}", name, did_you_mean(name, known_)));
    }
  }

 private:
  /// Python writes no number of more than 4300 digits.
  static std::string written(const py::int_& number) {
    constexpr size_t kMostBits = 256;
    const auto bits = number.attr("bit_length")().cast<size_t>();
    return bits > kMostBits ? fmt::format("one of {} bits", bits)
                            : py::str(py::handle(number)).cast<std::string>();
  }

  const py::dict& given_;
  std::vector<std::string> known_;
};

template <typename Kinds>
std::vector<std::string> names_of(const Kinds& kinds) {
  std::vector<std::string> names;
  for (const auto kind : kinds) names.emplace_back(name_of(kind));
  return names;
}

void take_source(Given& given, RunSourceOptions& source) {
  given.take("source", "a name or a path", source.name);
  given.whole("avatars", 1, PairKey::kMaxId, source.avatars);
  given.number("seconds", 0, 1e7, true, "a number of seconds above 0", source.seconds);
  given.whole("seed", 0, INT64_MAX, source.seed);
  source.steering = given.name("steering", steering_names());
  given.take("part_volume", "a volume, or 'hands: sphere, default: ordop26'", source.part_volume);
  if (!source.part_volume.empty()) part_volumes_of(source.part_volume, "part_volume");
  given.take("exact", "True or False", source.exact);
  given.take("contact_points", "True or False", source.contact_points);
  const double most_m = static_cast<double>(kMostNear_m);
  const std::string margin = fmt::format("metres from 0 to {}", kMostNear_m);
  given.take("between", "pairs of groups, as in 'robots: people'", source.between);
  if (!source.between.empty()) pair_rules_of(source.between, "between");
  given.take("parts", "words of parts, as in 'hands: head'", source.parts);
  if (!source.parts.empty()) part_rules_of(source.parts, "parts");
  given.number("near", 0, most_m, false, margin, source.near_m);
  given.number("person_near", 0, most_m, false, margin, source.person_near_m);
  RecordingFlags& flags = source.recording;
  given.number("fps", 0, 10'000, true, "a number of frames a second above 0", flags.fps);
  flags.unit = given.name("unit", unit_names());
  flags.heading_unit = given.name("heading_unit", heading_unit_names());
  given.take("columns", "a list id=NAME,t=NAME,x=NAME,y=NAME", flags.columns);
  given.take("separator", "one character, or tab, blank, comma, semicolon", flags.separator);
  flags.tracks = given.name("tracks", tracks_names());
  given.take("strict", "True or False", flags.strict);
  source.step = given.name("step", step_names());
}

void take_culling(Given& given, SimulationOptions& simulation) {
  std::optional<int64_t> threads;
  given.whole("threads", 1, 256, threads);
  simulation.threads = checked_threads(threads);
  CullerOptions& culler = simulation.culler;
  constexpr SimdTarget kTargets[] = {SimdTarget::kBest, SimdTarget::kScalar, SimdTarget::kSse4,
                                     SimdTarget::kAvx2, SimdTarget::kAvx512};
  const std::string simd = given.name("simd", names_of(kTargets));
  culler.simd = resolved(simd.empty() ? SimdTarget::kBest : simd_target_of(simd).value());
  given.number("deadline_ms", 0, 1e6, false, "a number of milliseconds from 0", culler.deadline_ms);
  given.whole("deadline_tests", 0, INT64_MAX, culler.deadline_tests);
  const std::string strategy = given.name("strategy", names_of(kAllStrategies));
  if (!strategy.empty()) simulation.strategy = strategy_of(strategy).value();
  const bool is_papers = simulation.strategy != Strategy::kPipeline;
  if (is_papers && culler.has_deadline())
    throw InputError("strategy", "'pipeline' beside a deadline", fmt::format("'{}'", strategy));
  if (is_papers) culler.pair_search = PairSearch::kBrute;
  std::vector<std::string> searches;
  for (const auto& [name, search] : kPairSearches) searches.emplace_back(name);
  const std::string chosen = given.name("pair_search", searches);
  for (const auto& [name, search] : kPairSearches)
    if (chosen == name) culler.pair_search = search;
  given.take("culling", "True or False", simulation.culling);
  given.take("postures", "True or False", simulation.postures);
}

}  // namespace

void require_number(const char* option, double value, double low, double high, bool open,
                    const std::string& what) {
  const std::string text = fmt::format("{}", value);
  if (!number_option(low, high, open, what)(text).empty()) throw InputError(option, what, text);
}

int usual_threads() { return std::max(1, static_cast<int>(std::thread::hardware_concurrency())); }

int checked_threads(std::optional<int64_t> threads) {
  if (threads && (*threads < 1 || *threads > 256))
    throw InputError("threads", "a whole number from 1 to 256", fmt::format("{}", *threads));
  return threads ? static_cast<int>(*threads) : usual_threads();
}

RunRequest request_of(const py::dict& dict) {
  Given given(dict);
  RunRequest request;
  take_source(given, request.source);
  take_culling(given, request.simulation);
  given.number("trajectory_fps", 0, 1e4, true, "a number of frames a second above 0",
               request.trajectory_fps);
  given.take("trajectories", "True or False", request.trajectories);
  given.number("states_hz", 0, 1e6, true, "a number of states a second above 0", request.states_hz);
  given.take("publish_parts", "True or False", request.publish_parts);
  given.take("log", "a path", request.log);
  given.take("html", "a path", request.html);
  given.take("contacts", "a folder", request.contacts);
  given.take("separation", "a folder", request.separation);
  given.take("trace_hash", "a path", request.trace_hash);
  given.take("trajectory", "a list of paths", request.trajectory);
  std::string area;
  given.take("trajectory_area", "'largest' or a whole number from 1", area);
  request.trajectory_piece = trajectory_piece(area);
  if (!area.empty() && !request.trajectory_piece)
    throw InputError("trajectory_area", "'largest' or a whole number from 1",
                     fmt::format("'{}'", area));
  given.expect_all_known();
  return request;
}

}  // namespace throng
