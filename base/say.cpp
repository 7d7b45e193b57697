#include "base/say.h"

#include <unistd.h>

#include <cstdio>

namespace throng {

void say_text(std::string_view text) noexcept {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

void show_text(std::string_view text) noexcept { std::fwrite(text.data(), 1, text.size(), stdout); }

bool flush_shown() noexcept {
  const bool flushed = std::fflush(stdout) == 0;
  return flushed && std::ferror(stdout) == 0;
}

void say_in_handler(std::string_view text) noexcept {
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, text.data(), text.size());
}

}  // namespace throng
