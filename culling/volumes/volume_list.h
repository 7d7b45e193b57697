// kVolumeList lists all volumes in the order of VolumeKind. Names, fits, the mid phase and the
// paper's strategies follow from it.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>
#include <tuple>
#include <utility>

#include "culling/volumes/aabb.h"
#include "culling/volumes/kdop.h"
#include "culling/volumes/obb.h"
#include "culling/volumes/ordop.h"
#include "culling/volumes/sphere.h"
#include "culling/volumes/volume_kind.h"
#include "culling/volumes/volumes.h"

namespace throng {

template <VolumeKind kVolume, BoundingVolume V>
struct VolumeEntry {
  static constexpr VolumeKind kKind = kVolume;
  using Volume = V;
  std::string_view name;
};

inline constexpr std::tuple kVolumeList = {VolumeEntry<VolumeKind::kSphere, Sphere>{"sphere"},
                                           VolumeEntry<VolumeKind::kAabb, Aabb>{"aabb"},
                                           VolumeEntry<VolumeKind::kObb, Obb>{"obb"},
                                           VolumeEntry<VolumeKind::kKdop14, Kdop<14>>{"kdop14"},
                                           VolumeEntry<VolumeKind::kKdop18, Kdop<18>>{"kdop18"},
                                           VolumeEntry<VolumeKind::kKdop26, Kdop<26>>{"kdop26"},
                                           VolumeEntry<VolumeKind::kOrdop14, Ordop<14>>{"ordop14"},
                                           VolumeEntry<VolumeKind::kOrdop18, Ordop<18>>{"ordop18"},
                                           VolumeEntry<VolumeKind::kOrdop26, Ordop<26>>{"ordop26"}};
inline constexpr size_t kVolumeCount = std::tuple_size_v<decltype(kVolumeList)>;

template <size_t kPlace>
using VolumeAt =
    typename std::tuple_element_t<kPlace, std::remove_const_t<decltype(kVolumeList)>>::Volume;

template <typename V>
inline constexpr size_t kVolumeIndex = [] {
  size_t place = kVolumeCount;
  [&]<size_t... kPlaces>(std::index_sequence<kPlaces...>) {
    ((std::is_same_v<V, VolumeAt<kPlaces>> ? void(place = kPlaces) : void()), ...);
  }
  (std::make_index_sequence<kVolumeCount>{});
  return place;
}();

/// Calls visit.operator()<V>(kind) for every class of the list.
template <typename Visit>
void for_each_volume(const Visit& visit) {
  [&]<size_t... kPlaces>(std::index_sequence<kPlaces...>) {
    (visit.template operator()<VolumeAt<kPlaces>>(kAllVolumes[kPlaces]), ...);
  }
  (std::make_index_sequence<kVolumeCount>{});
}

/// Calls visit.operator()<V>() for the class of a kind.
template <typename Visit>
void with_volume(VolumeKind kind, const Visit& visit) {
  for_each_volume([&]<typename V>(VolumeKind each) {
    if (each == kind) visit.template operator()<V>();
  });
}

}  // namespace throng
