// One HTML file with the page and a recorded run in it, to open from disk or to send.
// One rule: no larger than the reader was allowed; what does not fit is an error that says what
// would.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "lcm_io/codec/encoder.h"
#include "viewer/replay/replay.h"

namespace throng {

inline constexpr double kReplayLimitMb = 25;  ///< what most e-mail servers take

struct ReplayReport {
  uint64_t bytes = 0;
  int avatars = 0;
  double seconds = 0;
  std::string problem{};  ///< what of the run is missing, also in the page; "" if nothing is
};

/// Throws InputError if it would be larger than `limit_mb`, EnvironmentError if it cannot be
/// written. `problem`: what of the run is missing.
ReplayReport write_replay(ReplayRecorder& recorder, const std::filesystem::path& html,
                          std::string_view page, double limit_mb, const std::string& problem = "");

/// The same from a log, as far as that is sound. Throws InputError if it is none, or of nobody.
ReplayReport write_replay(const std::filesystem::path& log, const std::filesystem::path& html,
                          std::string_view page, double limit_mb);

/// Records a run while it goes on, and writes the file at its end.
class ReplaySink final : public Sink, private MessageTarget {
 public:
  /// Creates the file. Throws EnvironmentError if it cannot. `page` must outlive it.
  ReplaySink(const std::filesystem::path& html, std::string_view page, double limit_mb);

  SinkNeeds needs() const override { return {.postures = true}; }
  /// Throws InputError if nobody is in the run.
  void begin(const RunInfo& run) override;
  void frame(const RunInfo& run, const Frame& frame) override;
  void end(const RunInfo& run, const RunEnd& end) override;

  const ReplayReport& report() const { return report_; }

 private:
  void message(Channel channel, int64_t utime_us, std::span<const uint8_t> bytes) override;

  std::filesystem::path html_;
  std::string_view page_;
  double limit_mb_;
  ReplayRecorder recorder_;
  std::optional<RunEncoder> encoder_;
  ReplayReport report_;
};

}  // namespace throng
