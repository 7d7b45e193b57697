#include <mpi.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <thread>
#include <vector>

#include "analysis/studies/ranks.h"

namespace throng {
namespace {

constexpr int kFirst = 0;
enum Tag { kResult = 1, kLeave = 2, kWork = 3 };
constexpr int64_t kNoMore = -1;
/// Polling leaves the cores to ranks that work; a blocking MPI call would spin.
constexpr std::chrono::milliseconds kPollPeriod{2};

MPI_Status wait_for_message(int source) {
  for (;;) {
    int there = 0;
    MPI_Status status;
    MPI_Iprobe(source, MPI_ANY_TAG, MPI_COMM_WORLD, &there, &status);
    if (there != 0) return status;
    std::this_thread::sleep_for(kPollPeriod);
  }
}

}  // namespace

struct Ranks::State {
  int rank = 0;
  int count = 1;
  int exceptions = std::uncaught_exceptions();
};

Ranks::Ranks() : state_(std::make_unique<State>()) {
  // FUNNELED: only one thread per rank calls MPI.
  int provided = 0;
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
  MPI_Comm_rank(MPI_COMM_WORLD, &state_->rank);
  MPI_Comm_size(MPI_COMM_WORLD, &state_->count);
}

Ranks::~Ranks() {
  // Without MPI_Finalize, mpirun ends the other ranks once this one has printed its error.
  if (std::uncaught_exceptions() > state_->exceptions) return;
  MPI_Finalize();
}

int Ranks::rank() const { return state_->rank; }
int Ranks::count() const { return state_->count; }

void Ranks::wait_for_first() {
  int64_t here = 0;
  if (state_->rank == kFirst) {
    for (int other = 1; other < state_->count; ++other)
      MPI_Send(&here, 1, MPI_INT64_T, other, kWork, MPI_COMM_WORLD);
    return;
  }
  wait_for_message(kFirst);
  MPI_Recv(&here, 1, MPI_INT64_T, kFirst, kWork, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
}

void Ranks::run_leader(const LeaderCallbacks& callbacks) {
  std::vector<int64_t> at_work(static_cast<size_t>(state_->count), kNoMore);
  int others = state_->count - 1;
  while (others > 0 || callbacks.is_busy()) {
    int there = 0;
    MPI_Status status;
    MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &there, &status);
    if (there == 0) {
      std::this_thread::sleep_for(kPollPeriod);
      continue;
    }
    int bytes = 0;
    MPI_Get_count(&status, MPI_CHAR, &bytes);
    std::string result(static_cast<size_t>(bytes), '\0');
    const int from = status.MPI_SOURCE;
    MPI_Recv(result.data(), bytes, MPI_CHAR, from, status.MPI_TAG, MPI_COMM_WORLD,
             MPI_STATUS_IGNORE);
    int64_t& its = at_work[static_cast<size_t>(from)];
    if (status.MPI_TAG == kLeave) {
      if (its != kNoMore) callbacks.return_run(static_cast<size_t>(its));
      --others;
      continue;
    }
    if (!result.empty()) callbacks.take(result);
    const std::optional<size_t> next = callbacks.next();
    its = next ? static_cast<int64_t>(*next) : kNoMore;
    if (!next) --others;
    MPI_Send(&its, 1, MPI_INT64_T, from, kWork, MPI_COMM_WORLD);
  }
}

void Ranks::run_follower(const std::function<std::optional<std::string>(size_t)>& work) {
  std::string result;
  for (;;) {
    MPI_Send(result.data(), static_cast<int>(result.size()), MPI_CHAR, kFirst, kResult,
             MPI_COMM_WORLD);
    wait_for_message(kFirst);
    int64_t run = kNoMore;
    MPI_Recv(&run, 1, MPI_INT64_T, kFirst, kWork, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    if (run == kNoMore) return;
    const std::optional<std::string> done = work(static_cast<size_t>(run));
    if (!done) {
      MPI_Send(nullptr, 0, MPI_CHAR, kFirst, kLeave, MPI_COMM_WORLD);
      return;
    }
    result = *done;
  }
}

}  // namespace throng
