#include "python/run_files.h"

#include <fmt/format.h>

#include "analysis/contacts/contact_sink.h"
#include "analysis/trace.h"
#include "analysis/trajectories/trajectory_sink.h"
#include "base/errors.h"
#include "lcm_io/codec/encoder.h"
#include "lcm_io/log/log_sink.h"
#include "scenes/separation/separation_rule.h"
#include "viewer/replay/replay.h"
#include "viewer/server/page.h"

namespace fs = std::filesystem;

namespace throng {
namespace {

void reject_overwritten_inputs(const RunRequest& request, const Scene& scene) {
  std::vector<fs::path> outputs = request.trajectory;
  outputs.push_back(request.log);
  outputs.push_back(request.html);
  outputs.push_back(request.trace_hash);
  for (const fs::path& output : outputs)
    for (const fs::path& input : {fs::path(request.source), scene.file}) {
      std::error_code error;
      if (!output.empty() && fs::equivalent(output, input, error))
        throw InputError(output.string(), "a file other than the input", "the same");
    }
}

}  // namespace

bool writes_files(const RunRequest& request) {
  return !(request.log.empty() && request.html.empty() && request.contacts.empty() &&
           request.separation.empty() && request.trace_hash.empty() && request.trajectory.empty());
}

void check_files(const RunRequest& request, const Scene& scene) {
  for (const fs::path& file : request.trajectory)
    if (!is_trajectory_name(file))
      throw InputError("trajectory", "a name ending in .sqlite or .csv",
                       fmt::format("'{}'", file.string()));
  reject_overwritten_inputs(request, scene);
  if (!request.separation.empty()) require_separation(scene, "separation");
  require_trajectory_area(request.trajectory, scene, request.trajectory_piece, "trajectory_area");
  state_every(request.options, scene);
}

RunFiles::RunFiles(const RunRequest& request, const Simulation& simulation) {
  if (!request.log.empty() || !request.html.empty())
    require_encodable(simulation.info(), request.options.publish_part_poses);
  for (const fs::path& file : request.trajectory)
    files_.push_back(std::make_unique<TrajectorySink>(
        TrajectoryOptions{file, request.trajectory_fps, request.trajectory_piece}));
  if (!request.html.empty())
    files_.push_back(std::make_unique<ReplaySink>(request.html, page_html(), kReplayLimitMb));
  if (!request.contacts.empty())
    files_.push_back(
        std::make_unique<ContactSink>(request.contacts, BodyMap::is_known(simulation.scene())));
  if (simulation.scene().separation)
    separation_ =
        std::make_unique<SeparationSink>(request.separation, *simulation.scene().separation);
  if (!request.trace_hash.empty())
    files_.push_back(std::make_unique<TraceSink>(request.trace_hash));
  if (!request.log.empty()) {
    LogOptions options;
    options.threads = request.simulation.threads;
    options.state_every = state_every(request.options, simulation.scene());
    options.part_poses = request.options.publish_part_poses;
    files_.push_back(std::make_unique<LogSink>(request.log, options));
  }
}

std::vector<Sink*> RunFiles::sinks() const {
  std::vector<Sink*> all;
  for (const auto& file : files_) all.push_back(file.get());
  if (separation_) all.push_back(separation_.get());
  return all;
}

}  // namespace throng
