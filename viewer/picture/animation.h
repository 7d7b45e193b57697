// Pictures one after the other in one file, for pages that show no video.
// One rule: the same pictures give the same bytes.
#pragma once

#include <filesystem>
#include <memory>

#include "viewer/picture/raster.h"

namespace throng {

/// An animated WebP that repeats for ever.
class Animation {
 public:
  /// All pictures have this size. `quality` 0 to 100: what is kept of fine differences.
  Animation(int width, int height, float quality);
  ~Animation();

  void add(const Image& image, int shown_ms);
  /// Throws EnvironmentError if it cannot be written; returns how many bytes it has.
  size_t write(const std::filesystem::path& file);

 private:
  struct Encoder;
  std::unique_ptr<Encoder> encoder_;
};

}  // namespace throng
