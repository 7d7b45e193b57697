// version_json() states which Throng wrote a result.
// Invariant: every JSON of the command has it under the key "throng".
#pragma once

#include <nlohmann/json.hpp>

#include "base/version.h"

namespace throng {

/// Returns {"version": "0.9.0", "commit": "1234567890ab"}.
inline nlohmann::ordered_json version_json() {
  return {{"version", std::string(version())}, {"commit", std::string(commit())}};
}

}  // namespace throng
