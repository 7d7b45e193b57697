// What a run is called and consists of, as dictionaries and arrays of Python.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>

#include "python/recorder.h"

namespace throng {

/// As `throng run` prints hashes.
std::string hash_text(uint64_t hash);

pybind11::dict dict_of(RunFacts facts);

/// events, trajectories and counters as arrays, contacts when they are asked for.
void add_rows(pybind11::dict& out, RunRecorder& recorder, double step_s);

}  // namespace throng
