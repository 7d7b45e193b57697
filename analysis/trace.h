// A line a stage and frame with a hash of what the stage produced, to find where two runs that
// should be the same part ways.
// One rule: it hashes what a stage says, never how it is stored, so that any two machines compare.
#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string_view>
#include <vector>

#include "scenes/run/sink.h"

namespace throng {

/// Lines "FRAME STAGE HASH": steering (roots and speeds), gait (joint angles), poses (of every part
/// of every avatar, whether or not culling asked for it), pairs, events. The first line in which
/// two files differ names the stage to look at.
class TraceSink final : public Sink {
 public:
  /// Opens the file; begin() empties it. Throws EnvironmentError naming it.
  explicit TraceSink(const std::filesystem::path& file);

  SinkNeeds needs() const override { return {.postures = true}; }
  void begin(const RunInfo& run) override;
  /// Throws EnvironmentError when a line could not be written.
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
