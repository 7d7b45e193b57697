#include "apps/process/stop_signal.h"

#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdint>
#include <ctime>
#include <exception>
#include <future>
#include <initializer_list>
#include <memory>
#include <thread>
#include <utility>

#include "base/console.h"

namespace throng {
namespace {

// `timeout`, closing terminals and service managers send a signal twice within this time.
constexpr int64_t kRepeatWindow_ns = 500'000'000;

// The handler may run in any thread; sig_atomic_t is safe within one only.
std::atomic<bool> g_work_is_open{false};
std::atomic<int64_t> g_first_ns{0};
std::atomic<int> g_signal{0};
std::atomic<void (*)()> g_before_exit{nullptr};
static_assert(std::atomic<int64_t>::is_always_lock_free, "a handler must not wait");

int64_t now_ns() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return int64_t{1'000'000'000} * now.tv_sec + now.tv_nsec;
}

std::string_view name_of_signal(int signal) {
  switch (signal) {
    case SIGINT:
      return "SIGINT";
    case SIGTERM:
      return "SIGTERM";
    case SIGHUP:
      return "SIGHUP";
    default:
      return "";
  }
}

void handle(int signal) {
  if (g_work_is_open) {
    int64_t never = 0;
    const int64_t now = now_ns();
    if (g_first_ns.compare_exchange_strong(never, now)) {
      g_signal = signal;
      return;
    }
    if (now - never < kRepeatWindow_ns) return;
  }
  if (void (*const restore)() = g_before_exit) restore();
  print_in_signal_handler("throng: stopped by ");
  print_in_signal_handler(name_of_signal(signal));
  print_in_signal_handler("\n");
  _exit(128 + signal);
}

constexpr std::chrono::milliseconds kPollPeriod{20};
std::atomic<bool> g_work_was_abandoned{false};

}  // namespace

StopSignal::StopSignal() { g_work_is_open = true; }

StopSignal::~StopSignal() {
  flush_results();  // before signals end the process again
  g_work_is_open = false;
}

void StopSignal::install() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction before = {};
    sigaction(signal, nullptr, &before);
    // A shell without job control ignores SIGINT for background jobs. A script that sends one
    // means it, so only an ignored SIGHUP (nohup) stays ignored.
    if (signal == SIGHUP && before.sa_handler == SIG_IGN) continue;
    struct sigaction action = {};
    action.sa_handler = handle;
    action.sa_flags = SA_RESTART;
    sigemptyset(&action.sa_mask);
    sigaction(signal, &action, nullptr);
  }
}

void StopSignal::before_exit(void (*restore)()) { g_before_exit = restore; }

bool StopSignal::requested() { return g_signal != 0; }

int StopSignal::exit_code() { return requested() ? 128 + g_signal : 0; }

std::string_view StopSignal::name() { return name_of_signal(g_signal); }

bool finishes_before_signal(std::function<void()> work, std::chrono::milliseconds patience) {
  std::packaged_task<void()> task(std::move(work));
  std::future<void> result = task.get_future();
  std::thread worker(std::move(task));
  while (result.wait_for(kPollPeriod) != std::future_status::ready) {
    if (!StopSignal::requested()) continue;
    if (result.wait_for(patience) == std::future_status::ready) break;
    g_work_was_abandoned = true;
    worker.detach();
    return false;
  }
  worker.join();
  result.get();
  return true;
}

void abandon_unfinished_work(int exit_code) {
  // Destructors of static objects would destroy what the abandoned thread uses.
  if (g_work_was_abandoned) _exit(exit_code);
}

}  // namespace throng
