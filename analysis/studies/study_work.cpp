#include "analysis/studies/study_work.h"

#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "scenes/run/body_tables.h"

namespace throng {

void carry_out_all(const StudyWork& work, int workers, int threads_each) {
  std::mutex mutex;
  std::atomic<bool> failed{false};
  std::exception_ptr failure;
  const auto tables = std::make_shared<BodyTables>();
  const auto keep_going = [&] { return !failed && work.keep_going(); };
  const auto carry_out_some = [&] {
    try {
      while (keep_going()) {
        std::optional<size_t> run;
        {
          const std::lock_guard lock(mutex);
          run = work.next();
        }
        if (!run) return;
        const std::optional<StudyRow> row =
            carry_out(work.plan, *run, threads_each, tables, keep_going);
        if (!row) return;
        const std::lock_guard lock(mutex);
        work.done(*row);
      }
    } catch (...) {
      const std::lock_guard lock(mutex);
      if (!failed.exchange(true)) failure = std::current_exception();
    }
  };
  std::vector<std::thread> others;
  for (int i = 1; i < workers; ++i) others.emplace_back(carry_out_some);
  carry_out_some();
  for (std::thread& other : others) other.join();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace throng
