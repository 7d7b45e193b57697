#include "culling/volumes/volume_kind.h"

#include <array>
#include <iterator>

namespace throng {
namespace {

constexpr std::array<std::string_view, 9> kNames = {
    "sphere", "aabb", "obb", "kdop14", "kdop18", "kdop26", "ordop14", "ordop18", "ordop26"};
static_assert(kNames.size() == std::size(kAllVolumes));

}  // namespace

std::string_view name_of(VolumeKind kind) { return kNames[static_cast<size_t>(kind)]; }

std::optional<VolumeKind> volume_of(std::string_view name) {
  for (size_t i = 0; i < kNames.size(); ++i)
    if (kNames[i] == name) return kAllVolumes[i];
  return std::nullopt;
}

}  // namespace throng
