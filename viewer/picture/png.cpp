#include <fmt/format.h>
#include <png.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>

#include "base/errors.h"
#include "base/files/whole_file.h"
#include "viewer/picture/raster.h"

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
  char* bytes = nullptr;
  size_t size = 0;
  std::FILE* out = open_memstream(&bytes, &size);
  if (out == nullptr) fail(std::strerror(errno));
  const bool written =
      png_image_write_to_stdio(&header, out, 0, image.rgb.data(), image.width * 3, nullptr) != 0;
  const bool closed = std::fclose(out) == 0;
  const std::unique_ptr<char, void (*)(void*)> owned(bytes, std::free);
  if (!written) fail(header.message);
  if (!closed) fail(std::strerror(ENOMEM));
  write_whole_file(file, std::string_view(bytes, size));
}

}  // namespace throng
