// Long work with the interpreter free for others, which Ctrl-C ends within a fraction of a second.
// One rule: the work runs in a thread of its own and touches nothing of Python's; the caller's
// thread waits for it, lets signals in, and tells how far it is.
#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <functional>
#include <memory>
#include <optional>

namespace throng {

/// What the two threads tell each other.
struct WorkState {
  std::atomic<bool> stop{false};   ///< the caller wants no more of it
  std::atomic<int64_t> done{0};    ///< frames
  std::atomic<int64_t> frames{0};  ///< in all; 0: not known yet
};

/// What becomes of work that is not over when nobody wants it any more.
enum class AbandonPolicy {
  kStop,         ///< it looks at `signs.stop` often, and is waited for
  kJoinBriefly,  ///< it is waited for a moment: a frame is over by then, or ends by itself
  kDetach        ///< it ends by itself
};

/// Calls `work` and returns when it has returned; rethrows what it throws. `progress` is called
/// with (done, frames) a few times a second, unless it is None. After a signal whose handler
/// raises, or where `progress` does, `signs.stop` is set. Work that may end by itself has to own
/// all that it touches.
void run_in_thread(std::function<void(WorkState&)> work, const pybind11::object& progress,
                   AbandonPolicy policy);

/// The same within the caller's thread: for work that is over before anybody could want to stop it.
/// The other thread costs some ten microseconds, and the caches of its processor.
template <typename Work>
void run_inline(const Work& work) {
  WorkState state;
  const pybind11::gil_scoped_release others;
  work(state);
}

/// The same for work of one result that nobody can stop half-way, but anybody may stop waiting for.
template <typename Result, typename Work>
Result result_from_thread(const Work& work) {
  const auto made = std::make_shared<std::optional<Result>>();
  run_in_thread([made, work](WorkState&) { made->emplace(work()); }, pybind11::none(),
                AbandonPolicy::kDetach);
  return std::move(**made);
}

/// Before the interpreter ends: waits a moment for what was left to end. Where that goes on, the
/// process ends without it once Python has.
void join_abandoned_jobs();

}  // namespace throng
