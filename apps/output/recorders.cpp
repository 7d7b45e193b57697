#include "apps/output/recorders.h"

#include <fmt/format.h>

#include <algorithm>

#include "scenes/sinks/by_part.h"
#include "scenes/sinks/trace.h"
#include "viewer/replay/replay_file.h"
#include "viewer/server/page.h"

namespace throng {

void add_recorder_options(CommandOptions& app, RecorderOptions& options) {
  app.add_option("--trajectory", options.trajectories,
                 "Positions to FILE.sqlite (as JuPedSim, PedPy) or FILE.csv")
      ->check([](const std::string& name) {
        return is_trajectory_name(name)
                   ? std::string()
                   : fmt::format("expected a name that ends in .sqlite or .csv, found '{}'", name);
      })
      ->expected(1)
      ->take_all()
      ->type_name("FILE");
  app.add_option("--trajectory-fps", options.trajectory_fps,
                 "Frames a second in it [10; of a recording its own]")
      ->check(number_option(0, 1e4, true, "a number of frames a second above 0"))
      ->type_name("F");
  app.add_option("--html", options.html, "The 3-D page with the run in it, one file to send")
      ->type_name("FILE");
  app.add_option("--contacts", options.contacts, "Contact statistics: a folder of CSV and figures")
      ->type_name("DIR");
  app.add_option("--by-part", options.by_part,
                 "Tests, passes and false positives by pair of parts: a folder of CSV and figures")
      ->type_name("DIR")
      ->excludes("--deadline-ms")
      ->excludes("--deadline-tests");
  app.add_option("--trace-hash", options.trace,
                 "A hash a stage and frame, to see where two runs part ways")
      ->type_name("FILE");
}

void plan_recorders(const RecorderOptions& options, OutputPlan& plan) {
  for (const std::string& name : options.trajectories) {
    PlannedFile file{.option = "--trajectory",
                     .path = name,
                     .writing = Writing::kAsItRuns,
                     .is_recording = true};
    if (file.path.extension() == ".sqlite")
      for (const char* ending : kBesideSqlite) file.beside.emplace_back(name + ending);
    plan.writes(std::move(file));
  }
  plan.writes({.option = "--trace-hash", .path = options.trace, .writing = Writing::kAsItRuns});
  plan.writes({.option = "--html", .path = options.html, .is_recording = true});
  plan.fills("--contacts", options.contacts, contact_files());
  plan.fills("--by-part", options.by_part, by_part_files());
}

template <typename Recorder>
void Recorders::add(std::unique_ptr<Recorder> recorder) {
  guards_.push_back(std::make_unique<SinkGuard>(*recorder));
  recorders_.push_back(std::move(recorder));
}

Recorders::Recorders(const RecorderOptions& options) {
  for (const std::string& file : options.trajectories)
    add(std::make_unique<TrajectorySink>(TrajectoryOptions{file, options.trajectory_fps}));
  if (!options.trace.empty()) add(std::make_unique<TraceSink>(options.trace));
  if (!options.html.empty())
    add(std::make_unique<ReplaySink>(options.html, page_html(), kReplayLimitMb));
  if (!options.by_part.empty()) add(std::make_unique<ByPartSink>(options.by_part));
  if (options.contacts.empty()) return;
  auto contacts = std::make_unique<ContactSink>(options.contacts);
  contacts_ = contacts.get();
  add(std::move(contacts));
}

std::vector<Sink*> Recorders::sinks() const {
  std::vector<Sink*> all;
  for (const auto& guard : guards_) all.push_back(guard.get());
  return all;
}

bool Recorders::failed() const {
  return std::any_of(guards_.begin(), guards_.end(), [](const auto& g) { return g->failed(); });
}

std::string Recorders::failures() const {
  std::string text;
  for (const auto& guard : guards_)
    if (guard->failed()) text += guard->failure() + "\n";
  return text;
}

}  // namespace throng
