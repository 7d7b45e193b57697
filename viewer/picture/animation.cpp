#include "viewer/picture/animation.h"

#include <fmt/format.h>
#include <webp/encode.h>
#include <webp/mux.h>

#include <cassert>
#include <memory>

#include "base/errors.h"
#include "base/files/whole_file.h"

namespace throng {

struct Animation::Encoder {
  WebPAnimEncoder* webp = nullptr;
  WebPConfig config{};
  int width = 0, height = 0;
  int time_ms = 0;

  ~Encoder() { WebPAnimEncoderDelete(webp); }

  [[noreturn]] void fail() const {
    throw EnvironmentError(
        fmt::format("libwebp could not encode the animation: {}", WebPAnimEncoderGetError(webp)));
  }
};

Animation::Animation(int width, int height, float quality) : encoder_(std::make_unique<Encoder>()) {
  WebPAnimEncoderOptions options;
  WebPAnimEncoderOptionsInit(&options);
  options.anim_params.loop_count = 0;  // for ever
  encoder_->width = width;
  encoder_->height = height;
  encoder_->webp = WebPAnimEncoderNew(width, height, &options);
  WebPConfigPreset(&encoder_->config, WEBP_PRESET_DRAWING, quality);
  encoder_->config.method = 6;        // the smallest file, not the quickest
  encoder_->config.thread_level = 0;  // the same bytes on any machine
}

Animation::~Animation() = default;

void Animation::add(const Image& image, int shown_ms) {
  assert(image.width == encoder_->width && image.height == encoder_->height);
  WebPPicture picture;
  WebPPictureInit(&picture);
  picture.use_argb = 1;
  picture.width = image.width;
  picture.height = image.height;
  const bool added =
      WebPPictureImportRGB(&picture, image.rgb.data(), 3 * image.width) != 0 &&
      WebPAnimEncoderAdd(encoder_->webp, &picture, encoder_->time_ms, &encoder_->config) != 0;
  WebPPictureFree(&picture);
  if (!added) encoder_->fail();
  encoder_->time_ms += shown_ms;
}

size_t Animation::write(const std::filesystem::path& file) {
  WebPAnimEncoderAdd(encoder_->webp, nullptr, encoder_->time_ms, nullptr);  // the end
  WebPData data;
  WebPDataInit(&data);
  if (WebPAnimEncoderAssemble(encoder_->webp, &data) == 0) encoder_->fail();
  const std::unique_ptr<WebPData, void (*)(WebPData*)> owned(&data, WebPDataClear);
  write_whole_file(file, std::span<const uint8_t>(data.bytes, data.size));
  return data.size;
}

}  // namespace throng
