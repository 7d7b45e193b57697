// Interrupts runs long work without the interpreter's lock; Ctrl-C ends the wait within a fraction
// of a second.
// Invariant: the work runs in its own thread and uses no Python objects; the caller's thread waits
// for it, handles signals and reports progress.
#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <functional>
#include <memory>
#include <optional>

namespace throng {

struct WorkState {
  std::atomic<bool> stop{false};
  std::atomic<int64_t> done{0};
  std::atomic<int64_t> frames{0};  ///< frames in all; 0: unknown
};

/// What to do with unfinished work that the caller abandons.
enum class AbandonPolicy {
  kStop,         ///< wait for it; it checks `stop` often
  kJoinBriefly,  ///< wait briefly: it completes its frame, or continues alone
  kDetach        ///< it continues alone
};

/// Runs `work`, returns when it has returned, and rethrows its exceptions. Calls `progress` with
/// (done, frames) a few times per second, unless it is None. Sets `stop` if a signal handler or
/// `progress` raises. Work that may continue alone must own all data it uses.
void run_in_thread(std::function<void(WorkState&)> work, const pybind11::object& progress,
                   AbandonPolicy policy);

/// Runs work in the caller's thread, for work too short to be interrupted. Another thread would
/// cost some ten microseconds, and cold caches.
template <typename Work>
void run_inline(const Work& work) {
  WorkState state;
  const pybind11::gil_scoped_release others;
  work(state);
}

/// Runs work with one result that cannot be stopped; the caller may stop waiting for it.
template <typename Result, typename Work>
Result result_from_thread(const Work& work) {
  const auto made = std::make_shared<std::optional<Result>>();
  run_in_thread([made, work](WorkState&) { made->emplace(work()); }, pybind11::none(),
                AbandonPolicy::kDetach);
  return std::move(**made);
}

/// Waits briefly for abandoned work before the interpreter ends. If some continues, the process
/// exits directly after Python's shutdown.
void join_abandoned_jobs();

}  // namespace throng
