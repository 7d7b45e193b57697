#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <thread>

#include "apps/command.h"
#include "apps/options/run_arguments.h"
#include "apps/output/checkpoints.h"
#include "apps/output/output_plan.h"
#include "apps/output/recorders.h"
#include "apps/output/run_report.h"
#include "apps/output/text_file.h"
#include "apps/process/external_control.h"
#include "apps/process/progress.h"
#include "apps/process/stop_signal.h"
#include "base/console.h"
#include "base/errors.h"
#include "base/files/atomic_file.h"
#include "base/text.h"
#include "crowd/journeys.h"
#include "lcm_io/codec/encoder.h"
#include "lcm_io/log/log_sink.h"
#include "lcm_io/replay/file_kind.h"
#include "lcm_io/replay/run_source.h"
#include "lcm_io/wire/filtered_channels.h"
#include "lcm_io/wire/lcm_sink.h"
#include "scenes/run/runner.h"

namespace throng {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRunFooter = R"(
Examples:
  throng run plaza
  throng run plaza --avatars 5000 --seconds 2 --json result.json
  throng run corridor --exact --lcm off --log corridor.lcmlog
  throng run plaza --avatars 20000 --seconds 1 --budget-ms 5 --log off
  throng run paper_500 --strategy two-pass --log off
  throng run my_scene.yaml --part-volume obb --threads 1 --log off
  throng run plaza --pace 1                          in real time, to watch it live
  throng run corridor --lcm off --log off --trajectory corridor.sqlite
  throng run cell.yaml --separation separation       distances of robots to people, docs/contacts.md
  throng run plaza --part-pairs parts                tests, passes and false positives by pair of parts
  throng run plaza --part-volume 'hands: sphere, default: ordop26'
  throng run plaza --states-hz 10 --seconds 600      a log of a fifth of the size, with every contact
  throng run plaza --seconds 3600 --checkpoint plaza.checkpoint --checkpoint-every 60
  throng run plaza --seconds 3600 --resume plaza.checkpoint --log rest.lcmlog
  throng run uo-050-180-180.txt --fps 16 --unit cm         a recording; bodies follow its tracks
  throng run out/plaza.lcmlog --exact --part-volume obb    find contacts in the poses of a log

An event is the begin or the end of a contact. Two parts are in contact if their bounding volumes overlap; with
--exact, if their triangles intersect. The events depend on the scene or recording and its options, --avatars,
--seconds, --seed, --steering, --part-volume, --exact, the filters, the budgets and (without --exact) --strategy.
They never depend on --threads, --simd, --pair-search or --pace.

With a budget, pairs that touched in the last frame are refined first, then those with the deepest overlap of
spheres. The remaining pairs are reported at the level they reached: spheres, boxes, part volumes or triangles.

Ctrl-C ends the run with its summary, a sound log and exit code 130; SIGTERM with 143, SIGHUP with 129.

No file is changed before all options and inputs are checked. An older log under the default name
out/SCENE.lcmlog is kept as out/SCENE.previous.lcmlog; a file that you name is replaced.)";

struct RunCommand {
  std::string file;
  RunOptions run;
  double pace = 0;
  std::string lcm{kDefaultLcmUrl};
  std::string log;
  std::string json;
  std::vector<std::string> publish_for;
  RecorderOptions recorders;
  double flush_s = LogOptions{}.flush_s;
  CheckpointOptions checkpoints;
  ExternalControlOptions external_control;
};

void add_options(CommandOptions& app, RunCommand& options) {
  add_run_options(app, options.file, options.run);
  app.add_option("--pace", options.pace, "Target real-time factor; 1: real time [unlimited]")
      ->check(number_option(0, 1e6, true, "a number above 0; 1 is real time"))
      ->type_name("X");
  app.add_option("--lcm", options.lcm,
                 fmt::format("LCM URL to publish to, or off [{}]", options.lcm))
      ->check([](const std::string& url) {
        // liblcm would open a file too early.
        const bool is_fine = url.empty() || url == "off" || url.starts_with("udpm://") ||
                             url.starts_with("tcpq://") || url.starts_with("memq://");
        return is_fine ? std::string()
                       : fmt::format(
                             "expected off or a URL that begins with udpm://, tcpq:// "
                             "or memq:// (--log FILE writes a log), found '{}'",
                             url);
      })
      ->type_name("URL");
  app.add_option("--log", options.log, "LCM log to write, or off [out/SCENE.lcmlog]")
      ->type_name("FILE");
  app.add_option(
         "--flush-s", options.flush_s,
         "Maximum delay of a frame to the log file, in seconds; 0: before the next frame [0.25]")
      ->check(number_option(0, 3600, false, "a number of seconds from 0 to 3600"))
      ->type_name("S");
  app.add_option("--publish-for", options.publish_for,
                 "Also publish events and proximity rows of WHO (group, body id or all) on "
                 "CHANNEL_EVENTS, _PROXIMITY and _STAMP")
      ->take_many()
      ->type_name("WHO:CHANNEL");
  app.add_option("--json", options.json, kJsonHelp)->type_name("FILE");
  add_recorder_options(app, options.recorders);
  add_checkpoint_options(app, options.checkpoints);
  add_external_control_options(app, options.external_control);
}

PlannedFile planned_log(const RunCommand& options) {
  PlannedFile log{.option = "--log", .mode = WriteMode::kStreamed, .is_recording = true};
  if (options.log == "off") return log;
  log.path = options.log;
  if (!log.path.empty()) return log;
  // A default log must not replace the log that is culled again or resumed.
  const std::string ending = fmt::format("{}{}.lcmlog", is_log(options.file) ? "_culled" : "",
                                         options.checkpoints.resume.empty() ? "" : "_resumed");
  log.path = fs::path("out") / fs::path(options.file).stem().concat(ending);
  log.makes_folder = true;
  // The user did not choose this name, so an older log is kept.
  log.keep_as = resolve_links(log.path).replace_extension(".previous.lcmlog");
  return log;
}

/// The outputs of the run. Inputs of the scene are added once it is loaded.
OutputPlan planned_outputs(const RunCommand& options, const PlannedFile& log) {
  OutputPlan plan;
  plan.writes(log);
  plan.writes_json(options.json);
  plan_recorders(options.recorders, plan);
  plan_checkpoints(options.checkpoints, plan);
  return plan;
}

/// Delays frames to follow the clock. It only waits, so no result depends on it. It counts late
/// frames.
class Pacer {
 public:
  /// `pace`: target real-time factor; 0 never waits.
  explicit Pacer(double pace) : pace_(pace) {}

  /// Waits until the frame at this simulation time is due, or `stopped` returns true. Frame 0
  /// starts the clock.
  void wait_for(int64_t utime_us, const std::function<bool()>& stopped);

  double pace() const { return pace_; }
  int64_t late_frames() const { return late_frames_; }  ///< frames more than kTolerance_s late
  double worst_s() const { return worst_s_; }           ///< lateness of the latest frame
  double behind_s() const { return behind_s_; }         ///< lateness of the last frame

  /// Longer than a scheduler's tick and a wake-up, shorter than visible.
  static constexpr double kTolerance_s = 0.005;

 private:
  using Clock = std::chrono::steady_clock;
  double pace_;
  bool is_running_ = false;
  Clock::time_point start_{};
  int64_t late_frames_ = 0;
  double worst_s_ = 0;
  double behind_s_ = 0;
};

void Pacer::wait_for(int64_t utime_us, const std::function<bool()>& stopped) {
  if (pace_ <= 0) return;
  if (!is_running_) {
    is_running_ = true;
    start_ = Clock::now();
  }
  // A frame may be minutes away at a slow pace: poll `stopped`.
  constexpr std::chrono::milliseconds kPollPeriod{50};
  const std::chrono::duration<double> since_start(static_cast<double>(utime_us) * 1e-6 / pace_);
  const auto due = start_ + std::chrono::duration_cast<Clock::duration>(since_start);
  auto now = Clock::now();
  behind_s_ = std::max(0.0, std::chrono::duration<double>(now - due).count());
  worst_s_ = std::max(worst_s_, behind_s_);
  late_frames_ += behind_s_ > kTolerance_s ? 1 : 0;
  for (; now < due && !stopped(); now = Clock::now())
    std::this_thread::sleep_until(std::min<Clock::time_point>(due, now + kPollPeriod));
}

struct Listeners {
  std::unique_ptr<LogSink> log;
  std::unique_ptr<LogGuard> guard;
  std::unique_ptr<LcmSink> lcm;
  std::unique_ptr<RunEncoder> messages;  ///< for log and LCM; null without either
  std::unique_ptr<Recorders> recorders;
  std::unique_ptr<FilteredChannels> filtered;  ///< null without --publish-for

  std::vector<Sink*> sinks() const {
    std::vector<Sink*> all = recorders->sinks();
    if (filtered != nullptr) all.push_back(filtered.get());
    if (messages != nullptr) all.push_back(messages.get());
    return all;
  }
  bool lost_log() const { return guard != nullptr && guard->failed(); }
  bool lost_file() const { return lost_log() || recorders->failed(); }
};

std::unique_ptr<FilteredChannels> filtered_channels(const RunCommand& options, const RunInfo& run) {
  if (options.publish_for.empty()) return {};
  if (options.lcm == "off") throw InputError("--publish-for", "LCM to publish over", "--lcm off");
  std::vector<FilteredChannel> requested;
  for (const std::string& text : options.publish_for)
    requested.push_back(parse_filtered_channel(text));
  return std::make_unique<FilteredChannels>(run, requested);
}

RunSummary run_to_end(Simulation& simulation, const Listeners& listeners, Pacer& pacer,
                      ExternalControl& external_control, Checkpoints& checkpoints) {
  ProgressBar progress(simulation.scene().name,
                       frame_count(simulation.scene().duration_s, simulation.info().step_s));
  return run(simulation, listeners.sinks(), [&](const Frame& frame) {
    progress.show(frame.number + 1);
    if (!external_control.await(simulation, frame)) return false;
    const double next_s = static_cast<double>(frame.number + 1) * simulation.info().step_s;
    pacer.wait_for(std::llround(next_s * 1e6), StopSignal::requested);
    external_control.take(simulation);
    const bool stops = StopSignal::requested();
    checkpoints.after(simulation, frame, stops);
    return !stops && !listeners.lost_file() && checkpoints.failure().empty();
  });
}

/// " by SIGINT"; "" if a file error ended the run.
std::string by_signal() {
  return StopSignal::requested() ? fmt::format(" by {}", StopSignal::name()) : "";
}

RunReport report_of(const RunCommand& options, const SimulationOptions& simulated,
                    const Scene& scene, const RunSummary& summary, const Listeners& listeners,
                    const fs::path& log) {
  RunReport report;
  report.scene = scene.name;
  report.seed = scene.seed;
  report.step_s = scene.step_s;
  report.threads = simulated.threads;
  report.simd = name_of(simulated.culler.simd);
  report.budget_ms = options.run.budget_ms;
  report.budget_tests = options.run.budget_tests;
  report.steering = scene.steering;
  report.summary = summary;
  for (const Stranding& stranding : summary.strandings)
    report.stranded.push_back(
        {scene.groups[stranding.group].name, stranding.stop + 1, stranding.people});
  report.ground_m = scene.ground.size_m();
  report.lcm.url = "off";
  if (listeners.lcm != nullptr)
    report.lcm = {listeners.lcm->url(), listeners.lcm->messages(), listeners.lcm->bytes(),
                  listeners.lcm->dropped()};
  report.log = listeners.log == nullptr ? "off" : log.string();
  report.log_bytes = listeners.log == nullptr ? 0 : listeners.log->bytes();
  if (const ContactSink* contacts = listeners.recorders->contacts())
    report.contacts = {options.recorders.contacts, contacts->statistics()->totals()};
  if (const SeparationSink* separation = listeners.recorders->separation())
    report.separation = {options.recorders.separation, *separation->totals()};
  return report;
}

void share_encoder(Listeners& listeners) {
  if (listeners.log == nullptr && listeners.lcm == nullptr) return;
  listeners.messages = std::make_unique<RunEncoder>();
  if (listeners.log != nullptr)
    listeners.messages->add(listeners.log->encoding(), *listeners.guard);
  if (listeners.lcm != nullptr) listeners.messages->add(listeners.lcm->encoding(), *listeners.lcm);
}

/// Opens the outputs, the log last: the older log moves only after all others are open.
Listeners open_listeners(const RunCommand& options, int threads, const Scene& scene,
                         const PlannedFile& log, double states, OpenOutputs& outputs,
                         std::shared_ptr<lcm::LCM> connection) {
  Listeners listeners;
  if (options.lcm != "off") {
    LcmOptions lcm;
    lcm.url = options.lcm;
    lcm.state_every = states;
    lcm.part_poses = options.run.publish_part_poses;
    listeners.lcm = connection ? std::make_unique<LcmSink>(lcm, std::move(connection))
                               : std::make_unique<LcmSink>(lcm);
  }
  listeners.recorders = std::make_unique<Recorders>(options.recorders, scene);
  outputs.keep_previous();
  for (const std::string& note : outputs.notes()) print_message("note: {}\n", note);
  if (!log.path.empty()) {
    LogOptions log_options;
    log_options.flush_s = options.flush_s;
    log_options.threads = threads;
    log_options.state_every = states;
    log_options.part_poses = options.run.publish_part_poses;
    listeners.log = std::make_unique<LogSink>(log.path, log_options);
    listeners.guard = std::make_unique<LogGuard>(*listeners.log);
  }
  share_encoder(listeners);
  return listeners;
}

int report_end(const RunCommand& options, const RunReport& report, const Listeners& listeners,
               const Checkpoints& checkpoints) {
  print_unless_json(options.json, format_table(report));
  if (listeners.lost_log()) print_message("{}\n", listeners.guard->failure());
  print_message("{}", listeners.recorders->failures());
  if (!listeners.lost_file())
    for (const std::string& note : listeners.recorders->notes()) print_message("note: {}\n", note);
  const std::string late = report.lockstep ? report.lockstep->failure : "";
  for (const std::string& failure : {checkpoints.failure(), late})
    if (!failure.empty()) print_message("{}\n", failure);
  if (!options.checkpoints.file.empty() && checkpoints.written() == 0 &&
      checkpoints.failure().empty())
    print_message(
        "note: no checkpoint: the run ended before the first was due; lower --checkpoint-every\n");
  write_json_output(options.json, json_text(report));
  if (listeners.lost_file() || !checkpoints.failure().empty() || !late.empty())
    return kExitEnvironment;
  return report.summary.stopped_early ? StopSignal::exit_code() : kExitSuccess;
}

int run_scene(const RunCommand& options) {
  SimulationOptions simulated = simulation_options(options.run);
  simulated.culler.by_part = !options.recorders.by_part.empty();
  const PlannedFile log = planned_log(options);
  OutputPlan plan = planned_outputs(options, log);
  plan.check();  // before loading, which takes time
  RunSource source = open_run_source(options.file, options.run);
  require_recordable(options.recorders, source.scene);
  for (const std::string& note : source.notes) print_message("note: {}\n", note);
  const double states = state_every(options.run, source.scene);
  plan_inputs(source.scene, plan);
  plan.check();
  simulated.motion = std::move(source.motion);
  Simulation simulation(std::move(source.scene), simulated);
  require_recordable(options.recorders, simulation.info());
  if (!log.path.empty() || options.lcm != "off" || !options.recorders.html.empty())
    require_encodable(simulation.info(), options.run.publish_part_poses);
  for (const std::string& note : simulation.notes()) print_message("note: {}\n", note);
  Pacer pacer(options.pace);
  std::unique_ptr<FilteredChannels> filtered = filtered_channels(options, simulation.info());
  const std::vector<std::string> filter_notes =
      filtered == nullptr ? std::vector<std::string>() : filtered->notes();
  for (const std::string& note : filter_notes) print_message("note: {}\n", note);
  ExternalControl external_control(options.external_control, simulation.info(), options.lcm,
                                   options.pace > 0);
  resume_if_requested(options.checkpoints, simulation);
  external_control.begin(simulation);

  // All input is accepted: only now files change, and from here on a signal waits for complete
  // files.
  const StopSignal stop;
  OpenOutputs outputs = plan.open();
  Listeners listeners = open_listeners(options, simulated.threads, simulation.scene(), log, states,
                                       outputs, external_control.connection());
  listeners.filtered = std::move(filtered);
  if (listeners.filtered != nullptr) listeners.filtered->publish_by(*listeners.lcm);
  Checkpoints checkpoints(options.checkpoints, simulation.info().step_s);
  const RunSummary summary =
      run_to_end(simulation, listeners, pacer, external_control, checkpoints);
  for (const Stranding& stranding : summary.strandings)
    print_message("note: {}\n", describe(stranding, simulation.scene()));
  if (summary.stopped_early)
    print_message("stopped after {}{}\n", counted(summary.frames, "frame"), by_signal());

  RunReport report =
      report_of(options, simulated, simulation.scene(), summary, listeners, log.path);
  if (listeners.filtered != nullptr) report.filtered_channels = listeners.filtered->totals();
  if (external_control.changes() != nullptr)
    report.crowd_changes = external_control.changes()->counts();
  if (external_control.receiver() != nullptr)
    report.external_control = external_control.receiver()->counts();
  if (const Lockstep* lockstep = external_control.lockstep(); lockstep != nullptr)
    report.lockstep = {lockstep->counts(), lockstep->timeout_s(), lockstep->total_wait_s(),
                       lockstep->max_wait_s(), lockstep->failure()};
  report.recording = std::move(source.recording);
  report.scale_factor = source.scale_factor;
  report.notes = std::move(source.notes);
  report.notes.insert(report.notes.end(), simulation.notes().begin(), simulation.notes().end());
  report.notes.insert(report.notes.end(), filter_notes.begin(), filter_notes.end());
  report.pace = {pacer.pace(), pacer.late_frames(), pacer.worst_s(), pacer.behind_s()};
  return report_end(options, report, listeners, checkpoints);
}

}  // namespace

Command add_run_command(CommandLine& parent) {
  CommandOptions* app =
      parent.add_subcommand("run", "Run a scene and detect every contact, frame by frame");
  app->footer(kRunFooter);
  const auto options = std::make_shared<RunCommand>();
  add_options(*app, *options);
  return {app, [options] { return run_scene(*options); }};
}

}  // namespace throng
