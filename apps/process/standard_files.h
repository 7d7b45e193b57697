// Standard input, output and error that were closed when the program started.
// One rule: 0, 1 and 2 are taken before anything is opened, so that no log or picture gets the
// number of stderr and every note that is said.
#pragma once

namespace throng {

/// The first thing in main(). A closed stdin then reads as empty; what is said to a closed stderr
/// goes nowhere; what is shown on a closed stdout fails as it would have: somebody wanted to read
/// it.
void open_standard_files();

}  // namespace throng
