// `realism`: how bodies behave that walk among others; see kUsage.
#include <fmt/format.h>

#include <charconv>
#include <exception>
#include <map>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "base/errors.h"
#include "base/say.h"
#include "bench/realism/encounter_run.h"
#include "lcmtypes/log/log_sink.h"

namespace throng::realism {
namespace {

constexpr const char* kUsage =
    R"(realism encounters [COUNT [SEED]]          two people meet, COUNT times [1000, seed 1]
realism encounter NUMBER [--seed S] [--log FILE]   one of these; the log is for `throng render`

Option of all: --threads N.
)";

struct Arguments {
  std::vector<std::string> words;
  std::map<std::string, std::string> options;
};

Arguments arguments_of(int argc, char** argv) {
  Arguments out;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (!word.starts_with("--")) {
      out.words.push_back(word);
      continue;
    }
    if (i + 1 == argc) throw InputError(word, "a value after it", "nothing");
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

uint64_t option(const Arguments& arguments, const std::string& name, uint64_t otherwise) {
  const auto found = arguments.options.find(name);
  return found == arguments.options.end() ? otherwise : whole(name, found->second);
}

int threads_of(const Arguments& arguments) {
  return static_cast<int>(
      option(arguments, "--threads", std::max(1u, std::thread::hardware_concurrency())));
}

int encounters(const Arguments& arguments) {
  EncounterOptions options;
  options.threads = threads_of(arguments);
  if (arguments.words.size() > 1) options.count = whole("COUNT", arguments.words[1]);
  options.seed = arguments.words.size() > 2 ? whole("SEED", arguments.words[2])
                                            : option(arguments, "--seed", 1);
  const EncounterRuns runs = run_encounters(options, nullptr, [&](uint64_t done) {
    if (options.count > 1000) say("{} of {}\n", done, options.count);
  });
  show("{}", encounter_report(runs, options));
  return 0;
}

int encounter(const Arguments& arguments) {
  EncounterOptions options;
  if (arguments.words.size() < 2) throw InputError("encounter", "its number", "nothing");
  options.first = whole("NUMBER", arguments.words[1]);
  options.count = 1;
  options.seed = option(arguments, "--seed", 1);
  std::optional<LogSink> log;
  if (const auto found = arguments.options.find("--log"); found != arguments.options.end())
    log.emplace(found->second);
  const EncounterRuns runs = run_encounters(options, log ? &*log : nullptr);
  show("{}: {}\n", options.first, Encounter(options.seed, options.first).description());
  for (const EncounterResult& result : runs.results)
    show(
        "roots {:.3f} m apart at the nearest; touching in {} frames, the first at {:.2f} s; "
        "{:.1f} cm deep at {:.2f} s {}\n",
        result.nearest_roots_m, result.touching_frames, result.first_touch_s,
        100 * result.deepest_m, result.deepest_s, result.deepest_parts);
  if (runs.results.empty()) show("put away: discs of {} m met\n", Encounter::kDisc_m);
  return 0;
}

int realism(int argc, char** argv) {
  const Arguments arguments = arguments_of(argc, argv);
  const std::string command = arguments.words.empty() ? "" : arguments.words.front();
  if (command == "encounters") return encounters(arguments);
  if (command == "encounter") return encounter(arguments);
  say("{}", kUsage);
  return 2;
}

}  // namespace
}  // namespace throng::realism

int main(int argc, char** argv) {
  try {
    const int code = throng::realism::realism(argc, argv);
    return throng::flush_shown() ? code : 3;
  } catch (const throng::InputError& error) {
    throng::say("{}\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    throng::say("{}\n", error.what());
    return 3;
  }
}
