#include "culling/volumes/volume_kind.h"

#include <array>
#include <iterator>

#include "culling/volumes/volume_list.h"

namespace throng {
namespace {

constexpr auto kNames =
    std::apply([](const auto&... entries) { return std::array{entries.name...}; }, kVolumeList);
constexpr auto kKinds = std::apply(
    [](const auto&... entries) { return std::array{std::decay_t<decltype(entries)>::kKind...}; },
    kVolumeList);

constexpr bool are_in_order() {
  for (size_t i = 0; i < kKinds.size(); ++i)
    if (static_cast<size_t>(kKinds[i]) != i || kAllVolumes[i] != kKinds[i]) return false;
  return kKinds.size() == std::size(kAllVolumes);
}
static_assert(are_in_order());

}  // namespace

std::string_view name_of(VolumeKind kind) { return kNames[static_cast<size_t>(kind)]; }

std::optional<VolumeKind> volume_of(std::string_view name) {
  for (size_t i = 0; i < kNames.size(); ++i)
    if (kNames[i] == name) return kAllVolumes[i];
  return std::nullopt;
}

}  // namespace throng
