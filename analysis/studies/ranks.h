// The processes of an MPI job, which `mpirun -n R throng study` starts: the first hands out runs.
// One rule: this header alone stands for MPI; a Throng that was built without it says so.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace throng {

class Ranks {
 public:
  /// Whether this process is one of several that mpirun started.
  static bool are_launched();

  /// Throws EnvironmentError if Throng was built without MPI.
  Ranks();
  /// Ends all ranks if an exception is on its way.
  ~Ranks();
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;

  int rank() const;
  int count() const;

  /// Each rank waits here until the first is here, too.
  void wait_for_first();

  /// What the first rank does with the others. All are called on this thread.
  struct LeaderCallbacks {
    std::function<std::optional<size_t>()> next;   ///< a number to work on
    std::function<void(const std::string&)> take;  ///< what came of one
    std::function<void(size_t)> return_run;        ///< somebody left without a result
    std::function<bool()> is_busy;                 ///< this rank still works itself
  };
  /// Until nobody works any more.
  void run_leader(const LeaderCallbacks& callbacks);
  /// What the others do: nothing from `work` means that this rank leaves.
  void run_follower(const std::function<std::optional<std::string>(size_t)>& work);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace throng
