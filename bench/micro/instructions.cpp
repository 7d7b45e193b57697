#include "bench/micro/instructions.h"

#include <linux/perf_event.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace throng::bench {
namespace {

int open_counter() {
  perf_event_attr attributes{};
  attributes.type = PERF_TYPE_HARDWARE;
  attributes.size = sizeof attributes;
  attributes.config = PERF_COUNT_HW_INSTRUCTIONS;
  attributes.exclude_kernel = 1;
  attributes.exclude_hv = 1;
  // This thread, any core, no group, no flags: counts from here on.
  return static_cast<int>(syscall(SYS_perf_event_open, &attributes, 0, -1, -1, 0));
}

}  // namespace

CountInstructions::CountInstructions(benchmark::State& state, int64_t items)
    : state_(state), items_(items), counter_(open_counter()) {}

CountInstructions::~CountInstructions() {
  if (counter_ < 0) return;
  uint64_t count = 0;
  const bool known = read(counter_, &count, sizeof count) == sizeof count && count > 0;
  close(counter_);
  const double items = static_cast<double>(state_.iterations()) * static_cast<double>(items_);
  if (known && items > 0) state_.counters["instructions"] = static_cast<double>(count) / items;
}

}  // namespace throng::bench
