// The engines that this binary can be compared with.
// One rule: an engine that is not built in is named with the reason, never left out in silence.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/engines/engine.h"

namespace throng::bench {

struct EngineKind {
  std::string_view name;  ///< as given to --engines
  /// Null if it is not built in. `threads` is what the engine may use, if it can use more than one.
  std::unique_ptr<Engine> (*make)(int threads);
  std::string_view missing;  ///< why it is not built in
};

/// Every engine we know of, built in or not.
std::span<const EngineKind> engine_kinds();

}  // namespace throng::bench
