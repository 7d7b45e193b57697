// export_frames() writes frames with their reference pairs for programs of other engines;
// check_pairs() compares the pairs that such a program found.
// Invariant: numbers in files read back to the same bit.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "bench/comparison.h"

namespace throng::bench {

/// Contents of an exported folder.
struct ExportedFrames {
  int frames = 0, avatars = 0, parts = 0;
  uint64_t box_pairs = 0;  ///< over all frames
  uint64_t touching = 0;   ///< box pairs whose triangles touch
};

/// Returns the names of the files that export_frames() writes.
std::vector<std::string> exported_files();

/// Writes options.frames frames of the crowd, every `stride`-th, into an existing folder:
/// boxes.csv, poses.csv, parts.csv, a .tri per part, pairs.csv, touching.csv and README.txt with
/// the formats. Throws EnvironmentError.
ExportedFrames export_frames(BenchOptions options, int stride, const std::filesystem::path& folder,
                             const Progress& progress);

/// Pairs that a program found, compared with the reference in the same folder.
struct PairCheck {
  bool are_boxes = true;  ///< "frame,a,b": all pairs of boxes; else of parts
  uint64_t reference = 0, found = 0;
  uint64_t missing = 0;     ///< boxes: not found; parts: touching and not found
  uint64_t unexpected = 0;  ///< boxes: not in the reference; parts: boxes are apart
  uint64_t duplicates = 0;
  uint64_t false_positives = 0;  ///< parts: found and not touching
  std::string first;             ///< the first missing, unexpected or duplicate pair, as text

  /// Boxes must equal the reference; parts must include all that touch and none with boxes apart.
  bool agrees() const { return missing == 0 && unexpected == 0 && duplicates == 0; }
};

/// Throws InputError of the form "file:line: expected ..., found ...".
PairCheck check_pairs(const std::filesystem::path& file);

std::string to_text(const ExportedFrames& exported, const std::filesystem::path& folder);
std::string to_text(const PairCheck& check);

}  // namespace throng::bench
