#include "apps/process/standard_files.h"

#include <fcntl.h>
#include <unistd.h>

#include <initializer_list>

namespace throng {

void open_standard_files() {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(descriptor, F_GETFD) >= 0) continue;
    // open() gives the lowest free number, which is this one. Writing to a file that is open for
    // reading fails with "bad file descriptor", as writing to a closed one does.
    const int mode = descriptor == STDERR_FILENO ? O_WRONLY : O_RDONLY;
    [[maybe_unused]] const int opened = open("/dev/null", mode);
  }
}

}  // namespace throng
