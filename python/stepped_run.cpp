#include "python/stepped_run.h"

#include <fmt/format.h>

#include <chrono>
#include <exception>
#include <functional>
#include <stdexcept>

#include "base/errors.h"
#include "python/interrupts.h"
#include "scenes/run/checkpoint.h"
#include "scenes/run/runner.h"

namespace py = pybind11;

namespace throng {

/// Marks the run as busy while the interpreter's lock is released.
class SteppedRun::Busy {
 public:
  explicit Busy(std::shared_ptr<SteppedRun> run) : run_(std::move(run)) { run_->is_busy_ = true; }
  ~Busy() { run_->is_busy_ = false; }
  Busy(const Busy&) = delete;
  Busy& operator=(const Busy&) = delete;

  int64_t step() {
    run_->frame_ = nullptr;
    const auto start = std::chrono::steady_clock::now();
    if (run_->writes_files() && !run_->files_) run_->open_files();
    run_->frame_ = &run_->simulation_->step();
    if (run_->files_) run_->write(*run_->frame_);
    run_->step_ms_ =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    return run_->frame_->number;
  }

 private:
  std::shared_ptr<SteppedRun> run_;
};

SteppedRun::SteppedRun(RunRequest request) : request_(std::move(request)) {
  RunSource source = open_source(request_);
  notes_ = std::move(source.notes);
  SimulationOptions options = request_.simulation;
  options.motion = std::move(source.motion);
  check_files(request_, source.scene);
  if (throng::writes_files(request_)) options.postures = true;
  simulation_.emplace(std::move(source.scene), options);
  notes_.insert(notes_.end(), simulation_->notes().begin(), simulation_->notes().end());
}

SteppedRun::~SteppedRun() {
  try {
    if (files_ && !end_) finish();
  } catch (const std::exception&) {  // finish() reports it to callers
  }
}

/// If it throws, the next step tries again.
void SteppedRun::open_files() {
  try {
    files_.emplace(request_, *simulation_);
    for (Sink* sink : files_->sinks()) sink->begin(simulation_->info());
  } catch (...) {
    files_.reset();
    throw;
  }
}

/// If it throws, the files end here.
void SteppedRun::write(const Frame& frame) {
  try {
    for (Sink* sink : files_->sinks()) sink->frame(simulation_->info(), frame);
  } catch (...) {
    files_.reset();
    request_.forget_files();
    throw;
  }
}

/// Completes every file, then throws the first error.
void SteppedRun::close_files() {
  std::exception_ptr error;
  for (Sink* sink : files_->sinks()) {
    try {
      sink->end(simulation_->info(), *end_);
    } catch (...) {
      if (!error) error = std::current_exception();
    }
  }
  files_.reset();
  if (error) std::rethrow_exception(error);
}

void SteppedRun::expect_idle() const {
  if (is_busy_)
    throw std::runtime_error(
        "a step of this simulation is still running, in another thread or interrupted; use one "
        "thread at a time");
}

int64_t SteppedRun::step(const std::shared_ptr<SteppedRun>& run) {
  run->expect_idle();
  if (run->end_) throw std::runtime_error("this simulation is finished; no step can follow");
  auto busy = std::make_shared<Busy>(run);
  // Set within the step, because the next one may begin directly after it.
  const auto number = std::make_shared<int64_t>(-1);
  constexpr double kShort_ms = 5;  // the next step takes about as long as the last
  const bool is_short = run->frame_ != nullptr && run->step_ms_ < kShort_ms;
  std::function<void(WorkState&)> work = [busy_run = std::move(busy), number](WorkState&) {
    *number = busy_run->step();
  };
  if (is_short)
    run_inline(work);
  else
    run_in_thread(std::move(work), py::none(), AbandonPolicy::kJoinBriefly);
  return *number;
}

void SteppedRun::finish() {
  expect_idle();
  if (end_) return;
  end_ = simulation_->finish();
  for (const PairEvent& event : end_->events) last_ends_.push_back(event_row(end_->frames, event));
  frame_ = nullptr;
  if (files_) close_files();
}

std::vector<uint8_t> SteppedRun::saved() {
  expect_idle();
  if (end_) throw std::runtime_error("this simulation is already finished");
  return format_checkpoint(checkpoint_of(*simulation_));
}

void SteppedRun::resume(std::span<const uint8_t> state) {
  expect_idle();
  if (simulation_->next_frame() != 0)
    throw std::runtime_error("a simulation can resume only before its first step");
  const Checkpoint checkpoint = parse_checkpoint(state, "state");
  const bool is_same_run = checkpoint.run_id == simulation_->info().run_id;
  if (is_same_run && checkpoint.next_frame > frames())
    throw InputError("state", fmt::format("a state of a run of {} frames", frames()),
                     fmt::format("one after {} frames; increase seconds", checkpoint.next_frame));
  throng::resume(*simulation_, checkpoint, "state");
}

const Frame& SteppedRun::frame(int64_t number) const {
  expect_idle();
  if (frame_ == nullptr || frame_->number != number)
    throw std::runtime_error(
        fmt::format("frame {} is not the latest frame; arrays that were read from it "
                    "remain valid",
                    number));
  return *frame_;
}

int64_t SteppedRun::next_frame() const {
  expect_idle();
  return simulation_->next_frame();
}

double SteppedRun::step_ms() const {
  expect_idle();
  return step_ms_;
}

int64_t SteppedRun::frames() const {
  return frame_count(simulation_->scene().duration_s, simulation_->info().step_s);
}

uint64_t SteppedRun::hash() const {
  expect_idle();
  if (end_) return end_->hash;
  return frame_ == nullptr ? 0 : frame_->hash;
}

}  // namespace throng
