#include <cstdlib>
#include <string>

#include "analysis/studies/ranks.h"

namespace throng {

bool Ranks::are_launched() {
  // Open MPI; MPICH and its derivatives.
  for (const char* variable : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"})
    if (const char* size = std::getenv(variable); size != nullptr && std::atoi(size) > 1)
      return true;
  return false;
}

}  // namespace throng
