// What encloses the parts of bodies: one volume, or others for parts that are named by words.
// One rule: as text it is one line, "hands: sphere, torso: ordop18, default: ordop26", the same in
// scenes, on the command line and in logs.
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
  /// Takes every part whose name has all of these words: "hands" takes leftHand and right_hand.
  struct Named {
    std::string words;
    VolumeKind volume = VolumeKind::kOrdop26;
    bool operator==(const Named&) const = default;
  };

  PartVolumes() = default;
  PartVolumes(VolumeKind all) : fallback(all) {}  // NOLINT(google-explicit-constructor): one of all

  /// Of a part by its name: the first that takes it, or the fallback.
  VolumeKind of(std::string_view part) const;
  bool operator==(const PartVolumes&) const = default;

  VolumeKind fallback = VolumeKind::kOrdop26;
  std::vector<Named> named;
};

/// "ordop26", or "hands: sphere, default: ordop26".
std::string to_text(const PartVolumes& volumes);
/// Throws InputError, which begins with `where`.
PartVolumes part_volumes_of(std::string_view text, std::string_view where);

/// Another volume by words, or the fallback by "default". Throws InputError.
void add_part_volume(std::string_view words, std::string_view volume, std::string_view where,
                     PartVolumes& volumes);

/// Throws InputError where words take no part of any model.
void require_parts(const PartVolumes& volumes,
                   std::span<const std::shared_ptr<const Model>> models);

/// The same of parts by their names.
void require_parts(const PartVolumes& volumes, std::vector<std::string> part_names);

/// What part_volume may be in one word.
std::vector<std::string> volume_names();

}  // namespace throng
