#include "apps/stop_signal.h"

#include <atomic>
#include <csignal>

namespace throng {
namespace {

// The system gives the signal to any thread; a sig_atomic_t is safe within one only.
std::atomic<bool> g_requested{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a handler must not wait");

void handle(int) { g_requested = true; }

void install(void (*handler)(int)) {
  struct sigaction action = {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESETHAND;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

}  // namespace

StopSignal::StopSignal() {
  g_requested = false;
  install(handle);
}

StopSignal::~StopSignal() { install(SIG_DFL); }

bool StopSignal::requested() { return g_requested; }

}  // namespace throng
