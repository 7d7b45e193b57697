// Counts every operator new of the process; link allocation_counter.cpp into a test that asks.
// Only the tests that count have it, because it replaces the global operators.
#pragma once

#include <cstddef>

namespace throng::test {

size_t allocations_so_far();

}  // namespace throng::test
