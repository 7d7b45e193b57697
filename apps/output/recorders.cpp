#include "apps/output/recorders.h"

#include <fmt/format.h>

#include <algorithm>

#include "analysis/by_part.h"
#include "analysis/trace.h"
#include "analysis/trajectories/walkable_area.h"
#include "base/errors.h"
#include "scenes/separation/separation_rule.h"
#include "viewer/replay/replay.h"
#include "viewer/server/page.h"

namespace throng {

void add_recorder_options(CommandOptions& app, RecorderOptions& options) {
  app.add_option("--trajectory", options.trajectories,
                 "Write positions of agents to FILE.sqlite (format of JuPedSim, PedPy) or FILE.csv")
      ->check([](const std::string& name) {
        return is_trajectory_name(name)
                   ? std::string()
                   : fmt::format("expected a name that ends in .sqlite or .csv, found '{}'", name);
      })
      ->expected(1)
      ->take_many()
      ->type_name("FILE");
  app.add_option("--trajectory-fps", options.trajectory_fps,
                 "Frames per second of --trajectory [10; that of a recording]")
      ->check(number_option(0, 1e4, true, "a number of frames per second above 0"))
      ->type_name("F");
  app.add_option(
         "--trajectory-area", options.trajectory_area,
         "Piece of a walkable area in several pieces, for FILE.sqlite: largest, or its rank by "
         "size, from 1")
      ->check([](const std::string& word) {
        return trajectory_piece(word)
                   ? std::string()
                   : fmt::format("expected 'largest' or a whole number from 1, found '{}'", word);
      })
      ->type_name("N");
  app.add_option("--html", options.html, "Write a web page that shows the run in 3-D")
      ->type_name("FILE");
  app.add_option("--contacts", options.contacts,
                 "Write contact statistics (CSV and figures) to a folder")
      ->type_name("DIR");
  app.add_option("--separation", options.separation,
                 "Write distances and shortfalls between robots and people to a folder")
      ->type_name("DIR");
  app.add_option("--part-pairs", options.by_part,
                 "Write tests, passes and false positives per pair of parts to a folder")
      ->type_name("DIR")
      ->excludes("--budget-ms")
      ->excludes("--budget-tests");
  app.add_option("--trace-hash", options.trace,
                 "Write a hash per stage and frame, to locate where two runs diverge")
      ->type_name("FILE");
}

void plan_recorders(const RecorderOptions& options, OutputPlan& plan) {
  for (const std::string& name : options.trajectories) {
    PlannedFile file{
        .option = "--trajectory", .path = name, .mode = WriteMode::kStreamed, .is_recording = true};
    if (file.path.extension() == ".sqlite")
      for (const char* ending : kSqliteSideFiles) file.side_files.emplace_back(name + ending);
    plan.writes(std::move(file));
  }
  plan.writes({.option = "--trace-hash", .path = options.trace, .mode = WriteMode::kStreamed});
  plan.writes({.option = "--html", .path = options.html, .is_recording = true});
  plan.fills("--contacts", options.contacts, contact_files());
  plan.fills("--separation", options.separation, separation_files());
  plan.fills("--part-pairs", options.by_part, by_part_files());
}

void require_recordable(const RecorderOptions& options, const Scene& scene) {
  if (!options.separation.empty()) require_separation(scene, "--separation");
  const std::vector<std::filesystem::path> trajectories(options.trajectories.begin(),
                                                        options.trajectories.end());
  require_trajectory_area(trajectories, scene, trajectory_piece(options.trajectory_area),
                          "--trajectory-area");
}

void require_recordable(const RecorderOptions& options, const RunInfo& run) {
  if (!options.html.empty() && run.avatar_count() == 0)
    throw InputError(
        "--html", "a run with people or robots",
        fmt::format("no avatars in '{}'; give a group a count above 0", run.scene->name));
}

template <typename Recorder>
void Recorders::add(std::unique_ptr<Recorder> recorder) {
  guards_.push_back(std::make_unique<SinkGuard>(*recorder));
  recorders_.push_back(std::move(recorder));
}

Recorders::Recorders(const RecorderOptions& options, const Scene& scene) {
  for (const std::string& file : options.trajectories)
    add(std::make_unique<TrajectorySink>(TrajectoryOptions{
        file, options.trajectory_fps, trajectory_piece(options.trajectory_area)}));
  if (!options.trace.empty()) add(std::make_unique<TraceSink>(options.trace));
  if (!options.html.empty())
    add(std::make_unique<ReplaySink>(options.html, page_html(), kReplayLimitMb));
  if (!options.by_part.empty()) add(std::make_unique<ByPartSink>(options.by_part));
  if (scene.separation) {
    auto separation = std::make_unique<SeparationSink>(options.separation, *scene.separation);
    separation_ = separation.get();
    add(std::move(separation));
  }
  if (options.contacts.empty()) return;
  auto contacts = std::make_unique<ContactSink>(options.contacts, BodyMap::is_known(scene));
  contacts_ = contacts.get();
  add(std::move(contacts));
}

std::vector<Sink*> Recorders::sinks() const {
  std::vector<Sink*> all;
  for (const auto& guard : guards_) all.push_back(guard.get());
  return all;
}

std::vector<std::string> Recorders::notes() const {
  std::vector<std::string> notes;
  if (contacts_ != nullptr) notes = contacts_->notes();
  if (separation_ != nullptr && !separation_->note().empty()) notes.push_back(separation_->note());
  return notes;
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

template <typename Write>
void FileGuard::guarded(const Write& write) {
  if (failed()) return;
  try {
    write();
  } catch (const EnvironmentError& error) {
    failure_ = error.what();
  }
}

void SinkGuard::begin(const RunInfo& run) {
  guarded([&] { sink_.begin(run); });
}

void SinkGuard::frame(const RunInfo& run, const Frame& frame) {
  guarded([&] { sink_.frame(run, frame); });
}

void SinkGuard::end(const RunInfo& run, const RunEnd& end) {
  guarded([&] { sink_.end(run, end); });
}

void LogGuard::message(Channel channel, int64_t utime_us, std::span<const uint8_t> bytes) {
  guarded([&] { log_.message(channel, utime_us, bytes); });
}

void LogGuard::after_begin(TargetState& target_state) {
  guarded([&] { log_.after_begin(target_state); });
}

void LogGuard::after_frame(TargetState& target_state) {
  guarded([&] { log_.after_frame(target_state); });
}

void LogGuard::after_end(TargetState& target_state) {
  guarded([&] { log_.after_end(target_state); });
}

}  // namespace throng
