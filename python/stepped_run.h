// SteppedRun is a simulation that advances step by step, with its latest frame as arrays.
// Invariant: an array keeps its values while a Python object holds it; its buffer is filled on
// first use and reused only when unreferenced.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "python/arrays.h"
#include "python/rows.h"
#include "python/run_files.h"
#include "python/run_request.h"
#include "scenes/run/simulation.h"

namespace throng {

template <typename T>
class FrameBuffer {
 public:
  /// Returns an array of the values that `fill` writes into a vector, once per frame; `width`
  /// numbers per row, 0 for one dimension.
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

/// All functions require the interpreter's lock; long ones release it.
class SteppedRun {
 public:
  explicit SteppedRun(RunRequest request);
  /// Completes files, without reporting errors.
  ~SteppedRun();

  /// Advances one frame and returns its number. Throws, like all functions, while another thread
  /// steps. After Ctrl-C a long step completes alone, and `run` is busy until then.
  static int64_t step(const std::shared_ptr<SteppedRun>& run);
  void finish();
  /// The simulation between two steps.
  Simulation& simulation() {
    expect_idle();
    return *simulation_;
  }
  std::vector<uint8_t> saved();
  void resume(std::span<const uint8_t> state);

  /// See Simulation::distance().
  PartDistance distance(uint32_t a, const PartChoice& part_a, uint32_t b,
                        const PartChoice& part_b) const {
    return simulation_->distance(a, part_a, b, part_b);
  }

  /// Returns the frame with that number; throws if it is not the latest.
  const Frame& frame(int64_t number) const;
  bool is_over() const { return end_.has_value(); }
  const std::vector<EventRow>& last_ends() const { return last_ends_; }

  const RunInfo& info() const { return simulation_->info(); }
  int64_t next_frame() const;
  int64_t frames() const;
  /// The scene, with margins and contact_points; see Scene.
  const Scene& scene() const { return simulation_->scene(); }
  bool has_postures() const { return request_.simulation.postures; }
  const std::vector<std::string>& notes() const { return notes_; }
  bool writes_files() const { return throng::writes_files(request_); }
  uint64_t hash() const;
  /// Wall time of the last step in the library, in ms.
  double step_ms() const;

  FrameBuffer<double> positions;
  FrameBuffer<float> rotations, headings, speeds, postures;
  FrameBuffer<uint8_t> present;
  FrameBuffer<PairRow> pairs;
  FrameBuffer<EventRow> events;

 private:
  class Busy;
  void expect_idle() const;

  void open_files();
  void write(const Frame& frame);
  void close_files();

  RunRequest request_;
  std::optional<Simulation> simulation_;
  std::optional<RunFiles> files_;  ///< from the first step on, if files are requested
  std::vector<std::string> notes_;
  const Frame* frame_ = nullptr;
  std::optional<RunEnd> end_;
  std::vector<EventRow> last_ends_;
  double step_ms_ = 0;
  std::atomic<bool> is_busy_{false};
};

}  // namespace throng
