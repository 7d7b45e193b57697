// Frames for engines of others: boxes, poses and shapes written in a plain format with the pairs
// that there are, and the pairs that such an engine found, judged. One rule: numbers are written so
// that they read back to the same bit.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "bench/comparison.h"

namespace throng::bench {

/// What a folder of frames holds.
struct ExportedFrames {
  int frames = 0, avatars = 0, parts = 0;
  uint64_t box_pairs = 0;  ///< over all frames
  uint64_t touching = 0;   ///< of them, those whose triangles touch
};

/// The names of the files that export_frames() writes.
std::vector<std::string> exported_files();

/// Writes options.frames frames of the crowd, every `stride`-th, into a folder that exists:
/// boxes.csv, poses.csv, parts.csv, a .tri for each part, pairs.csv, touching.csv and README.txt,
/// which says what they hold. Throws EnvironmentError.
ExportedFrames export_frames(BenchOptions options, int stride, const std::filesystem::path& folder,
                             const Progress& progress);

/// Pairs that a program found, held against the reference in the same folder.
struct PairCheck {
  bool are_boxes = true;  ///< "frame,a,b": all pairs of boxes; or "frame,part_a,part_b": of parts
  uint64_t reference = 0, found = 0;
  uint64_t missing = 0;     ///< of boxes: not found; of parts: touching and not found
  uint64_t unexpected = 0;  ///< of boxes: not in the reference; of parts: whose boxes are apart
  uint64_t duplicates = 0;
  uint64_t false_positives = 0;  ///< of parts: found and not touching
  std::string first;             ///< the first that is missing, beyond or twice, in words

  /// Boxes: exactly the reference's. Parts: all that touch, and none whose boxes are apart.
  bool agrees() const { return missing == 0 && unexpected == 0 && duplicates == 0; }
};

/// Throws InputError, "file:line: expected ..., found ...".
PairCheck check_pairs(const std::filesystem::path& file);

std::string to_text(const ExportedFrames& exported, const std::filesystem::path& folder);
std::string to_text(const PairCheck& judged);

}  // namespace throng::bench
