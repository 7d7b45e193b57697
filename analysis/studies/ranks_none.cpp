// Ranks of a Throng without MPI.
#include "analysis/studies/ranks.h"
#include "base/errors.h"

namespace throng {

struct Ranks::State {};

Ranks::Ranks() {
  throw EnvironmentError(
      "mpirun: this throng was built without MPI (OpenMPI was not found, or -DTHRONG_MPI=OFF); "
      "use `throng study --shard I/N` to share a study without it");
}
Ranks::~Ranks() = default;
int Ranks::rank() const { return 0; }
int Ranks::count() const { return 1; }
void Ranks::wait_for_first() {}
void Ranks::run_leader(const LeaderCallbacks&) {}
void Ranks::run_follower(const std::function<std::optional<std::string>(size_t)>&) {}

}  // namespace throng
