// Counts the pair events of one run with generated LCM code only. Prints "begins N ends N" and
// exits with 0 if the counts equal those of THRONG_END.
#include <chrono>
#include <cstdio>
#include <lcm/lcm-cpp.hpp>

#include "throng/end_t.hpp"
#include "throng/events_t.hpp"

namespace {

struct Listener {
  long begins = 0, ends = 0;
  int64_t stated_begins = 0, stated_ends = 0;
  bool is_over = false;
};

void on_events(const lcm::ReceiveBuffer*, const std::string&, const throng::events_t* message,
               Listener* listener) {
  for (const uint8_t kind : message->kind) ++(kind == 0 ? listener->begins : listener->ends);
}

void on_end(const lcm::ReceiveBuffer*, const std::string&, const throng::end_t* message,
            Listener* listener) {
  listener->is_over = true;
  listener->stated_begins = message->begins;
  listener->stated_ends = message->ends;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return std::fprintf(stderr, "usage: lcm_listener URL\n"), 2;
  lcm::LCM lcm(argv[1]);
  if (!lcm.good()) return std::fprintf(stderr, "LCM cannot use %s\n", argv[1]), 3;
  Listener listener;
  lcm.subscribeFunction("THRONG_EVENTS", on_events, &listener)->setQueueCapacity(0);
  lcm.subscribeFunction("THRONG_END", on_end, &listener);
  std::printf("listening\n");
  std::fflush(stdout);
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(50);
  while (!listener.is_over && std::chrono::steady_clock::now() < deadline) lcm.handleTimeout(200);
  std::printf("begins %ld ends %ld\n", listener.begins, listener.ends);
  if (!listener.is_over) return std::fprintf(stderr, "no THRONG_END received\n"), 1;
  return listener.begins == listener.stated_begins && listener.ends == listener.stated_ends ? 0 : 1;
}
