// PictureSequence takes the pictures of consecutive frames: numbered PNGs, an animation or a video.
// Invariant: without finish() nothing of a sequence remains, and an older file keeps its content.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "viewer/picture/raster.h"

namespace throng {

class PictureSequence {
 public:
  virtual ~PictureSequence() = default;
  /// Appends a picture of this frame. Throws EnvironmentError.
  virtual void add(Image image, int64_t frame) = 0;
  /// Completes the output; returns its size in bytes. Throws EnvironmentError.
  virtual int64_t finish() = 0;
};

struct SequenceOptions {
  int width = 0, height = 0;  ///< size of each picture in pixels
  double shown_s = 0;         ///< each picture
  int threads = 1;            ///< encoders of PNGs
};

enum class SequenceKind {
  kPngs,       ///< a folder of frame_000000.png, named after their frames
  kAnimation,  ///< .webp, which repeats for ever, for pages that show no video
  kVideo       ///< .mp4 or .webm, by the ffmpeg of this machine
};

/// Returns the kind of a path, by its ending; a path without an ending is a folder. Throws
/// InputError for other endings. `option`: "--out".
SequenceKind sequence_kind(const std::filesystem::path& out, const char* option);

/// Throws EnvironmentError if ffmpeg is needed and is not on PATH, or if the folder holds PNGs.
void require_possible(const std::filesystem::path& out, const char* option);

/// The same pictures give the same bytes, videos apart. Throws EnvironmentError.
std::unique_ptr<PictureSequence> make_sequence(const std::filesystem::path& out,
                                               const SequenceOptions& options);

}  // namespace throng
