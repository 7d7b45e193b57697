// Workers runs the blocks of a loop on a fixed number of threads.
// Invariant: results of a block must not depend on the worker that runs it or their number.
#pragma once

#include <functional>
#include <memory>

namespace throng {

class Workers {
 public:
  /// threads >= 1, the caller's thread included. With 1, everything runs inline.
  explicit Workers(int threads);
  ~Workers();
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  int threads() const { return threads_; }

  /// Calls body(block, worker) for every block in [0, blocks), worker in [0, threads()). Returns
  /// when all are done. Blocks are handed out one by one: make each worth about ten microseconds.
  template <typename Body>
  void for_blocks(int blocks, const Body& body) {
    if (threads_ == 1 || blocks <= 1) {
      for (int block = 0; block < blocks; ++block) body(block, 0);
      return;
    }
    run(blocks, std::cref(body));
  }

 private:
  void run(int blocks, const std::function<void(int, int)>& body);

  struct Arena;
  int threads_;
  std::unique_ptr<Arena> arena_;
};

}  // namespace throng
