// core_count() is the default number of threads.
#pragma once

#include <algorithm>
#include <thread>

namespace throng {

/// Returns the number of processor cores, at least 1.
inline int core_count() {
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

}  // namespace throng
