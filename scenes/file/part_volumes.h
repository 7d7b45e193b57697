// PartVolumes selects the bounding volume of each part: one for all, or several by words of part
// names.
// Invariant: the text form is one line, "hands: sphere, torso: ordop18, default: ordop26", in
// scenes, options and logs.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "culling/volumes/volume_kind.h"

namespace throng {

struct Model;

struct PartVolumes {
  /// Matches every part whose name has all of these words: "hands" matches leftHand and right_hand.
  struct Named {
    std::string words;
    VolumeKind volume = VolumeKind::kOrdop26;
    bool operator==(const Named&) const = default;
  };

  PartVolumes() = default;
  PartVolumes(VolumeKind all) : fallback(all) {}  // NOLINT(google-explicit-constructor): one of all

  /// Volume of a part by its name: of the first match, or the fallback.
  VolumeKind of(std::string_view part) const;
  bool operator==(const PartVolumes&) const = default;

  VolumeKind fallback = VolumeKind::kOrdop26;
  std::vector<Named> named;
};

std::string to_text(const PartVolumes& volumes);
/// Parses the text form. Throws InputError at `where`.
PartVolumes part_volumes_of(std::string_view text, std::string_view where);

/// Adds a volume for parts with these words; "default" sets the fallback. Throws InputError.
void add_part_volume(std::string_view words, std::string_view volume, std::string_view where,
                     PartVolumes& volumes);

/// Throws InputError if words match no part.
void require_parts(const PartVolumes& volumes,
                   std::span<const std::shared_ptr<const Model>> models);

void require_parts(const PartVolumes& volumes, std::vector<std::string> part_names);

std::vector<std::string> volume_names();

}  // namespace throng
