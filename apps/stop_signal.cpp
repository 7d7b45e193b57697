#include "apps/stop_signal.h"

#include <csignal>

namespace throng {
namespace {

volatile std::sig_atomic_t g_requested = 0;

void handle(int) { g_requested = 1; }

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
  g_requested = 0;
  install(handle);
}

StopSignal::~StopSignal() { install(SIG_DFL); }

bool StopSignal::requested() { return g_requested != 0; }

}  // namespace throng
