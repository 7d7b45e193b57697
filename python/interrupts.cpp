#include "python/interrupts.h"

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace py = pybind11;

namespace throng {
namespace {

/// Until a signal is seen, at most.
constexpr auto kPatience = std::chrono::milliseconds(50);

struct Job {
  WorkSigns signs;
  std::mutex mutex;
  std::condition_variable changed;
  bool is_over = false;
  std::exception_ptr failure;

  void run(std::function<void(WorkSigns&)>& work) {
    try {
      work(signs);
    } catch (...) {
      failure = std::current_exception();
    }
    work = nullptr;  // what it owns goes in this thread
    const std::lock_guard lock(mutex);
    is_over = true;
    changed.notify_all();
  }
  bool wait() {
    std::unique_lock lock(mutex);
    return changed.wait_for(lock, kPatience, [this] { return is_over; });
  }
};

/// Those who have been left, until the interpreter ends. With the interpreter's lock held.
std::vector<std::thread>& left() {
  static std::vector<std::thread> threads;
  return threads;
}

/// With the interpreter's lock held. Throws what Python raised.
void look_up(const Job& job, const py::object& progress, int64_t& told) {
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  const int64_t done = job.signs.done;
  const int64_t frames = job.signs.frames;
  if (progress.is_none() || frames == 0 || done == told) return;
  progress(done, frames);
  told = done;
}

}  // namespace

void run_apart(std::function<void(WorkSigns&)> work, const py::object& progress, bool looks) {
  const auto job = std::make_shared<Job>();
  std::thread thread([job, work = std::move(work)]() mutable { job->run(work); });
  int64_t told = -1;
  try {
    for (bool is_over = false; !is_over;) {
      {
        const py::gil_scoped_release others;
        is_over = job->wait();
      }
      if (!is_over || !job->failure) look_up(*job, progress, told);
    }
  } catch (...) {
    job->signs.stop = true;
    if (looks) {
      const py::gil_scoped_release others;
      thread.join();
    } else {
      left().push_back(std::move(thread));
    }
    throw;
  }
  {
    const py::gil_scoped_release others;
    thread.join();
  }
  if (job->failure) std::rethrow_exception(job->failure);
}

void join_left() {
  std::vector<std::thread> threads;
  threads.swap(left());
  const py::gil_scoped_release others;
  for (std::thread& thread : threads) thread.join();
}

}  // namespace throng
