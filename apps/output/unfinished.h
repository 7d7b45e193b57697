// Work that a signal leaves where it is: measurements, whose inner loops ask nobody.
// One rule: what was finished is reported, the rest is never touched again; the process ends
// without waiting for it.
#pragma once

#include <chrono>
#include <functional>

namespace throng {

/// Runs `work` on a thread of its own and waits for it, or for a signal (a StopSignal lives). True:
/// it is done; what it threw is thrown here. False: a signal came first, and `work` goes on until
/// the process ends, so that it must own, or share, all that it uses.
///
/// `patience`: for work that looks for the signal itself and ends soon after it.
bool done_before_a_signal(std::function<void()> work, std::chrono::milliseconds patience = {});

/// At the very end of main(): ends the process here if work was left.
void leave_unfinished_work(int exit_code);

}  // namespace throng
