// TraceSink writes one hash per frame and stage, to find where two runs start to differ.
// Invariant: hashes cover results, not memory layout; traces of any two machines are comparable.
#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string_view>
#include <vector>

#include "scenes/run/sink.h"

namespace throng {

/// Writes lines "FRAME STAGE HASH" for the stages steering (roots and speeds), gait (joint
/// positions), poses (all parts of all avatars), pairs and events. The first line in which two
/// traces differ names the stage to inspect.
class TraceSink final : public Sink {
 public:
  /// Opens the file; begin() truncates it. Throws EnvironmentError naming the file.
  explicit TraceSink(const std::filesystem::path& file);

  SinkNeeds needs() const override { return {.postures = true}; }
  void begin(const RunInfo& run) override;
  /// Throws EnvironmentError if a line cannot be written.
  void frame(const RunInfo& run, const Frame& frame) override;
  void end(const RunInfo& run, const RunEnd& end) override;

 private:
  void line(int64_t frame, std::string_view stage, uint64_t hash);
  uint64_t hash_of_poses(const RunInfo& run, const Frame& frame);
  void flush();
  [[noreturn]] void fail() const;

  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::filesystem::path file_;
  std::unique_ptr<std::FILE, Close> out_;
  std::vector<PartPose> poses_;
};

}  // namespace throng
