// A small sound recording of every kind, as bytes: what fuzzers begin with.
// One rule: the same on every machine.
#pragma once

#include <string>
#include <vector>

namespace throng {

std::vector<std::string> recording_seeds();

}  // namespace throng
