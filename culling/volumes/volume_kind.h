// VolumeKind names the bounding volumes of the paper.
#pragma once

#include <optional>
#include <string_view>

namespace throng {

/// World-axis kdopNN is refitted to the rotated volume. The paper's or-DOP, ordopNN, is fitted once
/// in the part's frame and rotates with it.
enum class VolumeKind {
  kSphere,
  kAabb,
  kObb,
  kKdop14,
  kKdop18,
  kKdop26,
  kOrdop14,
  kOrdop18,
  kOrdop26
};

inline constexpr VolumeKind kAllVolumes[] = {
    VolumeKind::kSphere,  VolumeKind::kAabb,    VolumeKind::kObb,
    VolumeKind::kKdop14,  VolumeKind::kKdop18,  VolumeKind::kKdop26,
    VolumeKind::kOrdop14, VolumeKind::kOrdop18, VolumeKind::kOrdop26};

/// "sphere", "aabb", "obb", "kdop14", ..., "ordop26".
std::string_view name_of(VolumeKind kind);
std::optional<VolumeKind> volume_of(std::string_view name);

}  // namespace throng
