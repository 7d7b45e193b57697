#include "apps/output/unfinished.h"

#include <unistd.h>

#include <atomic>
#include <exception>
#include <future>
#include <memory>
#include <thread>
#include <utility>

#include "apps/process/stop_signal.h"

namespace throng {
namespace {

constexpr std::chrono::milliseconds kLookAround{20};
std::atomic<bool> g_work_was_left{false};

}  // namespace

bool done_before_a_signal(std::function<void()> work, std::chrono::milliseconds patience) {
  std::packaged_task<void()> task(std::move(work));
  std::future<void> result = task.get_future();
  std::thread worker(std::move(task));
  while (result.wait_for(kLookAround) != std::future_status::ready) {
    if (!StopSignal::requested()) continue;
    if (result.wait_for(patience) == std::future_status::ready) break;
    g_work_was_left = true;
    worker.detach();
    return false;
  }
  worker.join();
  result.get();
  return true;
}

void leave_unfinished_work(int exit_code) {
  // Destructors of what is static would pull the ground from under the thread.
  if (g_work_was_left) _exit(exit_code);
}

}  // namespace throng
