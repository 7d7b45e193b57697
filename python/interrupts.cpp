#include "python/interrupts.h"

#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace py = pybind11;

namespace throng {
namespace {

/// Maximum time until a signal is handled.
constexpr auto kPatience = std::chrono::milliseconds(50);
/// Time to wait for abandoned work.
constexpr auto kAbandonWait = std::chrono::milliseconds(100);

struct Job {
  WorkState state;
  std::mutex mutex;
  std::condition_variable changed;
  bool is_over = false;
  std::exception_ptr failure;

  void run(std::function<void(WorkState&)>& work) {
    try {
      work(state);
    } catch (...) {
      failure = std::current_exception();
    }
    work = nullptr;  // destroys what it owns in this thread
    const std::lock_guard lock(mutex);
    is_over = true;
    changed.notify_all();
  }
  bool wait(std::chrono::milliseconds patience) {
    std::unique_lock lock(mutex);
    return changed.wait_for(lock, patience, [this] { return is_over; });
  }
};

struct AbandonedJob {
  std::shared_ptr<Job> job;
  std::thread thread;
};

/// Abandoned work, until the interpreter ends. Requires the interpreter's lock.
std::vector<AbandonedJob>& abandoned_jobs() {
  static std::vector<AbandonedJob> jobs;
  return jobs;
}

/// Exits without destructors of static objects, which a running thread may still use.
void leave_now(int exit_code, void*) {
  std::fflush(nullptr);
  _exit(exit_code);
}

/// Requires the interpreter's lock. Throws exceptions raised in Python.
void poll(const Job& job, const py::object& progress, int64_t& reported) {
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  const int64_t done = job.state.done;
  const int64_t frames = job.state.frames;
  if (progress.is_none() || frames == 0 || done == reported) return;
  progress(done, frames);
  reported = done;
}

}  // namespace

void run_in_thread(std::function<void(WorkState&)> work, const py::object& progress,
                   AbandonPolicy policy) {
  const auto job = std::make_shared<Job>();
  std::thread thread([job, work = std::move(work)]() mutable { job->run(work); });
  int64_t reported = -1;
  try {
    for (bool is_over = false; !is_over;) {
      {
        const py::gil_scoped_release others;
        is_over = job->wait(kPatience);
      }
      if (!is_over || !job->failure) poll(*job, progress, reported);
    }
  } catch (...) {
    job->state.stop = true;
    bool is_over = policy == AbandonPolicy::kStop;
    {
      const py::gil_scoped_release others;
      if (policy == AbandonPolicy::kJoinBriefly) is_over = job->wait(kAbandonWait);
      if (is_over) thread.join();
    }
    if (!is_over) abandoned_jobs().push_back({job, std::move(thread)});
    throw;
  }
  {
    const py::gil_scoped_release others;
    thread.join();
  }
  if (job->failure) std::rethrow_exception(job->failure);
}

void join_abandoned_jobs() {
  std::vector<AbandonedJob> jobs;
  jobs.swap(abandoned_jobs());
  const py::gil_scoped_release others;
  bool goes_on = false;
  for (AbandonedJob& each : jobs) {
    if (each.job->wait(goes_on ? std::chrono::milliseconds(0) : kAbandonWait)) {
      each.thread.join();
    } else {
      each.thread.detach();
      goes_on = true;
    }
  }
  if (goes_on) on_exit(leave_now, nullptr);
}

}  // namespace throng
