// Ranks connects the processes of an MPI job (`mpirun -n R throng study`); the first distributes
// the runs. It is the only interface to MPI, and has a substitute for builds without it.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace throng {

class Ranks {
 public:
  /// True if mpirun started this process as one of several.
  static bool are_launched();

  /// Initialises MPI. Throws EnvironmentError if Throng was built without it.
  Ranks();
  /// Finalises MPI, or ends all ranks during stack unwinding.
  ~Ranks();
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;

  int rank() const;
  int count() const;

  /// Blocks until the first rank calls it as well.
  void wait_for_first();

  /// Callbacks of the first rank, called on the thread of run_leader().
  struct LeaderCallbacks {
    std::function<std::optional<size_t>()> next;   ///< returns the next run, if any
    std::function<void(const std::string&)> take;  ///< receives a result
    /// Takes back a run whose rank left without a result.
    std::function<void(size_t)> return_run;
    std::function<bool()> is_busy;  ///< true while this rank works on runs itself
  };
  /// Distributes runs until all ranks have finished.
  void run_leader(const LeaderCallbacks& callbacks);
  /// Executes runs on the other ranks until `work` returns nothing.
  void run_follower(const std::function<std::optional<std::string>(size_t)>& work);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace throng
