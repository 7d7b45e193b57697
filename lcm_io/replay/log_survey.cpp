#include "lcm_io/replay/log_survey.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/errors.h"
#include "base/limits.h"
#include "lcm_io/log/log_check.h"
#include "lcm_io/replay/log_states.h"

namespace throng {
namespace {

/// Longer intervals between states are rejected; culling of such logs is untested.
constexpr double kMaxStep_s = 3600;
constexpr double kMinStep_s = 1e-6;
/// Longest supported duration of a run.
constexpr double kMaxDuration_s = 1e7;
/// The largest ground plus the reach of a body.
constexpr double kMaxDistance_m = kMaxCoordinate_m + kMaxReach_m;

class Intervals {
 public:
  void add(int64_t frames, bool is_hole) {
    if (is_hole) {
      ++holes_[frames];
      return;
    }
    frames_ += frames;
    ++count_;
  }
  /// Mean over intervals without missing states, if there are any.
  double mean() const {
    if (count_ > 0) return static_cast<double>(frames_) / static_cast<double>(count_);
    return holes_.empty() ? 1 : static_cast<double>(holes_.begin()->first);
  }
  int64_t steps() const {
    int64_t sum = count_;
    for (const auto& [frames, times] : holes_) sum += times * steps_between(frames, true, mean());
    return sum;
  }

 private:
  int64_t frames_ = 0, count_ = 0;
  std::map<int64_t, int64_t> holes_;  ///< number of gaps by length; at most kMaxBridgedGap_s long
};

class Surveyor {
 public:
  explicit Surveyor(const std::filesystem::path& file) : report_(check_log(file)) {
    survey_.file = file;
    survey_.damage = report_.damage;
  }

  LogSurvey run() {
    LogStates states(survey_.file, survey_.damage);
    while (states.next() && continues(states)) take(states);
    if (survey_.states == 0) reject(states);
    survey_.description = *states.run().run();
    survey_.hash = states.hash();
    measure();
    note(states);
    return std::move(survey_);
  }

 private:
  [[noreturn]] void reject(LogStates& states) const {
    const run_description_t* run = states.run().run();
    throw InputError(survey_.file.string(),
                     run == nullptr ? "a log with a run's description" : "a log with states",
                     !states.rejection().empty()                ? states.rejection()
                     : run != nullptr && run->avatar_count == 0 ? "a run without avatars"
                                                                : "none");
  }

  bool continues(LogStates& states) {
    const double hole_s = static_cast<double>(states.frames_since()) * states.run().run()->step_s;
    if (!states.is_behind_gap() || hole_s <= kMaxBridgedGap_s) return true;
    end_ = fmt::format("no states for {:.3g} s after frame {}: culled up to that frame", hole_s,
                       survey_.last_frame);
    return false;
  }

  void take(LogStates& states) {
    const CrowdState& crowd = states.state();
    if (survey_.states++ == 0)
      survey_.first_frame = crowd.frame;
    else
      intervals_.add(states.frames_since(), states.is_behind_gap());
    if (states.is_behind_gap()) note_gap(states);
    survey_.last_frame = crowd.frame;
    const auto present = [](uint8_t is_present) { return is_present != 0; };
    survey_.is_open =
        survey_.is_open || !std::all_of(crowd.present.begin(), crowd.present.end(), present);
    for (size_t i = 0; i < crowd.roots.size(); ++i) add_avatar(crowd, i);
    widen_spans(*states.run().run(), crowd);
  }

  void add_avatar(const CrowdState& crowd, size_t avatar) {
    const double max_distance_m = crowd.roots[avatar].position_m.cwiseAbs().maxCoeff();
    if (!(max_distance_m <= kMaxDistance_m))
      throw InputError(
          survey_.file.string(),
          fmt::format("all avatars within {:g} km of the origin", kMaxDistance_m / 1000),
          fmt::format("avatar {} at {:g} m in frame {}", avatar, max_distance_m, crowd.frame));
    if (std::isfinite(crowd.speeds_mps[avatar])) return;
    if (no_speeds_.count++ == 0)
      no_speeds_.first = fmt::format("avatar {} at frame {}", avatar, crowd.frame);
  }

  void widen_spans(const run_description_t& run, const CrowdState& crowd) {
    if (survey_.spans.empty())
      for (const model_t& model : run.models)
        survey_.spans.emplace_back(static_cast<size_t>(model.column_count));
    const float* value = crowd.postures.data();
    for (const int16_t model : run.model_of_avatar)
      for (ColumnSpan& span : survey_.spans[static_cast<size_t>(model)]) {
        span.low = std::min(span.low, *value);
        span.high = std::max(span.high, *value++);
      }
  }

  void note_gap(const LogStates& states) {
    if (holes_.first.empty())
      holes_.first = fmt::format("after frame {}", states.state().frame - states.frames_since());
  }

  void measure() {
    survey_.every = intervals_.mean();
    survey_.steps = 1 + intervals_.steps();
    survey_.step_s = survey_.every * survey_.description.step_s;
    if (!(survey_.step_s >= kMinStep_s && survey_.step_s <= kMaxStep_s))
      throw InputError(survey_.file.string(),
                       fmt::format("states {:g} to {:g} s apart", kMinStep_s, kMaxStep_s),
                       fmt::format("{:g} s", survey_.step_s));
    if (const double length_s = static_cast<double>(survey_.steps) * survey_.step_s;
        !(length_s <= kMaxDuration_s))
      throw InputError(survey_.file.string(),
                       fmt::format("a run of at most {:g} s", kMaxDuration_s),
                       fmt::format("{:g} s", length_s));
  }

  void note(const LogStates& states) {
    if (survey_.every > 1)
      add_note(fmt::format("its states are {:.4g} frames apart: culled at these, {:.4g} per second",
                           survey_.every, 1 / survey_.step_s));
    if (survey_.first_frame > 0)
      add_note(
          fmt::format("its first states are those of frame {}, at {:.6g} s: they become "
                      "frame 0",
                      survey_.first_frame,
                      static_cast<double>(survey_.first_frame) * survey_.description.step_s));
    if (states.has_other_runs()) add_note("it contains several runs: the first is culled");
    if (report_.torn) add_note("it ends inside a message: culled up to there");
    if (report_.damaged || !report_.damage.empty())
      add_note("it is damaged, see `throng check`: the sound part is culled");
    holes_.what = "frames without sound states: avatars keep their last poses";
    holes_.count = survey_.steps - survey_.states;
    if (holes_.count > 0) add_note(fmt::format("{} {}", holes_.count, holes_.what));
    if (!end_.empty()) add_note(end_);
    no_speeds_.what = "speeds that are not numbers: replaced by 0";
    if (no_speeds_.count > 0) add_note(fmt::format("{} {}", no_speeds_.count, no_speeds_.what));
    for (const Anomaly* anomaly : {&holes_, &no_speeds_})
      if (anomaly->count > 0) survey_.anomalies.push_back(*anomaly);
  }

  void add_note(const std::string& text) {
    survey_.notes.push_back(fmt::format("{}: {}", survey_.file.string(), text));
  }

  LogReport report_;
  LogSurvey survey_;
  Intervals intervals_;
  Anomaly holes_, no_speeds_;
  std::string end_;
};

}  // namespace

int64_t steps_between(int64_t frames, bool is_hole, double every) {
  if (!is_hole) return 1;
  return std::max<int64_t>(1, std::llround(static_cast<double>(frames) / every));
}

LogSurvey survey_log(const std::filesystem::path& file) { return Surveyor(file).run(); }

}  // namespace throng
