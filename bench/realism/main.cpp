// `realism` measures how bodies move among others; see kUsage.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdlib>
#include <exception>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/console.h"
#include "base/cores.h"
#include "base/errors.h"
#include "bench/realism/contact_audit.h"
#include "bench/realism/encounters.h"
#include "bench/realism/joints.h"
#include "bench/realism/measured_run.h"
#include "lcm_io/log/log_sink.h"

namespace throng::realism {
namespace {

constexpr const char* kUsage =
    R"(realism encounters [COUNT [SEED]] [--worst N]
    runs COUNT encounters of two people [1000, seed 1] and lists the N deepest [10]
realism encounter NUMBER [--seed S] [--log FILE]
    runs one encounter; the log is for `throng render`
realism contacts FILE... [--against FILE...]
    contacts by density, per file and in total; with --against before and after
realism joints [FILE...]
    joint speeds, arm swing, turns of standing people; without FILE: plain walking, 0.5 to 1.9 m/s

FILE: a scene, the name of a bundled one, or a recording. Options of all: --threads N,
--seconds S (per FILE), --body-avoidance on|off (bodies avoid each other) [on].
)";

constexpr std::array kOptions = {"--log",     "--seconds", "--seed",
                                 "--threads", "--worst",   "--body-avoidance"};

struct Arguments {
  std::vector<std::string> words;
  std::vector<std::string> against;  ///< words after --against
  std::map<std::string, std::string> options;
};

Arguments arguments_of(int argc, char** argv) {
  Arguments out;
  std::vector<std::string>* words = &out.words;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (!word.starts_with("--")) {
      words->push_back(word);
      continue;
    }
    if (word == "--against") {
      words = &out.against;
      continue;
    }
    if (std::find(kOptions.begin(), kOptions.end(), word) == kOptions.end())
      throw InputError("realism", "an option of the program", fmt::format("'{}'", word));
    if (i + 1 == argc) throw InputError(word, "a value", "nothing");
    out.options[word] = argv[++i];
  }
  return out;
}

uint64_t whole(const std::string& where, const std::string& text) {
  uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size())
    throw InputError(where, "a whole number", fmt::format("'{}'", text));
  return value;
}

uint64_t option(const Arguments& arguments, const std::string& name, uint64_t default_value) {
  const auto found = arguments.options.find(name);
  return found == arguments.options.end() ? default_value : whole(name, found->second);
}

bool is_off(const Arguments& arguments, const std::string& name) {
  const auto found = arguments.options.find(name);
  if (found == arguments.options.end() || found->second == "on") return false;
  if (found->second != "off")
    throw InputError(name, "on or off", fmt::format("'{}'", found->second));
  return true;
}

int threads_of(const Arguments& arguments) {
  const uint64_t threads = option(arguments, "--threads", static_cast<uint64_t>(core_count()));
  if (threads < 1 || threads > 256)
    throw InputError("--threads", "a whole number from 1 to 256", fmt::format("{}", threads));
  return static_cast<int>(threads);
}

std::optional<double> seconds_of(const Arguments& arguments) {
  const auto found = arguments.options.find("--seconds");
  if (found == arguments.options.end()) return {};
  const char* const begin = found->second.c_str();
  char* end = nullptr;
  const double seconds = std::strtod(begin, &end);
  if (end == begin || *end != 0 || !(seconds > 0 && seconds < 1e7))
    throw InputError("--seconds", "a number of seconds above 0",
                     fmt::format("'{}'", found->second));
  return seconds;
}

NamedContactSums audit_of(const std::string& name, const Arguments& arguments) {
  ContactAudit audit;
  Scene scene = open_measured_run(name, seconds_of(arguments));
  NamedContactSums out{scene.name, {}};
  run_measured(std::move(scene), threads_of(arguments), true,
               [&](const Simulation&) { return std::vector<Sink*>{&audit}; });
  out.sums = audit.sums();
  return out;
}

int contacts(const Arguments& arguments) {
  const std::vector<std::string> names(arguments.words.begin() + 1, arguments.words.end());
  const bool is_pair = !arguments.against.empty();
  if (names.empty()) throw InputError("contacts", "scenes or recordings", "none");
  if (is_pair && arguments.against.size() != names.size())
    throw InputError("--against", fmt::format("{} files, as many as before it", names.size()),
                     fmt::format("{}", arguments.against.size()));
  NamedContactSums all_before{"total", {}}, all_after = all_before;
  for (size_t i = 0; i < names.size(); ++i) {
    const NamedContactSums before = audit_of(names[i], arguments);
    all_before.sums.add(before.sums);
    std::optional<NamedContactSums> after;
    if (is_pair) {
      after = audit_of(arguments.against[i], arguments);
      all_after.sums.add(after->sums);
    }
    print_result("{}\n", contact_report(before, after ? &*after : nullptr, names.size() == 1));
    flush_results();
  }
  if (names.size() > 1)
    print_result("{}", contact_report(all_before, is_pair ? &all_after : nullptr, true));
  return 0;
}

int joints(const Arguments& arguments) {
  const auto measure = [&](Scene scene) {
    const std::string name = scene.name;
    JointSpeeds speeds;
    std::unique_ptr<ArmSwing> swing;
    // Contacts take much time and move no joint.
    run_measured(std::move(scene), threads_of(arguments), false, [&](const Simulation& simulation) {
      swing = std::make_unique<ArmSwing>(simulation);
      return std::vector<Sink*>{&speeds, swing.get()};
    });
    print_result("{}\n", joint_report(name, speeds, *swing));
    flush_results();
  };
  if (arguments.words.size() == 1) {
    Scene walking = plain_walking(seconds_of(arguments).value_or(20));
    set_switches(walking);
    measure(std::move(walking));
  }
  for (size_t i = 1; i < arguments.words.size(); ++i)
    measure(open_measured_run(arguments.words[i], seconds_of(arguments)));
  return 0;
}

int encounters(const Arguments& arguments) {
  EncounterOptions options;
  options.threads = threads_of(arguments);
  if (arguments.words.size() > 1) options.count = whole("COUNT", arguments.words[1]);
  options.seed = arguments.words.size() > 2 ? whole("SEED", arguments.words[2])
                                            : option(arguments, "--seed", 1);
  options.worst = option(arguments, "--worst", options.worst);
  const EncounterRuns runs = run_encounters(options, nullptr, [&](uint64_t done) {
    if (options.count > 1000) print_message("{} of {}\n", done, options.count);
  });
  print_result("{}", encounter_report(runs, options));
  return 0;
}

/// Returns the command that renders an encounter.
std::string picture_command(const Encounter& encounter, double at_s, const std::string& log) {
  const Eigen::Vector2d at = middle_of(encounter);
  return fmt::format(
      "throng render {} --frame {} --eye {},{},2.5 --target {},{},1 --out encounter_{}.png", log,
      std::llround(at_s / kSyntheticStep_s), at.x() + 2, at.y() - 3, at.x(), at.y(),
      encounter.number());
}

int encounter(const Arguments& arguments) {
  EncounterOptions options;
  if (arguments.words.size() < 2) throw InputError("encounter", "a number", "nothing");
  options.first = whole("NUMBER", arguments.words[1]);
  options.count = 1;
  options.seed = option(arguments, "--seed", 1);
  std::optional<LogSink> log;
  const auto found = arguments.options.find("--log");
  if (found != arguments.options.end()) log.emplace(found->second);
  const EncounterRuns runs = run_encounters(options, log ? &*log : nullptr);
  const Encounter one(options.seed, options.first);
  print_result("{}: {}\n", options.first, one.description());
  if (runs.results.empty()) {
    print_result("rejected: discs of {} m met\n", Encounter::kDisc_m);
    return 0;
  }
  const EncounterResult& result = runs.results.front();
  print_result("minimum root distance {:.3f} m, at {:.2f} s; ", result.min_root_distance_m,
               result.min_distance_s);
  if (!result.touches())
    print_result("no contact\n");
  else
    print_result("touching in {} frames, the first at {:.2f} s; {:.1f} cm deep at {:.2f} s {}\n",
                 result.touching_frames, result.first_touch_s, 100 * result.max_depth_m,
                 result.max_depth_s, result.max_depth_parts);
  const double at_s = result.touches() ? result.max_depth_s : result.min_distance_s;
  if (log) print_result("{}\n", picture_command(one, at_s, found->second));
  return 0;
}

int realism(int argc, char** argv) {
  const Arguments arguments = arguments_of(argc, argv);
  with_body_avoidance = !is_off(arguments, "--body-avoidance");
  const std::string command = arguments.words.empty() ? "" : arguments.words.front();
  if (command == "encounters") return encounters(arguments);
  if (command == "encounter") return encounter(arguments);
  if (command == "joints") return joints(arguments);
  if (command == "contacts") return contacts(arguments);
  print_message("{}", kUsage);
  return 2;
}

}  // namespace
}  // namespace throng::realism

int main(int argc, char** argv) {
  try {
    const int code = throng::realism::realism(argc, argv);
    return throng::flush_results() || throng::stdout_is_closed() ? code : 3;
  } catch (const throng::InputError& error) {
    throng::print_message("{}\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    throng::print_message("{}\n", error.what());
    return 3;
  }
}
