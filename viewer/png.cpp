#include <fmt/format.h>
#include <png.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "base/errors.h"
#include "viewer/raster.h"

namespace throng {

void write_png(const std::filesystem::path& file, const Image& image) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width);
  header.height = static_cast<png_uint_32>(image.height);
  header.format = PNG_FORMAT_RGB;
  const auto fail = [&](const std::string& why) {
    throw EnvironmentError(fmt::format("cannot write {}: {}", file.string(), why));
  };
  std::FILE* out = std::fopen(file.c_str(), "wb");
  if (out == nullptr) fail(std::strerror(errno));
  const bool written =
      png_image_write_to_stdio(&header, out, 0, image.rgb.data(), image.width * 3, nullptr) != 0;
  // A full disk may show only when the last bytes leave the buffer.
  errno = 0;
  const bool closed = std::fclose(out) == 0;
  if (!written) fail(header.message);
  if (!closed) fail(std::strerror(errno));
}

}  // namespace throng
