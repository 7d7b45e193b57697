// Which Throng wrote a result for machines.
// One rule: every JSON of the command has it, under the key "throng".
#pragma once

#include <nlohmann/json.hpp>

#include "base/version.h"

namespace throng {

/// {"version": "0.1.0", "commit": "1234567890ab"}
inline nlohmann::ordered_json version_json() {
  return {{"version", std::string(version())}, {"commit", std::string(commit())}};
}

}  // namespace throng
