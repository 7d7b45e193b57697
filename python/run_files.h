// RunFiles writes the files that a run in Python asks for: log, page, trajectories and tables.
// Invariant: no file is touched before the run is known to be possible.
#pragma once

#include <memory>
#include <vector>

#include "analysis/separation/separation_sink.h"
#include "python/run_request.h"
#include "scenes/run/simulation.h"
#include "scenes/run/sink.h"

namespace throng {

bool writes_files(const RunRequest& request);

/// Throws InputError for a name or an option that does not fit, or an output that would replace an
/// input.
void check_files(const RunRequest& request, const Scene& scene);

class RunFiles {
 public:
  /// Throws InputError or EnvironmentError.
  RunFiles(const RunRequest& request, const Simulation& simulation);

  std::vector<Sink*> sinks() const;
  /// Totals of a scene with a separation; otherwise null.
  const SeparationSink* separation() const { return separation_.get(); }

 private:
  std::vector<std::unique_ptr<Sink>> files_;
  std::unique_ptr<SeparationSink> separation_;
};

}  // namespace throng
