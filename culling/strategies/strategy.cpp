#include "culling/strategies/strategy.h"

#include <array>
#include <iterator>

namespace throng {
namespace {

constexpr std::array<std::string_view, 7> kNames = {"pipeline",   "none",       "sphere",  "volume",
                                                    "hybrid-one", "hybrid-all", "two-pass"};
static_assert(kNames.size() == std::size(kAllStrategies));

}  // namespace

std::string_view name_of(Strategy strategy) { return kNames[static_cast<size_t>(strategy)]; }

std::optional<Strategy> strategy_of(std::string_view name) {
  for (size_t i = 0; i < kNames.size(); ++i)
    if (kNames[i] == name) return kAllStrategies[i];
  return std::nullopt;
}

std::vector<std::string> strategy_names() { return {kNames.begin(), kNames.end()}; }

std::string_view omitted_by(Strategy strategy) {
  switch (strategy) {
    case Strategy::kNone:
      return "every contact: nothing was tested";
    case Strategy::kSphere:
      return "body parts: a pair is two whole bodies whose spheres meet";
    case Strategy::kHybridOne:
      return "every contact but those of the first body";
    case Strategy::kPipeline:
    case Strategy::kVolume:
    case Strategy::kHybridAll:
    case Strategy::kTwoPass:
      break;
  }
  return "";
}

}  // namespace throng
