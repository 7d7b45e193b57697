// Strategy names the pipeline of Throng and the strategies of the paper. A strategy selects the
// volumes to update and the pairs to test.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace throng {

/// Suaib, Bade, Mohamad, TELKOMNIKA 11(6), 2013, section 4. Bodies are the paper's objects.
enum class Strategy {
  kPipeline,   ///< Throng: pair search, boxes, part volumes
  kNone,       ///< no test: the paper's control
  kSphere,     ///< spheres of bodies only, all pairs; reported as whole bodies
  kVolume,     ///< part volumes only, all pairs
  kHybridOne,  ///< sphere, then part volume, of the first body with all others
  kHybridAll,  ///< both volumes of all bodies updated; sphere, then part volume, pair by pair
  kTwoPass     ///< spheres of all pairs first; part volumes of the survivors only ("Seq Sp-OrD")
};

inline constexpr Strategy kAllStrategies[] = {
    Strategy::kPipeline,  Strategy::kNone,      Strategy::kSphere, Strategy::kVolume,
    Strategy::kHybridOne, Strategy::kHybridAll, Strategy::kTwoPass};

/// "pipeline", "none", "sphere", "volume", "hybrid-one", "hybrid-all", "two-pass".
std::string_view name_of(Strategy strategy);
std::optional<Strategy> strategy_of(std::string_view name);
std::vector<std::string> strategy_names();

/// Contacts that the strategy does not report, as text; "": none omitted.
std::string_view omitted_by(Strategy strategy);

}  // namespace throng
