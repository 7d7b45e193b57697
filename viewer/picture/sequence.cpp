#include "viewer/picture/sequence.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#include <webp/encode.h>
#include <webp/mux.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <future>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/errors.h"
#include "base/files/anonymous_file.h"
#include "base/files/atomic_file.h"
#include "base/text.h"
#include "lcm_io/codec/description.h"

extern char** environ;  // NOLINT(readability-redundant-declaration): POSIX does not declare it

namespace throng {
namespace {

namespace fs = std::filesystem;

constexpr float kAnimationQuality = 55;  // 0 to 100
constexpr const char* kVideoRemedy = "install ffmpeg, or write numbered pictures with --out FOLDER";

/// Encodes in threads: a PNG takes as long as its picture.
class PngFolder final : public PictureSequence {
 public:
  PngFolder(fs::path folder, int threads)
      : folder_(std::move(folder)), max_pending_(static_cast<size_t>(threads)) {}

  ~PngFolder() override {
    for (std::future<void>& pending : pending_) pending.wait();
    std::error_code ignored;
    if (!is_finished_)
      for (const fs::path& file : files_) fs::remove(file, ignored);
  }

  void add(Image image, int64_t frame) override {
    if (pending_.size() == max_pending_) take_first();
    files_.push_back(folder_ / fmt::format("frame_{:06}.png", frame));
    pending_.push_back(
        std::async(std::launch::async,
                   [file = files_.back(), image = std::move(image)] { write_png(file, image); }));
  }

  int64_t finish() override {
    while (!pending_.empty()) take_first();
    is_finished_ = true;
    int64_t bytes = 0;
    for (const fs::path& file : files_) bytes += static_cast<int64_t>(fs::file_size(file));
    return bytes;
  }

 private:
  void take_first() {
    std::future<void> first = std::move(pending_.front());
    pending_.pop_front();
    first.get();
  }

  fs::path folder_;
  size_t max_pending_;
  std::vector<fs::path> files_;
  std::deque<std::future<void>> pending_;
  bool is_finished_ = false;
};

class Animation final : public PictureSequence {
 public:
  Animation(fs::path file, const SequenceOptions& options)
      : file_(std::move(file)),
        options_(options),
        shown_ms_(static_cast<int>(std::lround(1000 * options.shown_s))) {
    WebPAnimEncoderOptions encoder_options;
    WebPAnimEncoderOptionsInit(&encoder_options);
    encoder_options.anim_params.loop_count = 0;  // infinite
    encoder_ = WebPAnimEncoderNew(options.width, options.height, &encoder_options);
    WebPConfigPreset(&config_, WEBP_PRESET_DRAWING, kAnimationQuality);
    config_.method = 6;        // smallest file, not fastest
    config_.thread_level = 0;  // gives the same bytes on any machine
  }
  ~Animation() override { WebPAnimEncoderDelete(encoder_); }
  Animation(const Animation&) = delete;
  Animation& operator=(const Animation&) = delete;

  void add(Image image, int64_t) override {
    assert(image.width == options_.width && image.height == options_.height);
    WebPPicture picture;
    WebPPictureInit(&picture);
    picture.use_argb = 1;
    picture.width = image.width;
    picture.height = image.height;
    const bool added = WebPPictureImportRGB(&picture, image.rgb.data(), 3 * image.width) != 0 &&
                       WebPAnimEncoderAdd(encoder_, &picture, time_ms_, &config_) != 0;
    WebPPictureFree(&picture);
    if (!added) fail();
    time_ms_ += shown_ms_;
  }

  int64_t finish() override {
    WebPAnimEncoderAdd(encoder_, nullptr, time_ms_, nullptr);  // ends the last frame
    WebPData data;
    WebPDataInit(&data);
    if (WebPAnimEncoderAssemble(encoder_, &data) == 0) fail();
    const std::unique_ptr<WebPData, void (*)(WebPData*)> owned(&data, WebPDataClear);
    write_file_atomically(file_, std::span<const uint8_t>(data.bytes, data.size));
    return static_cast<int64_t>(data.size);
  }

 private:
  [[noreturn]] void fail() const {
    throw EnvironmentError(fmt::format("libwebp could not encode the animation: {}",
                                       WebPAnimEncoderGetError(encoder_)));
  }

  fs::path file_;
  SequenceOptions options_;
  int shown_ms_;
  WebPAnimEncoder* encoder_ = nullptr;
  WebPConfig config_{};
  int time_ms_ = 0;
};

std::vector<std::string> ffmpeg_arguments(const fs::path& file, const SequenceOptions& options) {
  std::vector<std::string> all = {
      "ffmpeg", "-y", "-nostdin", "-loglevel", "error", "-f", "rawvideo", "-pixel_format", "rgb24",
      "-video_size", fmt::format("{}x{}", options.width, options.height), "-framerate",
      fmt::format("{:.6g}", 1 / options.shown_s), "-i", "pipe:0",
      // Players want even sizes, and the colours of HDTV.
      "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709", "-colorspace", "bt709",
      "-pix_fmt", "yuv420p"};
  const bool is_mp4 = file.extension() == ".mp4";
  const std::vector<std::string> codec =
      is_mp4 ? std::vector<std::string>{"-c:v",      "libx264",    "-crf", "20",
                                        "-movflags", "+faststart", "-f",   "mp4"}
             : std::vector<std::string>{"-c:v", "libvpx-vp9", "-crf", "30", "-b:v",
                                        "0",    "-row-mt",    "1",    "-f", "webm"};
  all.insert(all.end(), codec.begin(), codec.end());
  all.emplace_back("/proc/self/fd/3");
  return all;
}

/// Pipes pictures into ffmpeg, which writes into a file without a name: a broken film vanishes.
class Video final : public PictureSequence {
 public:
  Video(fs::path file, const SequenceOptions& options) : file_(std::move(file)) {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) fail(std::strerror(errno));
    pipe_ = ends[1];
    const int error = spawn(ends[0], ffmpeg_arguments(file_, options));
    ::close(ends[0]);
    if (error != 0) {
      ::close(pipe_);
      fail(std::strerror(error));
    }
  }

  ~Video() override {
    if (process_ < 0) return;
    ::close(pipe_);
    ::kill(process_, SIGKILL);
    wait();
  }
  Video(const Video&) = delete;
  Video& operator=(const Video&) = delete;

  void add(Image image, int64_t) override {
    std::span<const uint8_t> bytes = image.rgb;
    while (!bytes.empty()) {
      const ssize_t count = ::write(pipe_, bytes.data(), bytes.size());
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) fail(close_and_wait());  // ffmpeg has ended
      bytes = bytes.subspan(static_cast<size_t>(count));
    }
  }

  int64_t finish() override {
    const std::string problem = close_and_wait();
    if (!problem.empty()) fail(problem);
    const int64_t size = size_of(film_);
    if (size == 0) fail("it wrote nothing");
    AtomicFile file(file_);
    std::vector<std::byte> piece(1 << 20);
    for (int64_t at = 0; at < size; at += static_cast<int64_t>(piece.size())) {
      piece.resize(std::min(piece.size(), static_cast<size_t>(size - at)));
      film_.read(at, piece);
      file.write(std::span(reinterpret_cast<const uint8_t*>(piece.data()), piece.size()));
    }
    file.finish();
    return size;
  }

 private:
  [[noreturn]] void fail(const std::string& why) const {
    throw EnvironmentError(
        fmt::format("ffmpeg could not make {}: {}; {}", file_.string(), why,
                    "see what it needs, or write numbered pictures with --out FOLDER"));
  }

  static int64_t size_of(const AnonymousFile& file) {
    struct stat status {};
    return ::fstat(file.descriptor(), &status) == 0 ? status.st_size : 0;
  }

  /// Returns an errno, or 0.
  int spawn(int input, const std::vector<std::string>& arguments) {
    std::vector<char*> words;
    for (const std::string& argument : arguments)
      words.push_back(const_cast<char*>(argument.c_str()));
    words.push_back(nullptr);
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_adddup2(&files, input, STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&files, messages_.descriptor(), STDERR_FILENO);
    posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_adddup2(&files, film_.descriptor(), 3);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    sigset_t defaults;
    sigemptyset(&defaults);
    sigaddset(&defaults, SIGPIPE);  // ignored here
    posix_spawnattr_setsigdefault(&attributes, &defaults);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
    const int error =
        ::posix_spawnp(&process_, words[0], &files, &attributes, words.data(), environ);
    if (error != 0) process_ = -1;
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&files);
    return error;
  }

  /// Returns the status of waitpid().
  int wait() {
    int status = 0;
    while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) continue;
    process_ = -1;
    return status;
  }

  /// Returns what went wrong; empty: nothing.
  std::string close_and_wait() {
    ::close(pipe_);
    const int status = wait();
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return "";
    std::string text(static_cast<size_t>(std::min<int64_t>(size_of(messages_), 1 << 16)), '\0');
    messages_.read(0, std::as_writable_bytes(std::span(text)));
    const std::string_view first = std::string_view(text).substr(0, text.find('\n'));
    return first.empty() ? "it ended without a message" : printable(first);
  }

  fs::path file_;
  AnonymousFile film_, messages_;
  int pipe_ = -1;
  pid_t process_ = -1;
};

bool is_on_path(const std::string& program) {
  const char* path = std::getenv("PATH");
  for (const std::string& folder : split_text(path != nullptr ? path : "", ':')) {
    const fs::path file = fs::path(folder.empty() ? "." : folder) / program;
    std::error_code ignored;
    if (fs::is_regular_file(file, ignored) && ::access(file.c_str(), X_OK) == 0) return true;
  }
  return false;
}

}  // namespace

SequenceKind sequence_kind(const fs::path& out, const char* option) {
  const fs::path ending = out.extension();
  if (ending == ".webp") return SequenceKind::kAnimation;
  if (ending == ".mp4" || ending == ".webm") return SequenceKind::kVideo;
  if (ending.empty()) return SequenceKind::kPngs;
  throw InputError(option,
                   "a folder for numbered PNGs, or a name that ends in .webp, .mp4 or .webm",
                   fmt::format("'{}'", out.string()));
}

void require_possible(const fs::path& out, const char* option) {
  const SequenceKind kind = sequence_kind(out, option);
  if (kind == SequenceKind::kVideo && !is_on_path("ffmpeg"))
    throw EnvironmentError(
        fmt::format("{} {}: ffmpeg is not on PATH; {}", option, out.string(), kVideoRemedy));
  std::error_code ignored;
  if (kind != SequenceKind::kPngs) return;
  for (const fs::directory_entry& entry : fs::directory_iterator(out, ignored))
    if (entry.path().extension() == ".png")
      throw InputError(fmt::format("{} {}", option, out.string()), "a folder without pictures",
                       entry.path().filename().string());
}

std::unique_ptr<PictureSequence> make_sequence(const fs::path& out,
                                               const SequenceOptions& options) {
  switch (sequence_kind(out, "out")) {
    case SequenceKind::kAnimation:
      return std::make_unique<Animation>(out, options);
    case SequenceKind::kVideo:
      return std::make_unique<Video>(out, options);
    case SequenceKind::kPngs:
      break;
  }
  return std::make_unique<PngFolder>(out, options.threads);
}

}  // namespace throng
