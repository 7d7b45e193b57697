// Message of an expected error.
#pragma once

#include <string>

#include "base/errors.h"

namespace throng::test {

/// Message of the InputError that a function throws, or "" if it throws none.
template <typename Function>
std::string error_of(const Function& function) {
  try {
    function();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace throng::test
