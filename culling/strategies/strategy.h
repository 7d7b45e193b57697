// The recipes of the paper beside our own, by name.
// One rule: a strategy says which volumes are updated and which pairs are tested, nothing else.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace throng {

/// Suaib, Bade, Mohamad, TELKOMNIKA 11(6), 2013, section 4; bodies are its objects.
enum class Strategy {
  kPipeline,   ///< ours: pair search, boxes, part volume
  kNone,       ///< nothing is tested: the paper's control
  kSphere,     ///< spheres of bodies alone, every pair; reported as whole bodies
  kVolume,     ///< the part volume alone, every pair
  kHybridOne,  ///< sphere, then part volume, of the first body with all others
  kHybridAll,  ///< both volumes of everybody updated; sphere, then part volume, pair by pair
  kTwoPass     ///< spheres of all pairs first; part volumes of the survivors only ("Seq Sp-OrD")
};

inline constexpr Strategy kAllStrategies[] = {
    Strategy::kPipeline,  Strategy::kNone,      Strategy::kSphere, Strategy::kVolume,
    Strategy::kHybridOne, Strategy::kHybridAll, Strategy::kTwoPass};

/// "pipeline", "none", "sphere", "volume", "hybrid-one", "hybrid-all", "two-pass".
std::string_view name_of(Strategy strategy);
std::optional<Strategy> strategy_of(std::string_view name);
std::vector<std::string> strategy_names();

/// What touches and is not reported, in words; "" where nothing is left out.
std::string_view omitted_by(Strategy strategy);

}  // namespace throng
