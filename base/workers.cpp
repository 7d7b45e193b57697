#include "base/workers.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

#include <cassert>

#ifdef THRONG_TELLS_TSAN
#include <sanitizer/tsan_interface.h>
#endif

namespace throng {
namespace {

/// Orders work before pass_on() before work after its take-over, for the thread sanitizer only:
/// oneTBB guarantees it, but the sanitizer cannot see into a library that it did not compile.
class Handover {
 public:
#ifdef THRONG_TELLS_TSAN
  void pass_on() { __tsan_release(this); }
  void take_over() { __tsan_acquire(this); }

 private:
  char address_ = 0;
#else
  void pass_on() {}
  void take_over() {}
#endif
};

}  // namespace

struct Workers::Arena {
  explicit Arena(int threads)
      // oneTBB starts no more threads than cores by default; a determinism test needs eight on two
      // cores.
      : limit(tbb::global_control::max_allowed_parallelism, static_cast<size_t>(threads)),
        arena(threads) {}
  tbb::global_control limit;
  tbb::task_arena arena;
};

Workers::Workers(int threads) : threads_(threads) {
  assert(threads >= 1);
  if (threads > 1) arena_ = std::make_unique<Arena>(threads);
}

Workers::~Workers() = default;

void Workers::run(int blocks, const std::function<void(int, int)>& body) {
  Handover begun, done;
  begun.pass_on();
  arena_->arena.execute([&] {
    tbb::parallel_for(
        tbb::blocked_range<int>(0, blocks, 1),
        [&](const tbb::blocked_range<int>& range) {
          begun.take_over();
          const int worker = tbb::this_task_arena::current_thread_index();
          for (int block = range.begin(); block < range.end(); ++block) body(block, worker);
          done.pass_on();
        },
        tbb::simple_partitioner());
  });
  done.take_over();
}

}  // namespace throng
