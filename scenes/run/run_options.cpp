#include "scenes/run/run_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <utility>

#include "base/cores.h"
#include "base/errors.h"
#include "base/text.h"
#include "recordings/units.h"
#include "scenes/file/scene_fields.h"

namespace throng {
namespace {

constexpr int kMaxThreads = 256;

using Kind = RunOption::Kind;

RunOption row(std::string name, Kind kind, std::string value, std::string meaning) {
  RunOption option;
  option.name = std::move(name);
  option.value = std::move(value);
  option.meaning = std::move(meaning);
  option.kind = kind;
  return option;
}

/// Row whose values `check` accepts and `set` stores.
RunOption checked(RunOption option, OptionCheck check,
                  std::function<void(const std::string&, RunOptions&)> set) {
  option.read = [check = std::move(check), set = std::move(set), name = option.name,
                 expected = option.expected, words = option.words,
                 is_flag = option.kind == Kind::kFlag](
                    const std::string& text, std::string_view where, RunOptions& options) {
    if (!check(text).empty())
      throw InputError(where, expected, fmt::format("'{}'{}", text, did_you_mean(text, words)));
    set(text, options);
    if (!is_flag || text == "true") options.given.push_back({name, std::string(where)});
  };
  return option;
}

/// `member`: a member of RunOptions, or a function that returns a member of RecordingFlags.
template <typename Number, typename Member>
auto storing_number(Member member) {
  return [member](const std::string& text, RunOptions& options) {
    Number value{};
    std::from_chars(text.data(), text.data() + text.size(), value);
    std::invoke(member, options) = value;
  };
}

template <typename Member>
RunOption whole(const char* name, const char* value, const char* meaning, Member member,
                int64_t least, int64_t most) {
  using Number = typename std::decay_t<std::invoke_result_t<Member, RunOptions&>>::value_type;
  RunOption option = row(name, Kind::kWhole, value, meaning);
  option.expected = fmt::format("a whole number from {}", least);
  if (most < INT64_MAX) option.expected += fmt::format(" to {}", most);
  return checked(std::move(option), whole_option(least, most, ""), storing_number<Number>(member));
}

template <typename Member>
RunOption number(const char* name, const char* value, const char* meaning, Member member,
                 const Range& range, std::string expected) {
  RunOption option = row(name, Kind::kNumber, value, meaning);
  option.expected = std::move(expected);
  return checked(std::move(option), number_option(range.min, range.max, range.above_min, ""),
                 storing_number<double>(member));
}

template <typename Member>
RunOption metres(const char* name, const char* meaning, Member member) {
  return number(name, "M", meaning, member, {0, static_cast<double>(kMaxProximity_m)},
                fmt::format("metres from 0 to {}", kMaxProximity_m));
}

template <typename Member>
RunOption flag(const char* name, const char* meaning, Member member) {
  RunOption option = row(name, Kind::kFlag, "", meaning);
  option.expected = "true or false";
  return checked(std::move(option), name_option({"true", "false"}),
                 [member](const std::string& text, RunOptions& options) {
                   std::invoke(member, options) = text == "true";
                 });
}

template <typename Member, typename Named>
RunOption word(const char* name, const char* value, std::string meaning, Member member,
               std::vector<std::string> words, const Named& named) {
  RunOption option = row(name, Kind::kWord, value, std::move(meaning));
  option.expected = fmt::format("one of {}", fmt::join(words, ", "));
  option.words = words;
  return checked(std::move(option), name_option(std::move(words)),
                 [member, named](const std::string& text, RunOptions& options) {
                   std::invoke(member, options) = named(text).value();
                 });
}

template <typename Member>
RunOption word(const char* name, const char* value, std::string meaning, Member member,
               std::vector<std::string> words) {
  return word(name, value, std::move(meaning), member, std::move(words),
              [](const std::string& text) { return std::optional(text); });
}

/// Stores the result of `parse`, which throws InputError itself.
template <typename Member, typename Parse>
RunOption parsed(const char* name, const char* value, const char* meaning, Member member,
                 const char* expected, Parse parse) {
  RunOption option = row(name, Kind::kText, value, meaning);
  option.expected = expected;
  option.read = [member, parse, name](const std::string& text, std::string_view where,
                                      RunOptions& options) {
    std::invoke(member, options) = parse(text, where);
    options.given.push_back({name, std::string(where)});
  };
  return option;
}

RunOption of_study(RunOption option) {
  option.is_of_study = true;
  return option;
}

RunOption not_of_study(RunOption option, std::string study_has) {
  option.study_has = std::move(study_has);
  return option;
}

RunOption of_recording(RunOption option) {
  option.is_of_recording = true;
  return option;
}

template <typename Value>
auto flags(Value RecordingFlags::*member) {
  return [member](RunOptions& options) -> Value& { return options.recording.*member; };
}

char separator_named(const std::string& name) {
  constexpr std::pair<const char*, char> kSeparators[] = {
      {"tab", '\t'}, {"blank", ' '}, {"comma", ','}, {"semicolon", ';'}};
  for (const auto& [known, separator] : kSeparators)
    if (name == known) return separator;
  return name.size() == 1 ? name[0] : '\0';
}

std::string checked_separator(const std::string& text, std::string_view where) {
  if (separator_named(text) == '\0')
    throw InputError(where, "one character, or tab, blank, comma or semicolon",
                     fmt::format("'{}'", text));
  return text;
}

void add_source_rows(std::vector<RunOption>& rows) {
  using O = RunOptions;
  rows.push_back(
      of_study(whole("avatars", "N", "Total number of agents; scales all groups [the scene's]",
                     &O::avatars, 1, PairKey::kMaxId)));
  rows.push_back(of_study(number("seconds", "S", "Simulated time in seconds [the scene's]",
                                 &O::seconds, {0, 1e7, true}, "a number of seconds above 0")));
  rows.push_back(not_of_study(
      whole("seed", "N", "Seed of all random numbers [the scene's]", &O::seed, 0, INT64_MAX),
      "'seeds: [1, 2, 3]'"));
  rows.push_back(of_study(
      parsed("part_volume", "VOLUME",
             "Bounding volume of body parts (docs/culling.md) [the scene's], or by part: "
             "'hands: sphere, default: ordop26'",
             &O::part_volume, "a volume, or 'hands: sphere, default: ordop26'", part_volumes_of)));
  rows.push_back(
      of_study(word("steering", "MODEL", "Steering model [the scene's]: " + steering_choices(),
                    &O::steering, steering_names(), steering_kind_of)));
  rows.push_back(
      of_study(flag("exact", "Decide contacts and distances by triangle tests", &O::exact)));
  rows.push_back(metres("proximity", "Report pairs of parts within M metres, with distances",
                        &O::proximity_m));
  rows.push_back(metres("closest_parts",
                        "Report the closest parts of each two avatars within M metres",
                        &O::closest_parts_m));
  rows.push_back(flag("contact_points",
                      "Report point, normal and depth of each contact; requires --exact",
                      &O::contact_points));
  rows.push_back(
      parsed("filter_groups", "A:B",
             "Report only pairs of these groups, as in 'robots: people'; one name pairs with all",
             &O::group_filter, "pairs of groups, as in 'robots: people'", pair_rules_of));
  rows.push_back(
      parsed("filter_parts", "PARTS",
             "Report only pairs of these parts, as in 'hands: head'; one name pairs with all",
             &O::part_filter, "words of parts, as in 'hands: head'", part_rules_of));
}

void add_recording_rows(std::vector<RunOption>& rows) {
  using F = RecordingFlags;
  const auto add = [&rows](RunOption option) { rows.push_back(of_recording(std::move(option))); };
  add(number("fps", "N", "Frames per second of a recording, as its file numbers them [the file's]",
             flags(&F::fps), {0, 10'000, true}, "a number of frames per second above 0"));
  add(word("unit", "UNIT", "Unit of lengths in a recording [the file's]: m, cm, mm, km, ft or in",
           flags(&F::unit), unit_names_of(Quantity::kLength)));
  add(word("heading_unit", "UNIT", "Unit of headings in a recorded table [the file's]: rad or deg",
           flags(&F::heading_unit), unit_names_of(Quantity::kAngle)));
  add(parsed("columns", "LIST",
             "Columns of a recorded table, by name or number, as in id=1,t=2,x=3,y=4; also "
             "frame=, z=, heading=, active=",
             flags(&F::columns), "a list id=NAME,t=NAME,x=NAME,y=NAME",
             [](const std::string& text, std::string_view) { return text; }));
  add(parsed("separator", "CHARACTER",
             "Separator of these columns: one character, or tab, blank, comma or semicolon",
             flags(&F::separator), "one character, or tab, blank, comma or semicolon",
             checked_separator));
  add(word("tracked_point", "POINT",
           "Body point that a recording tracks [by kind of file]: head or centre",
           flags(&F::tracked_point), {"head", "centre"}));
  add(flag("strict", "Treat anomalies in the recording as errors", flags(&F::strict)));
  add(word("sampling", "KIND",
           "Frames of a recording: smooth (steps of at most 1/60 s) or recorded [smooth]",
           &RunOptions::step, {"smooth", "recorded"}));
}

void add_culling_rows(std::vector<RunOption>& rows) {
  using O = RunOptions;
  rows.push_back(not_of_study(
      whole("threads", "N", "Number of threads [all cores]", &O::threads, 1, kMaxThreads),
      "threads on the command line: throng study FILE --threads N"));
  rows.push_back(
      not_of_study(number("budget_ms", "D",
                          "Budget per frame for contact detection, in milliseconds [unlimited]",
                          &O::budget_ms, {0, 1e6}, "a number of milliseconds from 0"),
                   "a repeatable budget ('budget_tests'; wall-clock budgets are not repeatable)"));
  rows.push_back(
      of_study(whole("budget_tests", "N",
                     "Budget per frame for contact detection, in tests of boxes, part volumes and "
                     "triangles [unlimited]",
                     &O::budget_tests, 0, INT64_MAX)));
  const std::vector<std::string> strategies = strategy_names();
  const std::vector<std::string> papers(strategies.begin() + 1, strategies.end());
  rows.push_back(of_study(
      word("strategy", "NAME",
           "Strategy of the paper (docs/paper.md) instead of Throng's [pipeline], on one thread, "
           "without a budget: " +
               list_of(papers, " or "),
           &O::strategy, strategies, [](const std::string& name) { return strategy_of(name); })));
  rows.push_back(of_study(
      word("simd", "TARGET", "SIMD instruction set [best]: " + list_of(simd_target_names(), " or "),
           &O::simd, simd_target_names(), simd_target_of)));
  rows.push_back(
      of_study(word("pair_search", "NAME",
                    "Search for pairs of bodies [grid]: " + list_of(pair_search_names(), " or "),
                    &O::pair_search, pair_search_names(), pair_search_of)));
}

void add_message_rows(std::vector<RunOption>& rows) {
  using O = RunOptions;
  rows.push_back(not_of_study(
      number("states_hz", "N",
             "States (poses of all avatars) per simulated second, in log and LCM [every frame]",
             &O::states_hz, {0, 1e6, true}, "a number of states per second above 0"),
      kShapesNoResult));
  rows.push_back(not_of_study(
      flag("publish_part_poses", "Publish the pose of every part with these states, in log and LCM",
           &O::publish_part_poses),
      kShapesNoResult));
}

}  // namespace

bool RunOptions::is_given(std::string_view name) const {
  return std::any_of(given.begin(), given.end(), [&](const Given& g) { return g.name == name; });
}

std::string RunOptions::where(std::string_view name) const {
  for (const Given& each : given)
    if (each.name == name) return each.where;
  return argument_of(name);
}

std::string argument_of(std::string_view option) {
  std::string text = "--" + std::string(option);
  std::replace(text.begin(), text.end(), '_', '-');
  return text;
}

std::span<const std::string_view> output_option_names() {
  static constexpr std::string_view kNames[] = {"log",
                                                "lcm",
                                                "flush_s",
                                                "json",
                                                "html",
                                                "contacts",
                                                "trajectory",
                                                "trajectory_fps",
                                                "trajectory_area",
                                                "part_pairs",
                                                "resume",
                                                "checkpoint",
                                                "checkpoint_every",
                                                "trace_hash",
                                                "pace",
                                                "publish_for",
                                                "lockstep",
                                                "lockstep_timeout"};
  return kNames;
}

void require_no_recording_options(const RunOptions& options, std::string_view found) {
  for (const RunOption& option : run_options())
    if (option.is_of_recording && options.is_given(option.name))
      throw InputError(options.where(option.name), "a recording", found);
}

const std::vector<RunOption>& run_options() {
  static const std::vector<RunOption> rows = [] {
    std::vector<RunOption> all;
    add_source_rows(all);
    add_recording_rows(all);
    add_culling_rows(all);
    add_message_rows(all);
    return all;
  }();
  return rows;
}

double apply(const RunOptions& options, Scene& scene, std::vector<std::string>& notes) {
  if (options.seconds && scene.recorded && *options.seconds > scene.duration_s)
    notes.push_back(fmt::format("{} ends after {:.6g} s", scene.name, scene.duration_s));
  else if (options.seconds)
    scene.duration_s = *options.seconds;
  if (options.seed) scene.seed = *options.seed;
  if (options.steering) scene.steering.model = *options.steering;
  if (options.part_volume) scene.part_volume = *options.part_volume;
  if (options.exact) scene.exact = true;
  if (options.proximity_m) scene.proximity_m = *options.proximity_m;
  if (options.closest_parts_m) scene.closest_parts_m = *options.closest_parts_m;
  if (options.contact_points) scene.contact_points = true;
  if (options.group_filter) scene.group_filter = *options.group_filter;
  if (options.part_filter) scene.part_filter = *options.part_filter;
  return options.avatars ? scale_to(scene, *options.avatars, notes) : 1;
}

SimulationOptions simulation_options(const RunOptions& options) {
  const bool is_papers = options.strategy != Strategy::kPipeline;
  if (is_papers && (options.budget_ms || options.budget_tests))
    throw InputError(options.where("strategy"), "'pipeline' with a budget",
                     fmt::format("'{}'", name_of(options.strategy)));
  SimulationOptions out;
  out.threads = options.threads.value_or(core_count());
  out.culler.simd = resolved(options.simd);
  out.culler.budget_ms = options.budget_ms;
  out.culler.budget_tests = options.budget_tests;
  out.strategy = options.strategy;
  out.culler.pair_search =
      options.pair_search.value_or(is_papers ? PairSearch::kBrute : PairSearch::kGrid);
  return out;
}

double state_every(const RunOptions& options, const Scene& scene) {
  if (!options.states_hz) return 1;
  const double frames_hz = 1 / scene.step_s;
  if (*options.states_hz > frames_hz * (1 + 1e-9))
    throw InputError(
        options.where("states_hz"),
        fmt::format("at most {:.6g}, the frames per second of {}", frames_hz, scene.name),
        fmt::format("{:.6g}", *options.states_hz));
  return std::max(1.0, frames_hz / *options.states_hz);
}

RecordingOptions recording_options(const std::filesystem::path& file, const RecordingFlags& flags) {
  RecordingOptions out{.file = file, .fps = flags.fps, .columns = flags.columns};
  if (const auto unit = unit_named(flags.unit)) out.unit_m = unit->in_si;
  if (const auto unit = unit_named(flags.heading_unit)) out.heading_unit_rad = unit->in_si;
  out.separator = separator_named(flags.separator);
  if (!flags.tracked_point.empty())
    out.tracked_point = flags.tracked_point == "head" ? TrackedPoint::kHead : TrackedPoint::kCentre;
  out.strict = flags.strict;
  return out;
}

}  // namespace throng
