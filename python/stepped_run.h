// A simulation that goes on step by step, and what its latest frame looks like as arrays.
// One rule: an array shows one frame for as long as somebody holds it. Its buffer is filled when
// first asked for, and used again for a later frame only once nobody holds it any more.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "python/arrays.h"
#include "python/rows.h"
#include "python/run_request.h"
#include "scenes/run/simulation.h"

namespace throng {

/// What an array of a frame lies in.
template <typename T>
class FrameBuffer {
 public:
  /// What `fill` makes of a vector, which may hold an older frame, once a frame; `width` numbers a
  /// row, 0: one.
  template <typename Fill>
  pybind11::array_t<T> array(int64_t frame, pybind11::ssize_t width, const Fill& fill) {
    if (!values_ || frame_ != frame) {
      if (!values_ || values_.use_count() > 1) values_ = std::make_shared<std::vector<T>>();
      fill(*values_);
      frame_ = frame;
    }
    const auto size = static_cast<pybind11::ssize_t>(values_->size());
    std::vector<pybind11::ssize_t> shape{width > 0 ? size / width : size};
    if (width > 0) shape.push_back(width);
    pybind11::array_t<T> out = array_over(values_, std::move(shape));
    forbid_writing(out);
    return out;
  }

 private:
  std::shared_ptr<std::vector<T>> values_;
  int64_t frame_ = -1;
};

/// All functions are called with the interpreter's lock held; those that take long give it away.
class SteppedRun {
 public:
  explicit SteppedRun(RunRequest request);

  /// Returns the frame's number. Throws, as does everything here, while another thread steps. After
  /// Ctrl-C a step that takes long ends by itself, and `run` is busy until then.
  static int64_t step(const std::shared_ptr<SteppedRun>& run);
  void finish();
  int set_pose(uint32_t avatar, const ExternalPose& pose);
  bool is_external(uint32_t avatar) const { return simulation_->external_pose(avatar) != nullptr; }
  std::vector<uint8_t> saved();
  void resume(std::span<const uint8_t> state);

  /// The frame of that number; throws if the run has gone on.
  const Frame& frame(int64_t number) const;
  bool is_over() const { return end_.has_value(); }
  const std::vector<EventRow>& last_ends() const { return last_ends_; }

  const RunInfo& info() const { return simulation_->info(); }
  int64_t next_frame() const;
  /// How many the scene's duration has.
  int64_t frames() const;
  /// The margins of near rows, and whether there are contact points; see Scene.
  const Scene& scene() const { return simulation_->scene(); }
  bool has_postures() const { return request_.simulation.postures; }
  const std::vector<std::string>& notes() const { return notes_; }
  uint64_t hash() const;
  /// How long the library took for the last step, by the clock.
  double step_ms() const;

  FrameBuffer<double> positions;
  FrameBuffer<float> rotations, headings, speeds, postures;
  FrameBuffer<uint8_t> present;
  FrameBuffer<PairRow> pairs;
  FrameBuffer<EventRow> events;

 private:
  class Busy;
  void expect_idle() const;

  RunRequest request_;
  std::optional<Simulation> simulation_;
  std::vector<std::string> notes_;
  const Frame* frame_ = nullptr;
  std::optional<RunEnd> end_;
  std::vector<EventRow> last_ends_;
  double step_ms_ = 0;
  std::atomic<bool> is_busy_{false};
};

}  // namespace throng
