// Long work with the interpreter free for others, which Ctrl-C ends within a fraction of a second.
// One rule: the work runs in a thread of its own and touches nothing of Python's; the caller's
// thread waits for it, lets signals in, and tells how far it is.
#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <functional>
#include <memory>

namespace throng {

/// What the two threads tell each other.
struct WorkSigns {
  std::atomic<bool> stop{false};   ///< the caller wants no more of it
  std::atomic<int64_t> done{0};    ///< frames
  std::atomic<int64_t> frames{0};  ///< in all; 0: not known yet
};

/// Calls `work` and returns when it has returned; rethrows what it throws. `progress` is called
/// with (done, frames) a few times a second, unless it is None. After a signal whose handler
/// raises, or where `progress` does, `signs.stop` is set; work that does not look at it (`looks` is
/// false) is left to end by itself, so it has to own all that it touches.
void run_apart(std::function<void(WorkSigns&)> work, const pybind11::object& progress, bool looks);

/// Waits for what was left to end: before the interpreter ends.
void join_left();

}  // namespace throng
