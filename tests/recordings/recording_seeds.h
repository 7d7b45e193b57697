// Small valid recordings of every kind, seeds for fuzzers. Equal on every machine.
#pragma once

#include <string>
#include <vector>

namespace throng {

std::vector<std::string> recording_seeds();

}  // namespace throng
